"""How far disturbances of unit energy push outputs at the end of a motion, whatever an uncertain block does.

    dx/dt = A x + B w + E d,   v = C x + D w + F d,   w = Delta(v),   e = G x at the end;   |e(T)| <= gain |d|

Delta is any linear time-invariant system of a norm of at most `size`, v and w scalars. With psi = [1, pole/(s + pole)]
and any positive X (2, 2), the integral of (psi v)' X (psi v) - (psi w / size)' X (psi w / size) over [0, t] is not
negative (a hard integral quadratic constraint), so that the gain is bounded where

    -dP/dt = A'P + P A + Q - (P B + S) R^-1 (P B + S)',   P(T) = G'G,

of the system with its filters has a solution back to the start; Q, S, R are of (psi v)' X (psi v) less
(psi w / size)' X (psi w / size) and gain^2 d'd. Any X bounds; the least gain is looked for by Nelder and Mead's method.

Source   Seiler, Moore, Meissen, Arcak and Packard, "Finite horizon robustness analysis of LTV systems using integral
         quadratic constraints", Automatica 100 (2019), theorem 2, with the factorisation of its example 2
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pliant.plants.core.argument_gates import require_finite, require_instance, require_number
from pliant.plants.core.signals import GAUSS, OwnsArrays, read_only_times
from pliant.plants.linear import magnus
from pliant.plants.linear.even_units import even_expm
from pliant.plants.linear.ltv import splined

Array = np.ndarray
STEPS = 500  # stretches, at least
CLOSE = 2e-3  # relative, of the gain
TRIES = 60  # multipliers
FARTHEST = 30.0  # times the gain without a block
FIRST, SECOND = np.arange(-2.0, 3.1, 1.0), (-2.0, 0.0, 1.0, 2.0)  # log10 of X's diagonal over the square of that gain


@dataclass(frozen=True, eq=False)
class UncertainLTV(OwnsArrays):
    """Matrices at times t (nt,): A (nt, n, n), B (nt, n, 1), E (nt, n, k), C (nt, 1, n), D (nt, 1, 1), F (nt, 1, k);
    G (p, n)."""

    t: Array = field(repr=False)
    A: Array = field(repr=False)
    B: Array = field(repr=False)
    E: Array = field(repr=False)
    C: Array = field(repr=False)
    D: Array = field(repr=False)
    F: Array = field(repr=False)
    G: Array = field(repr=False)

    def __post_init__(self) -> None:
        t = read_only_times("UncertainLTV.t", self.t)
        m = len(t)
        n = require_finite("UncertainLTV.A", self.A, (m, -1, -1)).shape[1]
        k = require_finite("UncertainLTV.E", self.E, (m, n, -1)).shape[2]
        shapes = {"A": (m, n, n), "B": (m, n, 1), "E": (m, n, k), "C": (m, 1, n), "D": (m, 1, 1), "F": (m, 1, k)}
        for name, shape in {**shapes, "G": (-1, n)}.items():
            object.__setattr__(self, name, require_finite(f"UncertainLTV.{name}", getattr(self, name), shape))
        object.__setattr__(self, "t", t)

    def closed(self, A: Array, B: Array, C: Array, D: Array) -> UncertainLTV:
        """With a given block, ds/dt = A s + B v, w = C s + D v, in place of the uncertain one, which sees nothing.

        A (ns, ns), B (ns, nv), C (nw, ns), D (nw, nv).
        """
        m, n, k = len(self.t), len(A), self.E.shape[2]
        gap = 1 / (1 - self.D * D)
        v = np.concatenate([gap * self.C, gap * self.D @ np.broadcast_to(C, (m, 1, n))], axis=2)
        w = np.concatenate([np.zeros((m, 1, self.A.shape[1])), np.broadcast_to(C, (m, 1, n))], axis=2) + D * v
        wide = np.zeros((m, self.A.shape[1] + n, self.A.shape[1] + n))
        wide[:, : -n or None, : -n or None] = self.A
        if n:
            wide[:, -n:, -n:] = A
        wide[:, : self.A.shape[1]] += self.B @ w
        wide[:, self.A.shape[1] :] += B @ v
        through = gap * self.F
        E = np.concatenate([self.E + self.B @ (D * through), B @ through], axis=1)
        none = np.zeros((m, 1, self.A.shape[1] + n))
        zero, G = np.zeros((m, 1, 1)), np.hstack([self.G, np.zeros((len(self.G), n))])
        return UncertainLTV(self.t, wide, np.swapaxes(none, 1, 2), E, none, zero, np.zeros((m, 1, k)), G)


@dataclass(frozen=True, eq=False)
class RobustGain(OwnsArrays):
    """|e(T)| <= upper |d| for all blocks; `nominal`: the gain without one."""

    upper: float
    nominal: float
    multiplier: Array = field(repr=False)  # X (2, 2)


def robust_gain(system: UncertainLTV, *, size: float, pole: float = 10.0) -> RobustGain:
    """The bound over all linear time-invariant blocks of a norm of at most `size`.

    pole: of the filter [1/s], in which frequencies the multiplier may tell apart. ValueError unless both are positive.

    Example
    -------
    >>> one, t = np.ones((15, 1, 1)), np.linspace(0.0, 2.0, 15)  # dx/dt = -x + w + d, w = Delta(x), |Delta| <= 1/2
    >>> found = robust_gain(UncertainLTV(t, -one, one, one, one, 0 * one, 0 * one, np.eye(1)), size=0.5, pole=1.0)
    >>> print(f"{found.nominal:.4f} without a block, at most {found.upper:.2f} with any")
    0.7006 without a block, at most 0.93 with any
    """
    nominal = end_gain(system)
    wide = _with_filters(system, size, pole)
    most, best = FARTHEST * nominal, np.zeros(3)

    def least(y: Array, high: float) -> float:
        X = _positive(y) * nominal**2
        if not wide.stands(X, high):
            return high * (1 + 1e-3)
        low = nominal
        while high - low > CLOSE / 4 * high:
            middle = (low + high) / 2
            low, high = (low, middle) if wide.stands(X, middle) else (middle, high)
        return high

    for first in FIRST:
        for second in SECOND:
            if (found := least(np.array([first, second, 0.0]), most)) < most:
                most, best = found, np.array([first, second, 0.0])
    if not most < FARTHEST * nominal:
        return RobustGain(np.inf, nominal, np.zeros((2, 2)))
    simplex = best + np.vstack([np.zeros(3), np.diag([0.15, 0.3, 0.3])])
    from scipy.optimize import minimize

    options = {"maxfev": TRIES, "initial_simplex": simplex, "xatol": 1e-2, "fatol": CLOSE * most / 4}
    end = minimize(lambda y: least(y, 1.5 * most), best, method="Nelder-Mead", options=options)
    best, most = (end.x, float(end.fun)) if end.fun < most else (best, most)
    return RobustGain(most, nominal, _positive(best) * nominal**2)


def shows(system: UncertainLTV, gain: float, multiplier: Array, *, size: float, pole: float = 10.0) -> bool:
    """Whether a multiplier X (2, 2) shows that the gain is at most this one, for all blocks."""
    gain = float(require_number("shows.gain", gain, "positive"))
    X = require_finite("shows.multiplier", multiplier, (2, 2))
    if np.abs(X - X.T).max() > 1e-9 * np.abs(X).max() or np.linalg.eigvalsh(X)[0] <= 0:
        raise ValueError("shows.multiplier must be symmetric and positive definite")
    return _with_filters(system, size, pole).stands(X, gain)


def _with_filters(system: UncertainLTV, size: float, pole: float) -> _Filtered:
    return _Filtered(
        require_instance("robust_gain.system", system, UncertainLTV),
        float(require_number("robust_gain.size", size, "positive")),
        float(require_number("robust_gain.pole", pole, "positive", unit="1/s")),
    )


def end_gain(system: UncertainLTV) -> float:
    """The largest |e(T)| for d of unit energy without a block: the root of the largest eigenvalue of G W G'."""
    at, h = _gauss(system.t)
    A, E = (splined(system.t, M, at).reshape(len(h), 2, *M.shape[1:]) for M in (system.A, system.E))
    Phi = even_expm(magnus.exponent(A, h))
    step = magnus.reached(A, E @ np.swapaxes(E, -1, -2), h)
    W = np.zeros(A.shape[-2:])
    for k in range(len(h)):
        W = Phi[k] @ W @ Phi[k].T + step[k]
    return float(np.sqrt(np.linalg.eigvalsh(system.G @ W @ system.G.T)[-1]))


def _gauss(t: Array) -> tuple[Array, Array]:
    """Gauss points of each stretch, (2 m,), and the stretches (m,)."""
    parts = max(1, int(np.ceil(STEPS / (len(t) - 1))))
    ends = np.append((t[:-1, None] + np.diff(t)[:, None] * np.arange(parts) / parts).ravel(), t[-1])
    h = np.diff(ends)
    return (ends[:-1, None] + h[:, None] * GAUSS).ravel(), h


def _positive(y: Array) -> Array:
    L = np.array([[10 ** (y[0] / 2), 0.0], [y[2], 10 ** (y[1] / 2)]])
    return np.asarray(L @ L.T)


class _Filtered:
    """The system with psi on v and on w: states [x; of v; of w], inputs [w; d]."""

    def __init__(self, system: UncertainLTV, size: float, pole: float) -> None:
        at, self.h = _gauss(system.t)
        A, B, E, C, D, F = (
            splined(system.t, M, at).reshape(len(self.h), 2, *M.shape[1:])
            for M in (system.A, system.B, system.E, system.C, system.D, system.F)
        )
        lead, n, k = A.shape[:2], A.shape[-1], E.shape[-1]
        self.A, self.B = np.zeros((*lead, n + 2, n + 2)), np.zeros((*lead, n + 2, 1 + k))
        self.A[..., :n, :n], self.B[..., :n, :1], self.B[..., :n, 1:] = A, B, E
        self.A[..., n, :n], self.A[..., n, n], self.A[..., n + 1, n + 1] = pole * C[..., 0, :], -pole, -pole
        self.B[..., n, :1], self.B[..., n, 1:], self.B[..., n + 1, 0] = pole * D[..., 0, :], pole * F[..., 0, :], pole
        whole = n + 3 + k  # [x; of v; of w; w; d]
        self.seen, self.given = np.zeros((*lead, 2, whole)), np.zeros((*lead, 2, whole))
        self.seen[..., 0, :n], self.seen[..., 0, n + 2 : n + 3] = C[..., 0, :], D[..., 0, :]
        self.seen[..., 0, n + 3 :], self.seen[..., 1, n] = F[..., 0, :], 1
        self.given[..., 0, n + 2], self.given[..., 1, n + 1] = 1 / size, 1 / size
        self.end = np.zeros((n + 2, n + 2))
        self.end[:n, :n] = system.G.T @ system.G
        self.n, self.k = n + 2, k

    def stands(self, X: Array, gain: float) -> bool:
        """Whether the Riccati equation goes back to the start."""
        n, seen, given = self.n, self.seen, self.given
        T = np.swapaxes(seen, -1, -2) @ X @ seen - np.swapaxes(given, -1, -2) @ X @ given
        T[..., n + 1 :, n + 1 :] -= gain**2 * np.eye(self.k)
        Q, S, R = T[..., :n, :n], T[..., :n, n:], T[..., n:, n:]
        if np.linalg.eigvalsh(R)[..., -1].max() >= 0:
            return False
        solved = np.linalg.solve(R, np.concatenate([np.swapaxes(S, -1, -2), np.swapaxes(self.B, -1, -2)], axis=-1))
        F, G = self.A - self.B @ solved[..., :n], self.B @ solved[..., n:]
        H = np.zeros((*F.shape[:2], 2 * n, 2 * n))
        H[..., :n, :n], H[..., n:, n:], H[..., :n, n:] = F, -np.swapaxes(F, -1, -2), -G
        H[..., n:, :n] = -(Q - S @ solved[..., :n])
        steps = even_expm(-magnus.exponent(H, self.h))
        P = self.end
        for part in steps[::-1]:
            below = part[:n, :n] + part[:n, n:] @ P
            if not np.isfinite(below).all() or np.linalg.eigvals(below).real.min() <= 0:
                return False  # beyond infinity it comes from the other side
            P = np.linalg.solve(below.T, (part[n:, :n] + part[n:, n:] @ P).T).T
            P = (P + P.T) / 2
        return bool(np.isfinite(P).all())
