"""Ellipsoids e'S e <= c that the law held after the end of a motion does not leave, and the way into them.

    e+ = F e + g,  F = A - B K about the goal,  g what the goal lacks of being at rest (or of moving as it is said to)

From e'S e <= c follows e+'S e+ <= c where  r sqrt(c) + sqrt(g'S g) <= sqrt(c),  r^2 the largest of F'S F against S.
That is a hypothesis on S, which not every weight of the last state fulfils: P_T does where it is the cost to go of the
held law, else r > 1 and a state inside goes out. Then S solves the Lyapunov equation F'S F - S + M = 0 of the law
itself, M what it costs in a period ("Nonlinear Systems", Khalil 2002, Section 4.3, in discrete time). A motion that
costs nothing for a period makes r = 1, and rounding says on which side: S of the law that decays more slowly, F/s with
s between the largest |eigenvalue| of F and 1, has r <= s.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.argument_gates import shown
from pliant.plants.core.matrix_roots import semidefinite_root

Array = np.ndarray
NOTHING = 1e-13  # eigenvalue of an equilibrated S, against the largest, of a direction that costs nothing
LEAK = 1e-9  # part of a map that counts as one, in a direction that costs nothing
GROWTH = 1e-10  # of r over one that is rounding


class Hold(NamedTuple):
    """The law u = u_goal - K (x - x_goal) after the end, about the model of a period there."""

    A: Array  # (nx, nx)
    B: Array  # (nx, nu)
    K: Array  # (nu, nx)
    rest: Array  # (nx,) where the goal's own state is after a period, less the goal then
    cost: Array  # (nx + nu, nx + nu) of a period, of [x; u]

    @property
    def closed(self) -> Array:
        """A - B K."""
        return np.asarray(self.A - self.B @ self.K)


def given_hold(hold: Any) -> Any:
    """ValueError unless it is None or K, x_goal, u_goal."""
    if hold is not None and not (isinstance(hold, (tuple, list)) and len(hold) == 3):
        raise ValueError(f"TVLQR.hold = {shown(hold)} must be (K, x_goal, u_goal)")
    return hold


def invariant(hold: Hold, P: Array) -> tuple[Array, float] | None:
    """(S (nx, nx), least sqrt(c) at which the ellipsoid is not left), S = P where P allows it.

    Else S is as large as S <= P allows, so that a state within a level of P is within the same level of S.

    None where neither P nor the law's own cost to go is a Lyapunov function of the law: nothing can be said.
    """
    F = hold.closed
    radius = float(np.abs(np.linalg.eigvals(F)).max(initial=0.0))
    for S in (P, _own(hold, F, radius, 1.0), _own(hold, F, radius, (1 + radius) / 2)):
        if S is None:
            continue
        outside = gain(np.eye(len(S)), S, P) if S is not P else 1.0
        S = S / outside**2 if 0 < outside < np.inf else S
        r, push = gain(F, S, S), float(np.sqrt(max(hold.rest @ S @ hold.rest, 0.0)))
        if r < 1 and np.any(S):
            return S, push / (1 - r)
        if r <= 1 + GROWTH and push == 0 and np.any(S):
            return S, 0.0
    return None


def gain(F: Array, S: Array, P: Array) -> float:
    """The least r with |F e|_S <= r |e|_P for every e, infinity where there is none: |e|_P^2 = e'P e."""
    seen, unseen = axes(P)
    through = semidefinite_root(S).T @ F
    if unseen.shape[1] and np.linalg.norm(through @ unseen) > LEAK * np.linalg.norm(
        through @ np.hstack([seen, unseen])
    ):
        return float("inf")
    return float(np.linalg.norm(through @ seen, 2)) if seen.shape[1] else 0.0


def axes(P: Array) -> tuple[Array, Array]:
    """E (nx, r) with E'P E = 1, and a base (nx, nx - r) of the directions that cost nothing; equilibrated first."""
    size = np.sqrt(np.maximum(np.diag(P), 0.0))
    unit = 1 / np.where(size > 0, size, 1.0)
    value, vector = np.linalg.eigh(P * unit[:, None] * unit)
    costly = value > NOTHING * max(value[-1], 0.0)
    return unit[:, None] * vector[:, costly] / np.sqrt(value[costly]), unit[:, None] * vector[:, ~costly]


def _own(hold: Hold, F: Array, radius: float, slower: float) -> Array | None:
    """The held law's cost to go, as if it decayed more slowly, F/slower; None where it does not stay bounded."""
    if radius >= slower or radius >= 1:
        return None
    law = np.vstack([np.eye(len(F)), -hold.K])
    S = sla.solve_discrete_lyapunov(F.T / slower, law.T @ hold.cost @ law)
    return np.asarray((S + S.T) / 2)
