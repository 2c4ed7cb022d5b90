"""The region about a nominal in which a time-varying linear law stays within its limits.

V_k(e) = e'P_k e falls along the linear loop, e the deviation from its nominal, since it is a cost to go. The law is
u_k - K_k e, and |K_k,i e| <= sqrt(V_k(e) K_k,i P_k^-1 K_k,i'). So from V_k(e) <= level_k,

    level_k = min over j >= k and inputs i of margin_j,i^2 / (K_j,i P_j^-1 K_j,i'),

no input reaches a limit from k on: a theorem for the linear time-varying model, the law about the goal after the end
included. For that law V must fall too: hold_set.py takes an ellipsoid that it does not leave, and the levels before
the end are those from which the last step leads into it; there is none (level 0) where that cannot be shown. On the
plant itself it is an
estimate, good as long as the deviations are small enough for that model; it says nothing of other plants, and nothing
of the states outside, from which the law may hold as well.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from pliant.controllers.base.controller import moment
from pliant.plants.core.argument_gates import require_finite
from pliant.plants.core.signals import OwnsArrays

from .hold_set import LEAK, Hold, axes, gain, invariant


@final
@dataclass(frozen=True, eq=False)
class Funnel(OwnsArrays):
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
        last: np.ndarray | None = None,
        handover: np.ndarray | None = None,
        hold: Hold | None = None,
    ) -> Funnel:
        """From nominal x (T+1, nx), u (T+1, nu), gains K (T+1, nu, nx), P (T+1, nx, nx) and limits (nu,).

        The last of each is of the law about the goal, `hold`; handover (nx,) is the end of the nominal less the goal,
        last (nx, nx) the map of deviations over the last step. hold None: there is no such law, nothing is said of the
        time after the end, and no state counts as inside then.
        """
        margin = np.maximum(np.minimum(limits[1] - u, u - limits[0]), 0.0)
        level = np.array([_level(*each) for each in zip(K[:-1], P[:-1], margin[:-1])] + [np.inf])
        if hold is None or last is None or handover is None:
            level = np.minimum.accumulate(level[::-1])[::-1]
            level[-1] = 0.0
            return cls(t, x, P, level)
        found = invariant(hold, P[-1])
        if found is None:
            return cls(t, x, P, np.zeros(len(P)))
        S, least = found
        P = np.concatenate([P[:-1], S[None]])
        level[-1] = _level(K[-1], S, margin[-1])
        if np.sqrt(level[-1]) < least:
            level[-1] = 0.0
        left, through = np.sqrt(level[-1]) - np.sqrt(max(float(handover @ S @ handover), 0.0)), gain(last, S, P[-2])
        if level[-1] < np.inf:
            level[-2] = min(level[-2], (max(left, 0.0) / through) ** 2) if through > 0 else level[-2] * (left >= 0)
        return cls(t, x, P, np.minimum.accumulate(level[::-1])[::-1])

    def place(self, t: float) -> int:
        """The index of the last control time not after t [s]."""
        t = moment("Funnel", t)
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


def _level(K: np.ndarray, P: np.ndarray, margin: np.ndarray) -> float:
    """The largest level of e'P e at which every |K_i e| <= margin_i: K (nu, nx), margin (nu,)."""
    seen, unseen = axes(P)
    reach = np.linalg.norm(K @ seen, axis=1)
    free = np.abs(K @ unseen).max(axis=1, initial=0.0) > LEAK * np.abs(K @ np.hstack([seen, unseen])).max(axis=1)
    each = np.full(len(margin), np.inf)
    np.divide(margin, reach, out=each, where=reach > 0)
    return float(np.where(free, 0.0, each).min(initial=np.inf)) ** 2
