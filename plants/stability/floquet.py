"""Floquet's answer for a periodic model: multipliers, exponents and modes from the monodromy matrix.

Phi(t0 + T, t0) v = lambda v; exponents sigma = ln(lambda) / T; every motion is a sum of e^(sigma t) p(t), p periodic.
The steps are halved until the matrix stands still, so the error is that of A(t) between its nodes.

Undamped (Hamiltonian) models have multipliers in pairs lambda, 1/lambda. They are found as the roots of
lambda + 1/lambda = mu from the double eigenvalues mu of M + M^-1: where mu is real and |mu| <= 2 they lie on the unit
circle exactly, as the doubled eigenvalues of a symplectic matrix do in Van Loan's method (1984).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

from . import periodicity as periods
from .state_matrix_path import MOST_STEPS, Path, kept, scaling

FLOOR = 1e-9  # a multiplier this near the unit circle is on it
MOST_POINTS = 2**11  # of a mode's shape
CLEAR = 1e-4  # error of a multiplier from which on "on the unit circle" is no finding


@dataclass(frozen=True, eq=False)
class Floquet:
    """Multipliers lambda (nx,), largest first, exponents sigma = ln(lambda)/T (nx,) [1/s] with |Im| <= pi/T."""

    period: float  # [s]
    multipliers: np.ndarray = field(repr=False)
    exponents: np.ndarray = field(repr=False)
    modes: np.ndarray = field(repr=False)  # (nx, nx): column k belongs to multiplier k, at the start of the period
    monodromy: np.ndarray = field(repr=False)  # (nx, nx)
    error: np.ndarray = field(repr=False)  # (nx,) of the sizes of the multipliers, an estimate
    undamped: bool  # whether the structure-preserving route was taken
    steps: int  # in a period
    states: tuple[str, ...]
    source: str  # where the period comes from
    path: Path = field(repr=False)  # A(t) over the period

    @property
    def growth(self) -> float:
        """Growth rate [1/s] of the fastest growing mode, below zero where all decay."""
        return float(self.exponents.real.max(initial=-np.inf))

    @cached_property
    def outside(self) -> np.ndarray:
        """Which multipliers (nx,) are outside the unit circle by more than their error."""
        return np.abs(self.multipliers) - 1.0 > np.maximum(self.error, FLOOR)

    @cached_property
    def on_circle(self) -> np.ndarray:
        """Which multipliers (nx,) cannot be told from ones on the unit circle."""
        return np.abs(np.abs(self.multipliers) - 1.0) <= np.maximum(self.error, FLOOR)

    @property
    def verdict(self) -> str:
        """stable, unstable, marginal (on the unit circle), undecided (the error is too large to say)."""
        if self.outside.any():
            return "unstable"
        if not self.on_circle.any():
            return "stable"
        return "marginal" if self.error[self.on_circle].max() <= CLEAR else "undecided"

    def mode(self, k: int) -> np.ndarray:
        """The periodic shape p(t) (m + 1, nx), complex, of mode k over the period, at m + 1 equidistant times."""
        few = min(self.steps, MOST_POINTS)
        edges = np.linspace(self.path.t[0], self.path.t[0] + self.period, few + 1)
        found = [self.modes[:, k] / self.path.scale]
        for Phi in self.path.between(edges, self.steps // few):
            found.append(Phi @ found[-1])
        decay = np.exp(-self.exponents[k] * (edges - edges[0]))
        return np.array(found) * self.path.scale * decay[:, None]


def floquet(
    model: LTVModel | LinearModel,
    period: float | None = None,
    *,
    states: Sequence[str] | None = None,
    undamped: bool | None = None,
    tolerance: float = 1e-11,
) -> Floquet:
    """Multipliers and modes of a model whose A(t) has the `period` [s]; ValueError where it has not.

    None: the period is found, see `period.find`. `states` keeps only those: right where the others do not feel them.
    `undamped` forces or forbids the structure-preserving route; None: taken where the model allows it.
    `tolerance` of the monodromy matrix, relative.
    """
    path, length, source = periodic_path(model, period, states)
    steps, M, error = monodromy(path, length, tolerance)
    scale = path.scale
    structured = None
    if undamped is not False and (undamped or _traceless(path)):
        structured = _reciprocal(M, error)
    if undamped and structured is None:
        raise ValueError("floquet.undamped = True: the multipliers do not come in pairs lambda, 1/lambda")
    lam, vectors, rounding = _eigen(M, error)
    if structured is not None:
        lam, rounding = _matched(lam, *structured)
    order = np.argsort(-np.abs(lam), kind="stable")
    lam, vectors, rounding = lam[order], vectors[:, order] * scale[:, None], rounding[order]
    with np.errstate(divide="ignore"):
        exponents = np.log(lam.astype(complex)) / length
    named = model.state_names
    return Floquet(
        length,
        lam,
        exponents,
        vectors / np.linalg.norm(vectors, axis=0),
        M * scale[:, None] / scale,
        rounding,
        structured is not None,
        steps,
        tuple(named[i] for i in kept(model, states)),
        source,
        path,
    )


def periodic_path(
    model: LTVModel | LinearModel, period: float | None, states: Sequence[str] | None
) -> tuple[Path, float, str]:
    """A(t) over one period, the period [s], and where it comes from. ValueError where A(t) is not periodic."""
    if isinstance(model, LinearModel):
        if model.dt is not None or period is None or not period > 0:
            raise ValueError(f"floquet.period = {period!r} must be > 0 for a LinearModel, and its dt None")
        keep = kept(model, states)
        A = model.A[np.ix_(keep, keep)][None]
        return Path(np.array([0.0, period]), A.repeat(2, axis=0), scaling(A)), float(period), "A is constant"
    if not isinstance(model, LTVModel):
        raise ValueError(
            f"floquet.model is a {type(model).__name__}, must be an LTVModel: pieces have no smooth period"
        )
    if period is None:
        found, source = periods.find(model)
        if found is None:
            raise ValueError(f"floquet: the model is not periodic: {source}")
        length = found
    else:
        length, source = float(period), "given"
        if not (np.isfinite(length) and length > 0):
            raise ValueError(f"floquet.period = {period!r} must be > 0 [s]")
        reason = periods.why_not(model, length)
        if reason:
            raise ValueError(f"floquet.period = {length:.6g} s: the model is not periodic: {reason}")
    keep = kept(model, states)
    t, A = _one_period(model.t, model.A[:, keep][:, :, keep], length)
    return Path(t, A, scaling(A), periodic=True), length, source


def _one_period(t: np.ndarray, A: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of one period, from its first; taken as they are where a node ends it, else interpolated."""
    last = int(np.argmin(np.abs(t - t[0] - length)))
    if abs(t[last] - t[0] - length) <= 1e-9 * length:
        return t[: last + 1], A[: last + 1]
    from scipy.interpolate import CubicSpline

    flat = A.reshape(len(t), -1)
    new = t[0] + np.linspace(0.0, length, max(16, 2 * int(np.sum(t < t[0] + length))) + 1)
    return new, CubicSpline(t, flat)(new).reshape(-1, *A.shape[1:])


def monodromy(path: Path, length: float, tolerance: float) -> tuple[int, np.ndarray, float]:
    """How many steps, Phi (n, n) over a period, relative error: steps are halved until Phi stands still."""
    m = 1 if path.constant else max(32, 2 * path.harmonics + 2, int(path.fastest() * length / 2))
    m = 1 << (m - 1).bit_length()
    if m > MOST_STEPS:
        raise ValueError(
            f"floquet: a period of {length:.6g} s and modes of up to {path.fastest():.4g} 1/s need {m:,} steps, more "
            f"than {MOST_STEPS:,}: leave out the fastest modes"
        )
    before, change = None, np.inf
    while True:
        total = path.over(length, m)
        size = np.linalg.norm(total)
        floor = 4 * np.finfo(float).eps * m**0.5
        if path.constant:
            change = floor
        elif before is not None:
            change = float(np.linalg.norm(total - before) / size)
        if change <= max(tolerance * 32, floor) or m >= MOST_STEPS:
            return m, total, max(change / 63 if not path.constant else change, floor) + path.error * length
        before, m = total, 2 * m


def _traceless(path: Path) -> bool:
    """Whether tr A(t) = 0 at all times, as it is where nothing damps or drives."""
    trace = np.trace(path(path.t), axis1=1, axis2=2)
    return bool(np.abs(trace).max() <= 1e-11 * max(path.size, 1e-300) * path.n)


def _eigen(M: np.ndarray, error: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Eigenvalues, right eigenvectors and the eigenvalues' errors for a relative `error` of M (Wilkinson 1965)."""
    lam, right = np.linalg.eig(M)
    size = np.linalg.norm(M, 2)
    try:
        left = np.linalg.norm(np.linalg.inv(right), axis=1)
    except np.linalg.LinAlgError:
        left = np.full(len(lam), np.inf)
    change = size * np.minimum(error * left, np.sqrt(error))
    return lam.astype(complex), right, change


def _reciprocal(M: np.ndarray, error: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Multipliers (n,) in pairs lambda, 1/lambda and their errors; None where M's do not come in such pairs."""
    n = len(M)
    if n % 2 or np.linalg.cond(M) > 1e12:
        return None
    N = M + np.linalg.inv(M)
    mu = np.linalg.eigvals(N).astype(complex)
    fuzz = max(1e-9, 1e2 * error) * max(1.0, float(np.linalg.norm(N, 2)))
    rest, lam, rounding = list(range(n)), [], []
    while rest:
        i = rest.pop(0)
        j = min(rest, key=lambda k: abs(mu[k] - mu[i]))
        rest.remove(j)
        if abs(mu[i] - mu[j]) > 50 * fuzz:
            return None
        middle, apart = (mu[i] + mu[j]) / 2, abs(mu[i] - mu[j]) / 2
        if abs(middle.imag) <= fuzz:
            middle = complex(middle.real)
        uncertain = max(1e-13, error) * max(1.0, float(np.linalg.norm(N, 2)))
        if middle.imag == 0 and 2 < abs(middle.real) <= 2 + 1e2 * uncertain:
            middle = complex(2 * np.sign(middle.real))
        root = np.sqrt((middle / 2) ** 2 - 1 + 0j)
        if middle.imag == 0 and abs(middle.real) <= 2:
            root = 1j * np.sqrt(1 - (middle.real / 2) ** 2)
        big = middle / 2 + root if abs(middle / 2 + root) >= 1 else middle / 2 - root
        lam += [big, 1 / big]
        circular = middle.imag == 0 and abs(middle.real) <= 2
        spread = apart if circular else max(uncertain, apart)
        rounding += [spread / max(2 * abs(root), np.sqrt(uncertain))] * 2
    return np.array(lam), np.array(rounding)


def _matched(plain: np.ndarray, lam: np.ndarray, rounding: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The paired multipliers in the order of the plain ones that they replace."""
    rest, order = list(range(len(lam))), []
    for value in plain:
        k = min(rest, key=lambda i: abs(lam[i] - value))
        rest.remove(k)
        order.append(k)
    return lam[order], rounding[order]
