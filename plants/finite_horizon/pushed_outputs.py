"""How far disturbances and deviations at the start can push outputs at each time of a motion, and which do.

Of unit energy       |z_i(t)| <= sqrt(c_i W(t) c_i'), W the Gramian of what is reached; the disturbance that attains it
                     is w(s) = E(s)' Phi(t, s)' c_i' / sqrt(..)
Bounded, |w_j| <= l_j  |z_i(t)| <= sum of l_j times the integral of |c_i Phi(t, s) E_j(s)| over s, attained by its signs
White, of unit intensity, and a start of covariance P0: the standard deviation sqrt(c_i (W + Phi P0 Phi') c_i')
"""

from __future__ import annotations

import numpy as np

from pliant.plants.linear.ltv import splined

from .stretches import ACROSS, Stretches

Array = np.ndarray
BETWEEN = np.linspace(0.0, 1.0, 9)  # parts of a stretch
CURVED = ACROSS**2 / 8  # of its height, that a swing may be off the straight line between the ends of a stretch
NEAR = 4  # stretches that hold a quarter of the fastest swing


def gramians(on: Stretches, start: Array | None = None) -> Array:
    """W (m + 1, n, n) at the ends of stretches; `start` (n, n): its value at the first."""
    Phi, step = on.held[0], on.gramians
    W = np.zeros((len(on.h) + 1, on.n, on.n))
    if start is not None:
        W[0] = start
    for k in range(len(on.h)):
        W[k + 1] = Phi[k] @ W[k] @ Phi[k].T + step[k]
    return W


def by_energy(on: Stretches, W: Array) -> tuple[Array, Array]:
    """The most that |z_i| can be at each end of a stretch (m + 1, nz), and what it is at most on the stretch before it.

    Between the ends z_i^2, whose rate is 2 c W (c A + dc/dt)' + |c E|^2, is a cubic to within the fourth derivative's
    share, (2 |lambda| h)^4/384 at most of the largest. What passes through without delay (F) has no bound at one time:
    it is left out of the first, and makes the second infinite.
    """
    A, E, C, F = on.nodes
    squares = np.maximum(np.einsum("kij,kjl,kil->ki", C, W, C), 0.0)
    turning = C @ A + np.gradient(C, on.t, axis=0)
    slope = 2 * np.einsum("kij,kjl,kil->ki", C, W, turning) + np.square(C @ E).sum(axis=-1)
    within = [_hermite(s, squares, slope * _steps_after(on), slope * _steps_before(on)) for s in BETWEEN]
    upper = np.vstack([squares[:1], np.max(within, axis=0) + (2 * ACROSS) ** 4 / 384 * squares.max(axis=0)])
    upper[:, np.abs(F).max(axis=(0, 2)) > 0] = np.inf
    return np.sqrt(squares), np.sqrt(np.maximum(upper, 0.0))


def _steps_after(on: Stretches) -> Array:
    return np.r_[on.h, 0.0][:, None]


def _steps_before(on: Stretches) -> Array:
    return np.r_[0.0, on.h][:, None]


def _hermite(s: float, y: Array, after: Array, before: Array) -> Array:
    """Between rows of y, at the part s of each stretch, from slopes times its length at its start and its end."""
    start, end = (1 + 2 * s) * (1 - s) ** 2, s**2 * (3 - 2 * s)
    return start * y[:-1] + end * y[1:] + s * (1 - s) ** 2 * after[:-1] - s**2 * (1 - s) * before[1:]


def backward(on: Stretches, at: int, row: int) -> Array:
    """c Phi(t, s) at the starts of stretches before t = t[at], (at + 1, n); the last is c itself."""
    Phi, found = on.held[0], np.zeros((at + 1, on.n))
    found[at] = on.nodes[2][at, row]
    for k in range(at - 1, -1, -1):
        found[k] = found[k + 1] @ Phi[k]
    return found


def worst_of_energy(on: Stretches, at: int, row: int) -> tuple[Array, float]:
    """The disturbance (m + 1, nw) of unit energy, held from row to row, that pushes z_row most at t[at]; how far."""
    later, Gamma = backward(on, at, row), on.held[1]
    found = np.zeros((len(on.t), on.nw))
    effect = np.einsum("ki,kij->kj", later[1:], Gamma[:at])  # of w held at one
    found[:at] = effect / on.h[:at, None]
    size = float(np.sqrt((np.square(found[:-1]) * on.h[:, None]).sum()))
    return (found / size if size > 0 else found), size


def worst_bounded(on: Stretches, at: int, row: int, limits: Array) -> tuple[Array, float]:
    """The disturbance (m + 1, nw) of +-limits (nw,) that pushes z_row furthest at t[at]; how far."""
    later, Gamma, through = backward(on, at, row), on.held[1], on.nodes[3][at, row]
    effect = np.einsum("ki,kij->kj", later[1:], Gamma[:at])
    found = np.zeros((len(on.t), on.nw))
    found[:at], found[at] = np.where(effect < 0, -1.0, 1.0), np.where(through < 0, -1.0, 1.0)
    return found * limits, float((np.abs(effect).sum(axis=0) + np.abs(through)) @ limits)


def by_bounded(on: Stretches, limits: Array) -> Array:
    """At most how far |z_i| can be at each end of a stretch (m + 1, nz) where |w_j| <= limits (nw,).

    Over a stretch in which c Phi(t, s) E_j(s) keeps its sign the integral of its modulus is that of itself. Where it
    does not, or may not, the straight line between its ends serves, with what the second derivative may add.
    """
    (Phi, Gamma), (_, E, C, F) = on.held, on.nodes
    m, n, nw, h = len(on.h), on.n, on.nw, on.h[:, None]
    held, ends, found = np.zeros((n, m, nw)), np.zeros((n, m + 1, nw)), np.abs(F) @ limits
    ends[:, 0] = E[0]
    for k in range(m):
        held[:, :k] = np.tensordot(Phi[k], held[:, :k], 1)
        ends[:, : k + 1] = np.tensordot(Phi[k], ends[:, : k + 1], 1)
        held[:, k], ends[:, k + 1] = Gamma[k], E[k + 1]
        whole = np.abs(np.tensordot(C[k + 1], held[:, : k + 1], 1))  # (nz, k + 1, nw)
        f = np.tensordot(C[k + 1], ends[:, : k + 2], 1)
        size = np.abs(f)
        a, b, curved = size[:, :-1], size[:, 1:], CURVED * _about(size)
        crosses = (f[:, :-1] * f[:, 1:] < 0) | (np.minimum(a, b) <= curved)
        line = (a**2 + b**2) / (2 * np.maximum(a + b, np.finfo(float).tiny)) + curved
        most = np.where(crosses, np.maximum(whole, h[: k + 1] * line), whole)
        found[k + 1] += most.sum(axis=1) @ limits
    return found


def _about(f: Array) -> Array:
    """The largest of f (nz, k + 1, nw) within NEAR ends of a stretch, the height of its swing, (nz, k, nw)."""
    found = np.maximum(f[:, :-1], f[:, 1:])
    for _ in range(NEAR):
        wider = found.copy()
        wider[:, 1:] = np.maximum(wider[:, 1:], found[:, :-1])
        wider[:, :-1] = np.maximum(wider[:, :-1], found[:, 1:])
        found = wider
    return found


def from_start(on: Stretches, sizes: Array) -> Array:
    """|c_i Phi(t, 0) X| at the ends of stretches (m + 1, nz), X = diag(sizes)."""
    Phi, C = on.held[0], on.nodes[2]
    moved, found = np.diag(sizes), np.zeros((len(on.t), on.nz))
    found[0] = np.linalg.norm(C[0] @ moved, axis=1)
    for k in range(len(Phi)):
        moved = Phi[k] @ moved
        found[k + 1] = np.linalg.norm(C[k + 1] @ moved, axis=1)
    return found


def nominal(on: Stretches, rows: list[int]) -> Array:
    """The nominal's states and outputs of these rows of [x; y] at the ends of stretches, (m + 1, nz)."""
    model = on.model
    return splined(model.t, np.concatenate([model.x, model.y], axis=1)[:, rows], on.t)
