"""Frozen-time eigenvalues along a nominal, and the test that says whether they may be believed.

The roots of A(t) at fixed t decide nothing by themselves: they depend on the coordinates where those move, and a model
may grow while all are in the left half-plane (Markus and Yamabe 1960) or decay while some are not. Where A(t) changes
slowly enough they do decide (Rosenbrock 1963; Desoer 1969; Ilchmann, Owens and Praetzel-Wolters 1987). The test here:
A^T P + P A = -I at each t; V = y^T P(t) y falls where the largest eigenvalue of P' is below 1, and P' follows from
A^T P' + P' A = -(A'^T P + P A'). The classical norm bound |A'| < 1/(2 |P|^2) is the same with norms in place of P'.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear.lti import LinearModel
from pliant.plants.transitions.state_matrix_path import Model, Path, as_pieces, kept, scaling

TERMS, DOUBTED = 8, 1e-4  # times the rounding of an entry; of the fastest root: real parts whose rounding is looked at
ROUNDING = 1e-8  # of the fastest frozen root: a real part this small is zero (double roots at 0 have such errors)

LEAP, FIRST, LARGE = 8, 128, 40  # of times, every so many; fewer where A has more states
WORK = 5e8  # times and states cubed, above which slow variation is not looked for
MATTERS, BRIEF = 0.01, 0.01  # logarithm of growth between critical times up to which they are not told; of the time


@dataclass(frozen=True, eq=False)
class FrozenTime(OwnsArrays):
    """Eigenvalues (nt, nx) [1/s] of A at the times t (nt,) [s], rightmost first, and what they would suggest."""

    t: np.ndarray = field(repr=False)
    eigenvalues: np.ndarray = field(repr=False)
    critical_times: tuple[float, ...]  # [s] where the rightmost root crosses the imaginary axis, and matters: `lasting`
    coordinates: str  # in which the roots were taken; in others that move against these they differ
    threshold: float = 0.0  # real part [1/s] that rounding can make of zero
    span: float = np.inf  # [s] over which deviations are looked at; infinite where A is constant or repeated

    @property
    def rightmost(self) -> np.ndarray:
        """Largest real part (nt,) [1/s]."""
        return self.eigenvalues.real.max(axis=1, initial=-np.inf)

    @property
    def suggests(self) -> str:
        """stable, unstable or marginal: no verdict unless `slow_variation` allows it."""
        worst, least = float(self.rightmost.max()), max(self.threshold, self.least)
        return "unstable" if worst > least else "stable" if worst < -least else "marginal"

    @property
    def least(self) -> float:
        """Real part [1/s] by which deviations change within `span` by MATTERS: no smaller one can be told from zero."""
        return MATTERS / self.span


def frozen_time(
    model: Model | LinearModel,
    *,
    states: Sequence[str] | None = None,
    coordinates: str | None = None,
    points: int | None = None,
) -> FrozenTime:
    """Eigenvalues along the nominal at its nodes, or at about `points` of them.

    `coordinates` says in words what the states are measured in; None: their names. Critical times lie between two
    nodes and are refined on the interpolated A(t).
    """
    said = coordinates or said_coordinates(model, states)
    keep = kept(model, states)
    if isinstance(model, LinearModel):
        _require_continuous("frozen_time", model)
        _require_no_points("frozen_time", points)
        A = model.A[np.ix_(keep, keep)]
        values = _ordered(A[None])
        return FrozenTime(np.zeros(1), values, (), said, _threshold(A[None], values))
    times, found, threshold = [], [], 0.0
    crossings: list[float] = []
    for piece in as_pieces(model).pieces:
        A = piece.A[:, keep][:, :, keep]
        part = frozen_along(Path(piece.t, A, scaling(A)), thinned(piece.t, points), said)
        crossings, threshold = [*crossings, *part.critical_times], max(threshold, part.threshold)
        times.append(part.t)
        found.append(part.eigenvalues)
    return FrozenTime(np.concatenate(times), np.concatenate(found), tuple(crossings), said, threshold)


def frozen_along(path: Path, t: np.ndarray, coordinates: str) -> FrozenTime:
    """The same at the times t (nt,) of one smooth piece."""
    A = path(t)
    values = _ordered(A)
    limit = _threshold(A, values)
    return FrozenTime(t, values, tuple(_crossings(path, t, values, limit)), coordinates, limit)


def _threshold(A: np.ndarray, values: np.ndarray) -> float:
    """Real part [1/s] that rounding can make of zero, from A (nt, n, n) where the rightmost root is farthest right."""
    fastest, k = float(np.abs(values).max(initial=0.0)), int(values.real.max(axis=1, initial=-np.inf).argmax())
    limit = ROUNDING * fastest
    if limit < values[k].real.max(initial=-np.inf) <= DOUBTED * fastest:
        size = scaling(A[k][None])
        limit = max(limit, off_by_rounding(*np.linalg.eig(A[k] * size / size[:, None]), A[k] * size / size[:, None]))
    return limit


def off_by_rounding(lam: np.ndarray, V: np.ndarray, A: np.ndarray) -> float:
    """What the rightmost root may be off: a double one by the square root of what the entries are."""
    try:
        left = np.linalg.inv(V)
    except np.linalg.LinAlgError:
        return np.inf
    k = int(lam.real.argmax())
    with np.errstate(over="ignore"):  # chains of integrators: V as good as singular, the root known to nothing
        steep = np.linalg.norm(left[k]) * np.linalg.norm(V[:, k])
    return float(TERMS * np.finfo(float).eps * steep * np.linalg.norm(A, 2))


def thinned(t: np.ndarray, points: int | None) -> np.ndarray:
    """Some of the times t (nt,), about `points` of them, the ends among them."""
    every = 1 if points is None else max(1, -(-len(t) // points))
    return t[np.unique(np.r_[np.arange(0, len(t), every), len(t) - 1])]


def said_coordinates(model: Any, states: Sequence[str] | None) -> str:
    names = tuple(states) if states is not None else model_states(model)
    return "the model's own states " + (", ".join(names) if len(names) <= 8 else f"{names[0]} .. {names[-1]}")


def model_states(model: Any) -> tuple[str, ...]:
    """Names of the states of a model or of pieces."""
    return model.state_names if isinstance(model, LinearModel) else as_pieces(model).pieces[0].state_names


def _ordered(A: np.ndarray) -> np.ndarray:
    values = np.linalg.eigvals(A).astype(complex)
    return np.take_along_axis(values, np.argsort(-values.real, axis=1, kind="stable"), axis=1)


def _crossings(path: Path, t: np.ndarray, values: np.ndarray, limit: float) -> list[float]:
    """Times [s] at which the rightmost real part passes the rounding threshold, by bisection."""
    rightmost = values.real.max(axis=1, initial=-np.inf)
    above = lasting(rightmost > limit, np.abs(rightmost) * np.gradient(t) if len(t) > 1 else np.ones(1), t)
    found = []
    for k in np.flatnonzero(above[1:] != above[:-1])[:100]:
        low, high = float(t[k]), float(t[k + 1])
        for _ in range(30):
            middle = (low + high) / 2
            if (np.linalg.eigvals(path(middle)).real.max() > limit) == above[k]:
                low = middle
            else:
                high = middle
        found.append((low + high) / 2)
    return found


def lasting(above: np.ndarray, change: np.ndarray, t: np.ndarray) -> np.ndarray:
    """`above` (nt,), when deviations could grow, without the spells that do not matter: those in which they grow by no
    more than MATTERS in all, and those between in which they decay by no more, within BRIEF of the time t (nt,) [s].

    change (nt,): of the logarithm of their size, about each time.
    """
    found = above.copy()
    for grows in (True, False):
        edges = np.r_[0, np.flatnonzero(found[1:] != found[:-1]) + 1, len(found)]
        for begin, end in pairwise(edges.tolist()):
            brief = grows or t[end - 1] - t[begin] <= BRIEF * (t[-1] - t[0])
            if found[begin] == grows and brief and change[begin:end].sum() <= MATTERS and end - begin < len(found):
                found[begin:end] = not grows
    return found


@dataclass(frozen=True, eq=False)
class SlowVariation:
    """Whether frozen-time roots may be believed (also as a truth value), and how far inside the bound the model is."""

    allowed: bool
    used: float  # largest eigenvalue of P' over the motion: the share of the decay that the motion of A eats; < 1
    decay: float  # rate [1/s] of the slowest mode that V proves; 0 where not allowed
    rate: float  # largest |A'| [1/s^2], and ..
    bound: float  # .. 1/(2 max |P|^2) [1/s^2]: the classical sufficient bound on it
    worst_time: float  # [s] where the test is tightest
    why: str

    def __bool__(self) -> bool:
        return self.allowed

    @property
    def inside(self) -> float:
        """1 - used: 1 for a constant model, 0 at the bound, below 0 beyond it."""
        return 1.0 - self.used


def slow_variation(
    model: Model | LinearModel, *, states: Sequence[str] | None = None, points: int | None = None
) -> SlowVariation:
    """Whether A(t) varies slowly enough, at its nodes and midway between, for its frozen roots to decide."""
    keep = kept(model, states)
    if isinstance(model, LinearModel):
        _require_continuous("slow_variation", model)
        _require_no_points("slow_variation", points)
        worst = float(np.linalg.eigvals(model.A[np.ix_(keep, keep)]).real.max(initial=-np.inf))
        return SlowVariation(True, 0.0, max(-worst, 0.0), 0.0, np.inf, 0.0, "A is constant: its roots decide")
    pieces = as_pieces(model).pieces
    if len(pieces) > 1:
        return _refused("the nominal has jumps: no rate bounds them")
    A = pieces[0].A[:, keep][:, :, keep]
    path = Path(pieces[0].t, A, scaling(A))
    return slow_along(path, thinned(pieces[0].t, points))


def slow_along(path: Path, t: np.ndarray) -> SlowVariation:
    """The same at the times t (nt,) of one smooth piece and midway between them; at every LEAP-th first, which refuse
    as well.
    """
    t = np.sort(np.r_[t, (t[1:] + t[:-1]) / 2])
    found = _slow_at(path, t[:: LEAP if path.n <= LARGE else max(LEAP, len(t) // FIRST)])
    if found and len(t) * path.n**3 > WORK:
        return _refused(f"not looked for: it would be much work at {len(t):,} times with {path.n} states")
    return _slow_at(path, t) if found else found


def _slow_at(path: Path, t: np.ndarray) -> SlowVariation:
    at, moving = path(t), path.rate(t)
    S = _coordinates(at.mean(axis=0))
    at, moving = (np.linalg.solve(S, a @ S) for a in (at, moving))
    lam, V = np.linalg.eig(at)
    right = lam.real.max(axis=1)
    if right.max() >= -ROUNDING * np.abs(lam).max():
        k = int(right.argmax())
        zero = right[k] <= off_by_rounding(lam[k], V[k], at[k])
        where = "lies on the imaginary axis but for rounding" if zero else f"has real part {right[k]:.3g}"
        return _refused(f"a frozen root {where} at {t[k]:.6g} s", float(t[k]))
    P = _lyapunov(at, lam, V, np.broadcast_to(np.eye(path.n), at.shape))
    half = moving.transpose(0, 2, 1) @ P
    motion = np.linalg.eigvalsh(_lyapunov(at, lam, V, half + half.transpose(0, 2, 1)))[:, -1]
    size = np.linalg.eigvalsh(P)[:, -1]
    k = int(motion.argmax())
    used = max(float(motion[k]), 0.0)
    rate = float(np.linalg.norm(moving, 2, axis=(1, 2)).max())
    bound = float(1 / (2 * size.max() ** 2))
    allowed = bool(np.isfinite(motion).all() and used < 1)
    decay = float(((1 - motion) / (2 * size)).min()) if allowed else 0.0
    why = f"the motion of A {'uses' if allowed else 'needs'} {used:.3g}{'' if allowed else ' and more'} of the frozen "
    why += f"decay (below 1 is allowed), {'most ' if allowed else ''}at {t[k]:.6g} s"
    return SlowVariation(allowed, used, decay, rate, bound, float(t[k]), why)


def _refused(why: str, time: float = np.nan) -> SlowVariation:
    return SlowVariation(False, np.inf, 0.0, np.inf, 0.0, time, why)


def _coordinates(mean: np.ndarray) -> np.ndarray:
    """S (n, n) with x = S y: real modal coordinates of the mean A, where its decay is even; else none."""
    lam, V = np.linalg.eig(mean)
    if lam.real.max(initial=-1.0) >= 0 or np.linalg.cond(V) > 1e6:
        return np.eye(len(mean))
    columns, k = [], 0
    while k < len(lam):
        size = np.sqrt(-2 * lam[k].real)
        if lam[k].imag != 0:
            columns += [V[:, k].real / size, V[:, k].imag / size]
            k += 2
        else:
            columns.append(V[:, k].real / size)
            k += 1
    return np.array(columns).T


def _lyapunov(A: np.ndarray, lam: np.ndarray, V: np.ndarray, Q: np.ndarray) -> np.ndarray:
    """P (m, n, n) with A^T P + P A = -Q, through the eigenvectors V of A; directly where those are nearly parallel."""
    inverse = np.linalg.inv(V)
    left = V.conj().transpose(0, 2, 1)
    X = -(left @ Q @ V) / (lam.conj()[:, :, None] + lam[:, None, :])
    P = (inverse.conj().transpose(0, 2, 1) @ X @ inverse).real
    miss = np.abs(A.transpose(0, 2, 1) @ P + P @ A + Q).max(axis=(1, 2))
    for k in np.flatnonzero(~(miss <= 1e-8 * np.maximum(np.abs(Q).max(axis=(1, 2)), 1e-300))):
        P[k] = sla.solve_continuous_lyapunov(A[k].T, -Q[k])
    return (P + P.transpose(0, 2, 1)) / 2


def _require_no_points(method: str, points: int | None) -> None:
    if points is not None:
        raise ValueError(f"{method}.points = {points}: a LinearModel has no nodes to choose from, must be None")


def _require_continuous(method: str, model: LinearModel) -> None:
    """ValueError for a sampled model: its eigenvalues are in the z plane."""
    if model.dt is not None:
        raise ValueError(f"{method}: model.dt = {model.dt:g} must be None (continuous time); assess takes sampled ones")
