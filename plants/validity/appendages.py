"""Ranges of appendages given by modal data: small slopes, without stiffening also shortening and spin.

The derivations are those of `slender`: an appendage is a clamped beam or panel, or a body of which no more is known
than shapes at points. Its slope is the largest turn of the line between two points that follow each other in the
outline; where that is coarse, slopes between its points are not seen.

Spin        The inertia force -A (b + r), A = omega omega^T - omega^2 1, of a body that turns at omega, its root at b
            from the hub's centre, works on the shortening (1/2) g_kl eta_k eta_l: a stiffness G_kl = -int (b + r)^T A
            g_kl dm. Its share of K_kk is told for the mode where it is largest.
"""

from __future__ import annotations

from typing import Protocol

import casadi as ca
import numpy as np

from .ranges import Range
from .slender import AXIAL, SHORTENING, SLOPE, STIFFENED

LARGE = "no kinematics of FlexibleSpacecraft; for one boom alone LargeDeflectionBeam"
SAME = 1e-6  # of the outline's size: points nearer are one


class Shapes(Protocol):
    """What is asked of modal data."""

    @property
    def outline(self) -> np.ndarray: ...  # (m, 3)
    @property
    def outline_shapes(self) -> np.ndarray: ...  # (n, m, 3)
    @property
    def stiffness(self) -> np.ndarray: ...  # (n, n)
    @property
    def shortening(self) -> np.ndarray: ...  # (n, n, 3)
    @property
    def shortening_moments(self) -> np.ndarray: ...  # (n, n, 3, 3)
    @property
    def mass(self) -> float: ...


def of_appendage(
    name: str,
    data: Shapes,
    eta: ca.SX,
    omega: ca.SX,
    root: ca.SX,
    factor: ca.SX | float,
    stiffened: bool,
) -> list[Range]:
    """Ranges of one appendage at modal coordinates eta (n,), which turns at omega (3,), its root at `root` (3,), all in
    its axes; `factor` multiplies its stiffness.
    """
    if not eta.shape[0]:
        return []
    n, lines = eta.shape[0], _lines(data)
    keeps = "elastic forces err by less than 5 %"
    turn = ca.SX(0)
    for rows in lines:
        turn = ca.fmax(turn, ca.sumsqr(ca.DM(rows[:, :n]) @ eta))
    found = [Range(f"slope of {name}", "rad", SLOPE, keeps, LARGE, ca.sqrt(turn))]
    if stiffened:
        return found
    keeps = "leaving it out misplaces the tip by less than 1 % of the length"
    found.append(
        Range(f"shortening of {name} over its length", "1", SHORTENING, keeps, STIFFENED, _shortening(data, eta))
    )
    keeps = "leaving it out takes static deflections wrong by less than 5 %"
    A = omega @ omega.T - ca.sumsqr(omega) * ca.SX.eye(3)
    share = ca.SX(0)
    for k in range(n):
        g, moments = ca.DM(data.shortening[k, k]), ca.DM(data.shortening_moments[k, k])
        G = -(ca.dot(A @ root, g) + ca.sum1(ca.sum2(A * moments)))
        share = ca.fmax(share, ca.fabs(G) / (factor * float(data.stiffness[k, k])))
    quantity = f"stiffening of {name} by spin over its modal stiffness"
    return [*found, Range(quantity, "1", AXIAL, keeps, STIFFENED, share)]


def _lines(data: Shapes) -> list[np.ndarray]:
    """For each line between two points of the outline, across it: turn [rad] of each shape, (3, n)."""
    size = np.linalg.norm(data.outline, axis=1).max()
    found = []
    for a, b in zip(range(len(data.outline) - 1), range(1, len(data.outline))):
        line = data.outline[b] - data.outline[a]
        length = np.linalg.norm(line)
        if length > SAME * size:
            moved = (data.outline_shapes[:, b] - data.outline_shapes[:, a]).T / length
            along = line / length
            found.append(moved - np.outer(along, along @ moved))
    return found


def _shortening(data: Shapes, eta: ca.SX) -> ca.SX:
    """(1/2) sum of turn^2 times length over the outline's lines, over its size: that of a line of points."""
    n, total, whole = eta.shape[0], ca.SX(0), 0.0
    lengths = np.linalg.norm(np.diff(data.outline, axis=0), axis=1)
    size = np.linalg.norm(data.outline, axis=1).max()
    for length, rows in zip(lengths[lengths > SAME * size], _lines(data), strict=True):
        total += ca.sumsqr(ca.DM(rows[:, :n]) @ eta) * length / 2
        whole += float(length)
    return total / whole if whole else ca.SX(0)
