"""A time-varying quadratic certificate V = dx^T P(t) dx that falls at least as fast as e^(-2 alpha t).

P solves the Lyapunov differential equation -P' = (A + alpha)^T P + P (A + alpha) + Q backwards: the periodic solution
of a periodic model, else from an end value. Between the nodes V is the cubic Hermite polynomial through P and P', and
what is verified is that V itself: R = -(P' + (A + alpha)^T P + P (A + alpha)) > 0 and P > 0 at each node and at three
times between, A taken from its own interpolant. Nothing of how P was found enters the check.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.argument_gates import LEAST, require_count, require_number, require_seconds
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear import magnus
from pliant.plants.linear.lti import LinearModel
from pliant.plants.transitions.state_matrix_path import Model, Path, as_pieces, kept, scaling
from pliant.plants.transitions.transition_error import monodromy

from .floquet import periodic_path
from .transition_growth import chain

BETWEEN = (0.25, 0.5, 0.75)
FINE = 0.1  # |eigenvalue| times step at which the polynomial between the nodes is good enough
MOST = 8192  # steps
SHARES = (0.9, 0.5, 0.2)  # of the decay of the whole, tried as alpha
NONE = 1e-9  # by which a deviation must have shrunk in all, so that it is no rounding
WRAPPED = 1e-3  # of the fall of ln V over a period that V may rise by where P starts anew, by rounding


@dataclass(frozen=True, eq=False)
class Certificate(OwnsArrays):
    """V = dx^T P dx with V' <= -2 alpha V, P (nt, nx, nx) at the times t (nt,) [s]."""

    t: np.ndarray = field(repr=False)
    P: np.ndarray = field(repr=False)
    alpha: float  # [1/s]
    verified: bool
    overshoot: float  # |dx(t)| <= overshoot e^(-alpha (t - t0)) |dx(t0)|, sizes of x / scale
    contraction: (
        float  # the same over the whole time, with P at the start and the end: below 1 every deviation ends smaller
    )
    slack: float  # smallest eigenvalue of R, of which V needs > 0; Q = 1 makes it 1 where P is exact
    scale: np.ndarray = field(repr=False)  # (nx,)
    periodic: bool
    why: str

    def __bool__(self) -> bool:
        return self.verified


def lyapunov(
    model: Model | LinearModel,
    alpha: float | None = None,
    *,
    period: float | None = None,
    periodic: bool | None = None,
    states: Sequence[str] | None = None,
    most: int = MOST,
) -> Certificate:
    """A certificate for decay at `alpha` [1/s]; None: nine tenths of the decay rate that the model has.

    `periodic` None: where A(t) has a period (given or found). On any other nominal a certificate exists for each
    alpha, and its `contraction` says what it is worth. `verified` False with the reason where there is none, or none
    within `most` steps.
    """
    alpha = None if alpha is None else require_number("lyapunov.alpha", alpha, unit="1/s")
    most = require_count("lyapunov", "most", most, 1, 10_000_000)
    period = None if period is None else require_seconds("lyapunov.period", period, LEAST)
    if period is not None and (periodic is False or isinstance(model, LinearModel)):
        raise ValueError(f"lyapunov.period = {period:g} s of a model that is constant or not repeated, must be None")
    if isinstance(model, LinearModel):
        return _constant(model, alpha, states)
    pieces = as_pieces(model).pieces
    if len(pieces) > 1:
        return _none("V is not continued across jumps", kept(model, states))
    if periodic is not False:
        try:
            path, length, _ = periodic_path(pieces[0], period, states)
        except ValueError as refusal:
            if periodic or period is not None:
                raise
            assert refusal
        else:
            return certified(path, length, alpha, most)
    keep = kept(model, states)
    A = pieces[0].A[:, keep][:, :, keep]
    return backward(Path(pieces[0].t, A, scaling(A)), alpha, most, lambda: magnus.product(chain(model, states)[1]))


def _none(why: str, keep: list[int]) -> Certificate:
    n = len(keep)
    return Certificate(np.zeros(1), np.eye(n)[None], 0.0, False, np.inf, np.inf, -np.inf, np.ones(n), False, why)


def _constant(model: LinearModel, alpha: float | None, states: Sequence[str] | None) -> Certificate:
    keep = kept(model, states)
    A = model.A[np.ix_(keep, keep)]
    size = scaling(A[None])
    A = A * size / size[:, None]
    margin = -float(np.linalg.eigvals(A).real.max(initial=-np.inf))
    alpha = 0.9 * margin if alpha is None else float(alpha)
    if model.dt is not None or not alpha < margin or margin <= 0:
        return _none(f"the slowest mode decays at {margin:.4g} 1/s, alpha must be below it and dt None", keep)
    shifted = A + alpha * np.eye(len(A))
    P = sla.solve_continuous_lyapunov(shifted.T, -np.eye(len(A)))
    P = (P + P.T) / 2
    slack = float(np.linalg.eigvalsh(-(shifted.T @ P + P @ shifted)).min())
    low, high = np.linalg.eigvalsh(P)[[0, -1]]
    shown = slack > 0 and low > 0
    return _made(np.zeros(1), P[None], alpha, shown, np.sqrt(high / low), 0.0, slack, size, True)


def _made(
    t: np.ndarray,
    P: np.ndarray,
    alpha: float,
    verified: bool,
    overshoot: float,
    contraction: float,
    slack: float,
    size: np.ndarray,
    periodic: bool,
) -> Certificate:
    where = f" at {len(t)} nodes and {len(BETWEEN)} times between each two" if len(t) > 1 else ""
    said = f"V falls{f' at {alpha:.4g} 1/s or faster' if alpha else ', at no rate that is known'}, verified{where}"
    why = said if verified else f"V is not shown to fall: slack {slack:.3g}; more steps or a smaller alpha may help"
    unscaled = P / size / size[:, None]
    return Certificate(
        t,
        unscaled,
        float(alpha),
        bool(verified),
        float(overshoot),
        float(contraction),
        float(slack),
        size,
        periodic,
        why,
    )


def _grid(path: Path, length: float, most: int) -> int | None:
    need = max(32, 2 * path.harmonics + 2, int(np.ceil(path.fastest() * length / FINE)))
    return need if need <= most else None


def certified(path: Path, length: float, alpha: float | None = None, most: int = MOST) -> Certificate:
    """The certificate of a periodic A(t) given over one period [s]."""
    keep = list(range(path.n))
    _, total, _ = monodromy(path, length, 1e-9)
    margin = -float(np.log(np.abs(np.linalg.eigvals(total)).max()) / length)
    alpha = 0.9 * margin if alpha is None else float(alpha)
    if margin <= 0 or not alpha < margin:
        return _none(f"the slowest Floquet mode decays at {margin:.4g} 1/s, alpha must be below it", keep)
    m = _grid(path, length, most)
    if m is None:
        return _none(f"it needs more than {most} steps in {length:.4g} s", keep)
    edges = path.t[0] + np.linspace(0.0, length, m + 1)
    Phi, W = _intervals(_halves(path, edges), edges, alpha)
    total, sum_W = _composed(Phi, W)
    end = sla.solve_discrete_lyapunov(total.T, sum_W)
    return _verified(path, edges, _swept(Phi, W, (end + end.T) / 2), alpha, True)


def backward(path: Path, alpha: float | None, most: int, over_all: Callable[[], np.ndarray]) -> Certificate:
    """The certificate of a nominal that is not periodic; `over_all` gives Phi (n, n) over all of it."""
    keep, t = list(range(path.n)), path.t
    length = float(t[-1] - t[0])
    m = _grid(path, length, most)
    if m is None:
        return _none(f"it needs more than {most} steps in {length:.4g} s", keep)
    parts = -(-m // (len(t) - 1))
    edges = np.interp(np.arange((len(t) - 1) * parts + 1) / parts, np.arange(len(t)), t)
    decay = _decay(over_all(), length) if alpha is None else 0.0
    choices = [alpha] if alpha is not None else sorted({share * decay for share in SHARES}, reverse=True)
    best, halves = None, _halves(path, edges)
    for choice in choices:
        Phi, W = _intervals(halves, edges, choice)
        found = _verified(path, edges, _swept(Phi, W, _end(path, choice)), choice, False)
        if best is None or (found.verified, -found.contraction) > (best.verified, -best.contraction):
            best = found
    assert best is not None
    return best


def _decay(Phi: np.ndarray, length: float) -> float:
    """The rate [1/s] at which the slowest deviation decays over the whole nominal, 0 where one grows."""
    size = float(np.abs(np.linalg.eigvals(Phi)).max(initial=0.0))
    return -float(np.log(max(size, 1e-300))) / length if size < 1 - NONE else 0.0


def _end(path: Path, alpha: float) -> np.ndarray:
    """P at the end: that of the frozen A where it decays faster than alpha, else the identity."""
    A = path(path.t[-1]) + alpha * np.eye(path.n)
    if np.linalg.eigvals(A).real.max(initial=-np.inf) < -1e-9 * path.size:
        P = sla.solve_continuous_lyapunov(A.T, -np.eye(path.n))
        return (P + P.T) / 2
    return np.eye(path.n) / max(path.size, 1e-300)


def _halves(path: Path, edges: np.ndarray) -> np.ndarray:
    """Transitions (2 m, n, n) over the halves of each interval."""
    return path.transitions(np.sort(np.r_[edges, (edges[1:] + edges[:-1]) / 2]))


def _intervals(halves: np.ndarray, edges: np.ndarray, alpha: float) -> tuple[np.ndarray, np.ndarray]:
    """Shifted transitions (m, n, n) and int Phi^T Phi (m, n, n) over each interval, by Simpson on its halves."""
    h = np.diff(edges)[:, None, None]
    half, whole = halves[0::2] * np.exp(alpha * h / 2), halves[1::2] @ halves[0::2] * np.exp(alpha * h)
    return whole, h / 6 * (np.eye(halves.shape[-1]) + 4 * _square(half) + _square(whole))


def _square(M: np.ndarray) -> np.ndarray:
    return M.transpose(0, 2, 1) @ M


def _composed(Phi: np.ndarray, W: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Phi and W of all intervals together: W = W1 + Phi1^T W2 Phi1, by halves."""
    while len(Phi) > 1:
        m = len(Phi) - len(Phi) % 2
        first, second = Phi[0:m:2], Phi[1:m:2]
        joined = W[0:m:2] + first.transpose(0, 2, 1) @ W[1:m:2] @ first
        Phi, W = np.concatenate([second @ first, Phi[m:]]), np.concatenate([joined, W[m:]])
    return Phi[0], W[0]


def _swept(Phi: np.ndarray, W: np.ndarray, end: np.ndarray) -> np.ndarray:
    """P (m+1, n, n) backwards from its end value."""
    P = np.empty((len(Phi) + 1, *end.shape))
    P[-1] = end
    for k in range(len(Phi) - 1, -1, -1):
        P[k] = W[k] + Phi[k].T @ P[k + 1] @ Phi[k]
    return (P + P.transpose(0, 2, 1)) / 2


def _verified(path: Path, edges: np.ndarray, P: np.ndarray, alpha: float, periodic: bool) -> Certificate:
    def rate(A: np.ndarray, P: np.ndarray) -> np.ndarray:
        half = P @ (A + alpha * np.eye(path.n))
        return -(half + half.transpose(0, 2, 1))

    slope = rate(path(edges), P) - np.eye(path.n)
    sizes = np.linalg.eigvalsh(P)
    low, slack = float(sizes.min()), 1.0
    h, p, d = np.diff(edges)[:, None, None], P[:-1], slope[:-1]
    rise = P[1:] - p
    for s in BETWEEN:
        c2, c3 = 3 * rise - h * (2 * d + slope[1:]), h * (d + slope[1:]) - 2 * rise
        value, change = p + s * (h * d + s * (c2 + s * c3)), d + s * (2 * c2 + 3 * s * c3) / h
        R = rate(path(edges[:-1] + s * np.diff(edges)), value) - change
        slack = min(slack, float(np.linalg.eigvalsh(R)[:, 0].min()))
        low = min(low, float(np.linalg.eigvalsh(value)[:, 0].min()))
    shown = low > 0 and slack > 0
    if periodic and shown:  # at the end of a period V goes on with P at its start
        jump = float(np.log(sla.eigvalsh(P[0], P[-1])[-1]))
        shown = jump <= WRAPPED * 2 * abs(alpha) * float(edges[-1] - edges[0]) + 1e-10
    high = sizes[:, -1]
    overshoot = np.sqrt(high.max() / low) if low > 0 else np.inf
    falls = np.exp(-alpha * (edges[-1] - edges[0]))
    contraction = falls * (np.sqrt(high[0] / sizes[-1, 0]) if low > 0 else np.inf)
    return _made(edges, P, alpha, shown, overshoot, contraction, slack, path.scale, periodic)
