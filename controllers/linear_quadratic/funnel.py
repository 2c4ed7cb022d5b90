"""The region about a nominal in which a time-varying linear law stays within its limits.

V_k(e) = e'P_k e falls along the linear loop, e the deviation from its nominal, since it is a cost to go. The law is
u_k - K_k e, and |K_k,i e| <= sqrt(V_k(e) K_k,i P_k^-1 K_k,i'). So from V_k(e) <= level_k,

    level_k = min over j >= k and inputs i of margin_j,i^2 / (K_j,i P_j^-1 K_j,i'),

no input reaches a limit from k on: a theorem for the linear time-varying model, the law about the goal after the end
included (before it the levels are smaller by the step that the nominal takes there). On the plant itself it is an
estimate, good as long as the deviations are small enough for that model; it says nothing of other plants, and nothing
of the states outside, from which the law may hold as well.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from pliant.plants.core.parameters import require_finite

NOTHING = 1e-13  # eigenvalue of P, against the largest, of a direction that costs nothing


@final
@dataclass(frozen=True, eq=False)
class Funnel:
    """Ellipsoids e'P e <= level about x at the control times; the last one holds from then on."""

    t: np.ndarray  # (T+1,) [s]
    x: np.ndarray  # (T+1, nx) centres
    P: np.ndarray  # (T+1, nx, nx)
    level: np.ndarray  # (T+1,) zero where the nominal itself is at a limit

    @classmethod
    def about(
        cls,
        t: np.ndarray,
        x: np.ndarray,
        u: np.ndarray,
        K: np.ndarray,
        P: np.ndarray,
        limits: tuple[np.ndarray, np.ndarray],
        handover: np.ndarray | None,
    ) -> Funnel:
        """From nominal x (T+1, nx), u (T+1, nu), gains K (T+1, nu, nx), P (T+1, nx, nx) and limits (nu,).

        The last of each is of the law about the goal; handover (nx,) is the end of the nominal less the goal. None:
        there is no such law, and nothing is said of the time after the end.
        """
        value, vector = np.linalg.eigh(P)
        costly = value > NOTHING * value[:, -1:]
        along = K @ vector  # gains along the axes of the ellipsoids
        free = np.abs(np.where(costly[:, None, :], 0.0, along)).max(axis=2) > 1e-9 * np.abs(along).max(axis=2)
        inverse = np.where(costly, 1.0 / np.where(costly, value, 1.0), 0.0)
        reach = np.einsum("kij,kj->ki", along**2, inverse)
        margin = np.maximum(np.minimum(limits[1] - u, u - limits[0]), 0.0)
        each = np.full(margin.shape, np.inf)
        np.divide(margin**2, reach, out=each, where=reach > 0)
        level = np.where(free, 0.0, each).min(axis=1)
        if handover is None:
            level[-1] = np.inf
        else:
            left = np.sqrt(level[-1]) - np.sqrt(max(float(handover @ P[-1] @ handover), 0.0))
            level[-2] = min(level[-2], max(left, 0.0) ** 2)
        return cls(t, x, P, np.minimum.accumulate(level[::-1])[::-1])

    def place(self, t: float) -> int:
        """The index of the last control time not after t [s]."""
        return int(np.clip(np.searchsorted(self.t, t * (1 + 1e-12) + 1e-12, side="right") - 1, 0, len(self.t) - 1))

    def use(self, t: float, x: np.ndarray) -> float:
        """V / level at time t [s] and state x (nx,): up to 1 inside; infinity where the level is zero."""
        k = self.place(t)
        e = require_finite("Funnel.x", x, self.x.shape[1:]) - self.x[k]
        V = float(e @ self.P[k] @ e)
        if self.level[k] > 0:
            return V / float(self.level[k])
        return np.inf if V > 0 else 0.0

    def inside(self, t: float, x: np.ndarray) -> bool:
        """Whether no input of the linear law reaches a limit from x (nx,) at time t [s] on."""
        return self.use(t, x) <= 1.0
