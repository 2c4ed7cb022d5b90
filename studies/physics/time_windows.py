"""A motion of a fine model window by window of its time, where Newton's method on the whole of it does not settle.

Over a window of some control periods a guess stays nearer to a motion than over the whole: what grows has less time to.
Each window begins where the last one ended and is guessed to go on as it did: what the simple model has goes on
without accelerations, what bends stays as bent. A window is settled as a motion of its own; the next is longer where it
took few passes, and shorter where it does not settle. Together they begin passes over the whole motion.

Source   P. Deuflhard, "Newton Methods for Nonlinear Problems" (2004), 7.1: one window after another is the initial
         value problem, all of them at once multiple shooting
"""

from __future__ import annotations

import numpy as np

from pliant.plants import Plant, PliantError

from .motion_nodes import MotionNodes
from .quasi_linear import CorrectedMotion, NotSettled

Array = np.ndarray
FIRST = 8  # control periods of the first window
LONGER, SHORTER = 2, 4  # times as long is the next after one of FEW passes, as short the same one where it fails
FEW = 5
MOST = 400  # windows tried


def window_by_window(
    fine: Plant, simple: Plant, nodes: MotionNodes, x0: Array, columns: list[int], within: float
) -> CorrectedMotion:
    """The motion of `fine` from x0 (nx,), each window settled to `within` of its outputs, before passes over the whole.

    NotSettled where a single control period does not settle, or what the model cannot be evaluated at.
    """
    periods, m = len(nodes.times) - 1, 2 * nodes.parts
    rate, drifts = np.empty((m * periods, fine.nx)), np.asarray(fine.embedding(simple).any(axis=1))
    here, first, length = x0, 0, FIRST
    for _ in range(MOST):
        last = min(first + length, periods)
        own = MotionNodes(nodes.times[first : last + 1], nodes.held[first : last + 1], nodes.parts)
        try:
            window = CorrectedMotion(fine, own, here, _drifting(fine, here, len(own.gauss), drifts), here, columns)
            window.settle(within)
        except PliantError:
            if last - first == 1:
                raise
            length = max(min(length, last - first) // SHORTER, 1)
            continue
        rate[m * first : m * last] = window.rate
        here, first = window.at_ends[-1], last
        if first == periods:
            return CorrectedMotion(fine, nodes, x0, rate, x0, columns, blocks=periods)
        if window.passes <= FEW:
            length *= LONGER
    raise NotSettled(f"{MOST} windows come to {nodes.times[first]:.3g} s")


def _drifting(fine: Plant, x: Array, count: int, drifts: Array) -> Array:
    """Rates (count, nx) of a motion from x (nx,) without accelerations, of the states (nx,) that drift."""
    rate, balance = np.zeros((count, len(x))), fine.force_balance
    if balance is not None:
        n = balance.first
        rate[:, :n] = np.where(drifts[:n], balance.rates(x[None])[0], 0.0)
    return rate
