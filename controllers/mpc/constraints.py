"""Limits on a predicted motion as rows of lower <= G p + M z <= upper, in what is known (p) and what is chosen (z).

Known are p = [x, x_s, u_s, d, u_-1]: the state, the steady state and input that the deviations xi = x - x_s,
mu = u - u_s are counted from, a disturbance of the outputs, the last input. Where x_s and u_s are fixed, as a nominal
or a goal is, they are no part of p but of the bounds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pliant.controllers.solvers.daqp_model import INFINITE
from pliant.controllers.solvers.least_distance_qp import LeastDistance
from pliant.plants.core.signals import OwnsArrays

from .condensed_prediction import Prediction


@dataclass(frozen=True, eq=False)
class Limits(OwnsArrays):
    """Lowest and highest inputs, changes of inputs from step to step, and bounded signals z = C x + D u by name."""

    inputs: tuple[str, ...]
    low: np.ndarray  # (nu,)
    high: np.ndarray  # (nu,)
    change: np.ndarray  # (nu,) largest, inf where there is none
    bounded: tuple[str, ...]
    floor: np.ndarray  # (nb,) lowest
    ceiling: np.ndarray  # (nb,) highest

    @property
    def remembers(self) -> bool:
        """Whether the last input matters."""
        return bool(np.isfinite(self.change).any())


class Window(NamedTuple):
    """What the prediction starts from: references, and the bounded signals, at each of its steps."""

    u: np.ndarray  # (n, nu) reference inputs
    x: np.ndarray  # (nx,) reference state now
    z: np.ndarray  # (n + 1, nb) reference values of the bounded signals
    C: np.ndarray  # (n + 1, nb, nx)
    D: np.ndarray  # (n + 1, nb, nu)
    seen: np.ndarray | None = None  # (nb, nd) of the disturbance d in the bounded signals; None: x_s, u_s are fixed
    direct: np.ndarray | None = None  # (nb,) which signals have feedthrough, at one time at least; None: as D has


class Step(NamedTuple):
    """One optimisation: bounds low - G p, high - G p, input u + (last rows of G) p + first z."""

    G: np.ndarray  # (m + nu, np)
    low: np.ndarray  # (m,)
    high: np.ndarray  # (m,)
    u: np.ndarray  # (nu,)
    first: np.ndarray  # (nu, nz)
    solver: LeastDistance
    plan: tuple[
        np.ndarray, np.ndarray, np.ndarray
    ]  # planned inputs = plan[0] p + plan[1] z + plan[2], (horizon, nu, .)
    scale: np.ndarray  # (m,) of a row, in the limited signal's unit
    names: np.ndarray  # (m,) which soft limit a row is of, -1: none
    stride: int  # rows of one step of the horizon


class _Row(NamedTuple):
    name: int  # of the soft limit, -1: hard
    map: np.ndarray  # (nx + nz + 1,) on [xi_0; z; 1]
    Fx: np.ndarray  # (nx,) on x_s
    Fu: np.ndarray  # (nu,) on u_s
    Fd: np.ndarray  # (nd,) on d
    last: np.ndarray  # (nu,) on the last input
    reference: float
    low: float
    high: float


def soft_names(limits: Limits, horizon: int, steps: int) -> tuple[str, ...]:
    """Names of the limits that may be exceeded: bounded signals, and the inputs where limited past the horizon."""
    past = tuple(f"{name} past the horizon" for name in limits.inputs) if steps > horizon else ()
    return limits.bounded + past


def assemble(motion: Prediction, window: Window, limits: Limits, horizon: int) -> list[_Row]:
    """Rows of all steps, each step alike: inputs, changes of inputs, bounded signals."""
    n, nu = motion.U.shape[:2]
    nx, nb = motion.X.shape[1], len(limits.bounded)
    nd = 0 if window.seen is None else window.seen.shape[1]
    none_x, none_u, none_d, one = np.zeros(nx), np.zeros(nu), np.zeros(nd), np.eye(nu)
    direct = np.asarray(window.D.any(axis=(0, 2))) if window.direct is None else window.direct
    rows: list[_Row] = []
    for j in range(n):
        for i in range(nu):
            past = nb + i if j >= horizon else -1
            if np.isfinite([limits.low[i], limits.high[i]]).any():
                ends = limits.low[i], limits.high[i]
                rows.append(_Row(past, motion.U[j, i], none_x, one[i], none_d, none_u, window.u[j, i], *ends))
            if np.isfinite(limits.change[i]):
                ends = -limits.change[i], limits.change[i]
                if j:
                    step, before = motion.U[j, i] - motion.U[j - 1, i], window.u[j, i] - window.u[j - 1, i]
                    rows.append(_Row(past, step, none_x, none_u, none_d, none_u, before, *ends))
                else:
                    rows.append(_Row(-1, motion.U[0, i], none_x, one[i], none_d, -one[i], window.u[0, i], *ends))
        for i in range(nb):
            at = j if direct[i] else j + 1  # what no input reaches yet is not limited
            if at == j:
                signal = window.C[j, i] @ motion.X[j] + window.D[j, i] @ motion.U[j]
            else:
                signal = window.C[at, i] @ motion.X[at]
            seen = none_d if window.seen is None else window.seen[i]
            ends = limits.floor[i], limits.ceiling[i]
            if not signal[motion.X.shape[1] : -1].any():
                ends = -np.inf, np.inf  # inputs on their way move it, and no plan does
            Du = window.D[at, i] if at == j else none_u
            rows.append(_Row(i, signal, window.C[at, i], Du, seen, none_u, window.z[at, i], *ends))
    return rows


def build(
    motion: Prediction, window: Window, limits: Limits, horizon: int, penalty: float | None, hard: bool = False
) -> Step:
    """The optimisation of one time. `penalty` None: none of the rows is soft where `hard`, else found by sampling."""
    nx, nu = motion.X.shape[1], motion.U.shape[1]
    tracks = window.seen is not None
    rows = assemble(motion, window, limits, horizon)
    nz = motion.X.shape[2] - nx - 1

    def known(M: np.ndarray, Fx: np.ndarray, Fu: np.ndarray, Fd: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Columns of p."""
        parts = [M[:, :nx]]
        if tracks:
            parts += [Fx - M[:, :nx], Fu, Fd]
        if limits.remembers:
            parts.append(last)
        return np.hstack(parts)

    def fixed(M: np.ndarray, Fx: np.ndarray, Fu: np.ndarray, reference: np.ndarray) -> np.ndarray:
        """The part that does not depend on p and z."""
        moved = Fx @ window.x + Fu @ window.u[0] if tracks else M[:, :nx] @ window.x
        return M[:, -1] + reference - moved

    def stack(name: str, width: int) -> np.ndarray:
        return np.array([getattr(row, name) for row in rows], dtype=float).reshape(len(rows), width)

    maps, Fx, Fu = stack("map", nx + nz + 1), stack("Fx", nx), stack("Fu", nu)
    Fd = stack("Fd", 0 if window.seen is None else window.seen.shape[1])
    low, high = (np.array([getattr(row, name) for row in rows], dtype=float) for name in ("low", "high"))
    scale = _scales(low, high)
    constant = fixed(maps, Fx, Fu, np.array([row.reference for row in rows], dtype=float))
    G = known(maps, Fx, Fu, Fd, stack("last", nu)) / scale[:, None]
    M = maps[:, nx : nx + nz] / scale[:, None]
    low, high = (np.clip((ends - constant) / scale, -INFINITE, INFINITE) for ends in (low, high))
    names = np.array([row.name for row in rows], dtype=int)

    U = motion.U[:horizon].reshape(horizon * nu, -1)
    one, none_x = np.tile(np.eye(nu), (horizon, 1)), np.zeros((horizon * nu, nx))
    Gu = known(U, none_x, one, np.zeros((len(U), Fd.shape[1])), np.zeros((len(U), nu)))
    u0 = fixed(U, none_x, one, window.u[:horizon].ravel())
    plan = Gu.reshape(horizon, nu, -1), U[:, nx : nx + nz].reshape(horizon, nu, nz), u0.reshape(horizon, nu)
    soft = (names >= 0) & (not hard)
    solver = LeastDistance(M, soft, 0.0 if penalty is None else penalty)
    everything = np.ascontiguousarray(np.vstack([G, plan[0][0]]))
    first = np.ascontiguousarray(plan[1][0])
    return Step(everything, low, high, plan[2][0].copy(), first, solver, plan, scale, names, len(rows) // len(motion.U))


def excess(step: Step, z: np.ndarray, lower: np.ndarray, upper: np.ndarray, count: int) -> np.ndarray:
    """Largest excess over each of `count` soft limits in the plan z (nz,) under the bounds of its rows [their unit]."""
    rows = np.dot(step.solver.M, z)
    beyond = np.maximum(rows - upper, lower - rows) * step.scale
    found, soft = np.zeros(count), step.names >= 0
    np.maximum.at(found, step.names[soft], beyond[soft])
    return found


def _scales(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Half the range, or the size of the only end, of each row; one where that is nothing."""
    both = np.isfinite(low) & np.isfinite(high)
    size = np.where(np.isfinite(low), np.abs(low), np.abs(high))
    size[both] = (high[both] - low[both]) / 2
    return np.where(np.isfinite(size) & (size > 0), size, 1.0)
