"""How far disturbances and deviations at the start can push outputs at each time of a motion, and which do.

Of unit energy       |z_i(t)| <= sqrt(c_i W(t) c_i'), W the Gramian of what is reached; the disturbance that attains it
                     is w(s) = E(s)' Phi(t, s)' c_i' / sqrt(..)
Bounded, |w_j| <= 1  |z_i(t)| <= integral of |c_i Phi(t, s) E_j(s)| over s, attained by its signs
White, of unit intensity, and a start of covariance P0: the standard deviation sqrt(c_i (W + Phi P0 Phi') c_i')
"""

from __future__ import annotations

import numpy as np

from .stretches import ACROSS, Stretches

Array = np.ndarray
BETWEEN = np.linspace(0.0, 1.0, 9)  # parts of a stretch


def gramians(on: Stretches, start: Array | None = None) -> Array:
    """W (m + 1, n, n) at the ends of stretches; `start` (n, n): its value at the first."""
    Phi, step = on.held[0], on.reached
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


def worst_bounded(on: Stretches, at: int, row: int) -> tuple[Array, float, float]:
    """The disturbance (m + 1, nw), of 1 and -1, that pushes z_row furthest at t[at]; how far; at most how far.

    Where the effect changes its sign within a stretch, holding loses something: the integral of the modulus, by
    Simpson's rule, is the bound.
    """
    later, Gamma, E = backward(on, at, row), on.held[1], on.nodes[1]
    found, through = np.zeros((len(on.t), on.nw)), on.nodes[3][at, row]
    effect = np.einsum("ki,kij->kj", later[1:], Gamma[:at])
    found[at] = np.where(through < 0, -1.0, 1.0)
    found[:at] = np.where(effect < 0, -1.0, 1.0)
    ends = np.einsum("ki,kij->kj", later, E[: at + 1])  # c Phi(t, s) E(s) at the ends
    h = on.h[:at, None]
    change = (ends[1:] * ends[:-1]) < 0
    crossing = (np.square(ends[1:]) + np.square(ends[:-1])) / (2 * np.maximum(np.abs(ends[1:] - ends[:-1]), 1e-300)) * h
    most = np.where(change, np.maximum(np.abs(effect), crossing), np.abs(effect)).sum()
    passed = np.abs(through).sum()
    return found, float(np.abs(effect).sum() + passed), float(most + passed)


def by_bounded(on: Stretches) -> Array:
    """The most (m + 1, nz) that |z_i| can be at each end of a stretch, |w_j| <= 1 and held over stretches."""
    (Phi, Gamma), (_, _, C, F) = on.held, on.nodes
    m, n, nw = len(on.h), on.n, on.nw
    moved, found = np.zeros((n, m * nw)), np.abs(F).sum(axis=2)
    for k in range(m):
        moved[:, : k * nw] = Phi[k] @ moved[:, : k * nw]
        moved[:, k * nw : (k + 1) * nw] = Gamma[k]
        found[k + 1] += np.abs(C[k + 1] @ moved[:, : (k + 1) * nw]).sum(axis=1)
    return found
