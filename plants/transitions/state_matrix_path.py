"""A(t) of a linear model as a function of time, in coordinates scaled once for all times.

Between the nodes each entry is a cubic, a chord or, over a period of equidistant nodes, a sum of harmonics, whichever
is known best there, with a bound on what it misses: `interpolation`. A nominal with known jumps is a `PiecewiseLTV`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.argument_gates import require_names
from pliant.plants.core.signals import OwnsArrays, index
from pliant.plants.linear import magnus
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.linear.piecewise_ltv import PiecewiseLTV

from .interpolation import Interpolant

CLOSES = 1e-5  # of an entry's range: how near it must come back after a period
NOISE, WIDEST = 1e-12, 2.0**80  # of entries that scaling ignores; of scales from their median
CLEAR = 1e-4  # error from which on "cannot be told from the boundary" is no finding: of a multiplier, or of |A|
FELT = 1e-12  # of the largest entry in scaled coordinates: what is less is rounding
SKEW = 1e6  # condition of eigenvectors that are taken for coordinates
NEAR, FEW_STEPS = 2**17, 16  # numbers of A at a time, so that they stay near the processor; steps at least
CHUNK = 4096  # steps whose matrices are held at a time
MOST_STEPS = 2**20


Model = LinearModel | LTVModel | PiecewiseLTV | Sequence[LTVModel]


def as_pieces(model: Model) -> PiecewiseLTV:
    """The model as pieces: one where it has no jump; a list is joined without jumps of the state.

    ValueError for a LinearModel, which has no times. A constant jump j moves all deviations alike: only J matters.
    Where the nodes of a model hide what A does, it is taken at its `finer` ones.
    """
    if isinstance(model, PiecewiseLTV):
        return PiecewiseLTV(tuple(m.finer or m for m in model.pieces), model.jumps)
    models = (model,) if isinstance(model, LTVModel) else model
    if not isinstance(models, Sequence) or not models or not all(isinstance(m, LTVModel) for m in models):
        raise ValueError(f"model is a {type(model).__name__}, must be an LTVModel, PiecewiseLTV or a list of LTVModel")
    n = len(models[0].states)
    return PiecewiseLTV(tuple(m.finer or m for m in models), ((np.eye(n), np.zeros(n)),) * (len(models) - 1))


def kept(model: Any, states: Sequence[str] | None) -> list[int]:
    """Positions of the named states (None: all); ValueError where they are no part that may be judged alone.

    They may feel one that is left out only where its motion is given (a driven crank or hinge, a wheel that nothing
    turns): it feels none of them, and what it feels of the others leaves its deviation a polynomial of time.
    """
    linear = isinstance(model, LinearModel)
    pieces = () if linear else as_pieces(model).pieces
    signals = model.states if linear else pieces[0].states
    if states is None:
        return list(range(len(signals)))
    found = [index(signals, name, "state") for name in require_names("states", states)]
    if not found:
        raise ValueError(f"states = {tuple(states)} must name one state or more, each once")
    rest = [k for k in range(len(signals)) if k not in found]
    jumps = [] if linear else [J[None] - np.eye(len(signals)) for J, _ in as_pieces(model).jumps]
    felt = np.zeros((len(signals), len(signals)), dtype=bool)
    for A in [model.A[None]] if linear else [*(piece.A for piece in pieces), *jumps]:
        scale = scaling(A)
        size = np.abs(A).max(axis=0, initial=0.0) * scale / scale[:, None]
        felt |= size > FELT * size.max(initial=0.0)
    own = felt.copy()
    if linear and model.dt is not None:
        own &= ~np.eye(len(own), dtype=bool) | (np.abs(np.diagonal(model.A) - 1) > FELT)  # 1 is what 0 is to a rate
    for j in rest:
        for i in found:
            if felt[i, j] and not _given(own, j, found):
                by, of = signals[i].name, signals[j].name
                raise ValueError(
                    f"states = {tuple(states)}: {by} feels {of}, which is left out and whose motion is not given"
                )
    return found


def _given(felt: np.ndarray, j: int, found: list[int]) -> bool:
    """Whether state j feels none of those `found`, and no state, itself included, that feels it in turn."""
    reached, new = set(), {j}
    while new:
        reached |= new
        new = {int(k) for i in new for k in np.flatnonzero(felt[i])} - reached
    inner = sorted(reached)
    loops = (
        felt[np.ix_(inner, inner)].any()
        and np.linalg.matrix_power(felt[np.ix_(inner, inner)].astype(float), len(inner)).any()
    )
    return not reached & set(found) and not loops


def parts_of(A: np.ndarray) -> list[np.ndarray]:
    """States (positions) that depend on each other both ways, from the nonzero entries of A (n, n)."""
    n = len(A)
    reach = (A != 0) | np.eye(n, dtype=bool)
    for _ in range(max(1, n.bit_length())):
        reach = (reach.astype(np.float32) @ reach.astype(np.float32)) > 0
    both, rest, found = reach & reach.T, np.ones(n, dtype=bool), []
    for k in range(n):
        if rest[k]:
            found.append(np.flatnonzero(both[k]))
            rest[both[k]] = False
    return found


def unfelt(model: Any, states: Sequence[str] | None) -> tuple[str, ...]:
    """Of the named states (None: all) those that none feels, itself neither: an offset in them stays what it is."""
    keep, linear = kept(model, states), isinstance(model, LinearModel)
    if linear and model.dt is not None:
        return ()
    pieces = [model] if linear else as_pieces(model).pieces
    A = np.concatenate([piece.A.reshape(-1, *piece.A.shape[-2:])[:, keep][:, :, keep] for piece in pieces])
    scale = scaling(A)
    size = np.abs(A).max(axis=0, initial=0.0) * scale / scale[:, None]
    names = pieces[0].state_names
    return tuple(
        names[k] for k, most in zip(keep, size.max(axis=0, initial=0.0)) if most <= FELT * size.max(initial=0.0)
    )


def scaling(A: np.ndarray) -> np.ndarray:
    """Powers of two (n,), largest 1: in z = x / scale the rows and columns of A (nt, n, n) are of like size.

    Entries that are rounding beside the largest of their row or column do not count.
    """
    mean = np.abs(A).mean(axis=0)
    if not len(mean) or not mean.any():
        return np.ones(len(mean))
    across, down = mean.max(axis=1, keepdims=True), mean.max(axis=0, keepdims=True)
    mean[mean < NOISE * np.minimum(across, down)] = 0.0
    with np.errstate(invalid="ignore"):  # SciPy casts the scales to integers for a permutation that is not asked for
        _, (scale, _) = sla.matrix_balance(mean, permute=False, separate=True)
    scale = np.clip(scale / np.median(scale), 1 / WIDEST, WIDEST)
    return scale / scale.max()


def ranges(A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """By how much each entry of A (nt, ..) varies, and its largest size, (..)."""
    low, high = A.min(axis=0), A.max(axis=0)
    return high - low, np.maximum(high, -low)


def modal(A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Real coordinates X (n, n) in which the mean of A (nt, n, n) is a mode beside the other, and their inverse.

    Columns are the eigenvectors, of a complex pair their real and imaginary part; Schur's, where these are hardly a
    basis: a mode then feels later ones alone.
    """
    mean = A.mean(axis=0)
    lam, V = np.linalg.eig(mean)
    X = np.where(lam.imag < 0, -V.imag, V.real)
    if np.linalg.cond(X) > SKEW:
        X = sla.schur(mean)[1]
    inverse = np.linalg.inv(X)
    return X, inverse @ (2 * np.eye(len(X)) - X @ inverse)


class Path(OwnsArrays):
    """A(t) = base + what varies, from values A (nt, n, n) at times t; `periodic`: t[-1] is a period after t[0]."""

    def __init__(
        self,
        t: np.ndarray,
        A: np.ndarray,
        scale: np.ndarray,
        *,
        periodic: bool = False,
        moving: np.ndarray | None = None,  # (n, n) which entries count as varying; None: those that do
    ) -> None:
        A = A * (scale / scale[:, None])
        self.t, self.n, self.scale = t, A.shape[-1], scale
        spread, largest = ranges(A)
        self.size = float(largest.max(initial=0.0))  # [1/s]
        self.rows, self.columns = np.nonzero(spread > 1e-14 * largest if moving is None else moving)
        self.base = A.mean(axis=0)
        self.rounding = np.zeros((self.n, self.n))  # [1/s] what every A(t) may be off beside what `area` says
        if not len(self.rows):
            return
        self.base[self.rows, self.columns] = 0.0
        flat = A.reshape(len(t), -1) if len(self.rows) == self.n**2 else A[:, self.rows, self.columns]
        seam = np.zeros(flat.shape[1])
        if periodic:
            seam = np.abs(flat[-1] - flat[0])
            near = seam <= CLOSES * np.ptp(flat, axis=0)
            flat[0] = np.where(near, (flat[0] + flat[-1]) / 2, flat[0])  # elsewhere it jumps there
            flat[-1], seam = flat[0], np.where(near, seam, 0.0)
        self.values = Interpolant(t, flat, periodic=periodic)
        self.values.add(0, seam)
        self.values.add(-1, seam)

    @property
    def harmonics(self) -> int:
        return 0 if self.constant else self.values.harmonics

    def area(self) -> np.ndarray:
        """Integral [1] over each interval (nt-1, n, n) of what A misses between the nodes; see `interpolation`."""
        found = np.zeros((len(self.t) - 1, self.n, self.n))
        if not self.constant:
            found[:, self.rows, self.columns] = self.values.area
        return found

    @property
    def constant(self) -> bool:
        return not len(self.rows)

    def __call__(self, t: Any) -> np.ndarray:
        """A (.., n, n) in scaled coordinates at the times t."""
        t = np.asarray(t, dtype=float)
        found = np.broadcast_to(self.base, (t.size, self.n, self.n))
        if len(self.rows) == self.n**2 and self.n:
            found = self.values(t.ravel())  # by rows, as np.nonzero lists them
        elif not self.constant:
            found = found.copy()
            found.reshape(t.size, -1)[:, self.rows * self.n + self.columns] = self.values(t.ravel())
        return found.reshape(*t.shape, self.n, self.n)

    def rate(self, t: np.ndarray) -> np.ndarray:
        """dA/dt (nt, n, n) [1/s^2] at the times t by central differences of the interpolant, one-sided at the ends."""
        span = self.t[-1] - self.t[0]
        step = 1e-4 * span / max(len(self.t) - 1, 1)
        low, high = np.maximum(t - step, self.t[0]), np.minimum(t + step, self.t[-1])
        return (self(high) - self(low)) / (high - low)[:, None, None]

    def transitions(self, edges: np.ndarray) -> np.ndarray:
        """Phi (m, n, n) between consecutive times edges (m+1,), in scaled coordinates."""
        h = np.diff(edges)
        if self.constant and np.ptp(h) <= 1e-12 * h.mean():
            return np.broadcast_to(magnus.expm(self.base[None] * h.mean()), (len(h), self.n, self.n))
        found = np.empty((len(h), self.n, self.n))
        at_once = max(FEW_STEPS, min(CHUNK, NEAR // (3 * max(self.n, 1) ** 2)))
        for k in range(0, len(h), at_once):
            part = slice(k, k + at_once)
            found[part] = magnus.steps(self(edges[:-1][part, None] + h[part, None] * magnus.GAUSS3), h[part])
        return found

    def between(self, nodes: np.ndarray, parts: int = 1) -> np.ndarray:
        """Phi (m, n, n) between consecutive nodes (m+1,), each interval in `parts` equal steps, few held at a time."""
        if parts == 1:
            return self.transitions(nodes)
        found, at_once = np.empty((len(nodes) - 1, self.n, self.n)), max(1, CHUNK // parts)
        for k in range(0, len(found), at_once):
            begin, h = nodes[k : k + at_once + 1], np.diff(nodes[k : k + at_once + 1])
            inner = begin[:-1, None] + h[:, None] * np.arange(parts) / parts
            steps = self.transitions(np.append(inner.ravel(), begin[-1]))
            found[k : k + at_once] = magnus.product(steps.reshape(-1, parts, self.n, self.n))
        return found

    def over(self, length: float, steps: int) -> np.ndarray:
        """Phi (n, n) from t[0] over `length` [s] in `steps` equal steps, a multiple of the lesser of it and CHUNK."""
        few = min(steps, CHUNK)
        return magnus.product(self.between(self.t[0] + np.linspace(0.0, length, few + 1), steps // few))

    def fastest(self) -> float:
        """Largest |eigenvalue| [1/s] at a few times."""
        at = self.t[:: max(1, len(self.t) // 8)] if not self.constant else self.t[:1]
        return float(np.abs(np.linalg.eigvals(self(at))).max(initial=0.0))


def paths_of(joined: Any, states: Sequence[str] | None) -> tuple[list[Path], list[np.ndarray]]:
    """A(t) of each piece, and the jumps between them, all in the same scaled coordinates."""
    keep = kept(joined, states)
    A = [piece.A[:, keep][:, :, keep] for piece in joined.pieces]
    scale = scaling(np.concatenate(A))
    jumps = [J[np.ix_(keep, keep)] * scale / scale[:, None] for J, _ in joined.jumps]
    return [Path(piece.t, a, scale) for piece, a in zip(joined.pieces, A)], jumps
