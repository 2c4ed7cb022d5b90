"""The part of a linear-quadratic problem that inputs can steer, where something is conserved or free.

A craft turned by wheels keeps its total momentum, whatever a loop does: an eigenvalue at rest that no Riccati equation
moves. Three cases, in this order:

unweighed  the cost does not see a state v at rest with that momentum: z = down x, down v = 0, is a problem of its own,
           with the same cost, so P = down' P_z down and K = K_z down, and v stays as it is
held       it does not see one either, but an input F x has to hold it there, as against a wheel's friction: the inputs'
           deviations from that are weighed, as from u0 at the goal
weighed    it sees every such state: the cost is infinite but where w'x is the goal's. Refused, unless a start is known
           that has the goal's; then the problem is the one restricted to w'x = 0

What is free, only inputs change it and neither the rest nor the cost feels it, as the spin that four wheels share, is
left as it is too. See `pliant.plants.linear.rest_spaces`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pliant.plants.core.errors import UncontrollableError
from pliant.plants.linear.rest_spaces import Conserved, conserved_by, keeping, unfelt

Array = np.ndarray
SAME = 1e-9  # share of its terms by which a conserved quantity differs from the goal's at most


class Steerable(NamedTuple):
    """The problem of z = down x and u = F x + v: its matrices by `system`, `weights`; x by `gain` and `cost`."""

    up: Array  # (nx, nz)
    down: Array  # (nz, nx)
    F: Array  # (nu, nx)
    names: tuple[str, ...]  # of z
    conserved: tuple[str, ...]
    free: tuple[str, ...]
    fixed: Array  # (k, nx) quantities that must have the goal's value

    def system(self, A: Array, B: Array) -> tuple[Array, Array]:
        """A (nz, nz), B (nz, nu) of z, continuous or sampled."""
        return self.down @ A @ self.up, self.down @ B

    def weights(self, Q: Array, N: Array) -> tuple[Array, Array]:
        """Q (nz, nz), N (nz, nu) of z."""
        return self.up.T @ Q @ self.up, self.up.T @ N

    def gain(self, K: Array) -> Array:
        """K (nu, nx + m) of u = -K x from that of z (nu, nz + m); the last m columns stay."""
        n = len(self.down)
        return np.hstack([K[:, :n] @ self.down - self.F, K[:, n:]])

    def cost(self, P: Array) -> Array:
        """P (nx + m, nx + m) from that of z (nz + m, nz + m)."""
        n, nx = self.down.shape
        m = len(P) - n
        wide = np.block([[self.down, np.zeros((n, m))], [np.zeros((m, nx)), np.eye(m)]])
        return wide.T @ P @ wide

    def same(self, off: Array) -> bool:
        """Whether a state `off` (nx,) the goal has the goal's value of what is fixed."""
        return bool((np.abs(self.fixed @ off) <= SAME * (np.abs(self.fixed) @ np.abs(off))).all())


def steerable(
    A: Array, B: Array, Q: Array, N: Array, names: tuple[str, ...], *, seen: Array | None = None, start: Any = None
) -> Steerable:
    """Of dx/dt = A x + B u, A (nx, nx), B (nx, nu), and x'Qx + 2 x'Nu; seen (m, nx): what else sees the state.

    start (nx,): where the motion begins, from the goal. UncontrollableError names what is conserved and weighed.
    """
    nx, nu = B.shape
    seen = np.zeros((0, nx)) if seen is None else seen
    kept = conserved_by(A, B, None, names).names
    loose = unfelt(A, B, np.vstack([Q, N.T, seen]), None, names)
    whole = Steerable(np.eye(nx), np.eye(nx), np.zeros((nu, nx)), names, kept, loose.names, np.zeros((0, nx)))
    if not kept and not loose.directions.shape[1]:
        return whole
    if loose.directions.shape[1] == nx:  # nothing is left to design: the Riccati equation says why
        return whole._replace(conserved=(), free=())
    part = whole._replace(up=loose.up, down=loose.down, names=tuple(names[i] for i in loose.others))
    left = conserved_by(*part.system(A, B), None, part.names)
    if not left.names:
        return part
    held = _held(part, left, A, B, np.block([[Q, N], [seen, np.zeros((len(seen), nu))]]))
    return _weighed(part, left, start) if held is None else held


def _held(part: Steerable, left: Conserved, A: Array, B: Array, weighed: Array) -> Steerable | None:
    """With inputs that hold every value of what is conserved, where nothing weighed (m, nx + nu) sees those."""
    nu, w = B.shape[1], left.quantities
    A, B = part.system(A, B)
    lift = np.block([[part.up, np.zeros((len(part.up), nu))], [np.zeros((nu, len(A))), np.eye(nu)]])
    v = keeping(np.hstack([w, np.zeros((len(w), nu))]), np.vstack([np.hstack([A, B]), weighed @ lift]))
    if v is None:
        return None
    at, hold = v[: len(A)], v[len(A) :]
    return _within(part, left, np.eye(len(A)) - at @ w)._replace(F=part.F + hold @ w @ part.down)


def _weighed(part: Steerable, left: Conserved, start: Any) -> Steerable:
    found = _within(part, left, np.eye(len(part.down)))._replace(fixed=left.tidy @ part.down)
    if start is None or not found.same(start):
        what, has = "; ".join(left.names), "" if start is None else ", as the start has,"
        raise UncontrollableError(
            f"{what}: cannot be reached by the input, which leaves its value as it is, and the cost weighs it, so that "
            f"any but the goal's{has} costs without end: leave it unweighed, or start where it has the goal's",
            tuple(f"mode 0.00 Hz ({name})" for name in left.names),
        )
    return found


def _within(part: Steerable, left: Conserved, away: Array) -> Steerable:
    """Restricted to the states where what is conserved is 0; away (nz, nz) brings the others there."""
    up, others = left.by_states()
    names = tuple(part.names[i] for i in others)
    return part._replace(up=part.up @ up, down=away[others] @ part.down, names=names)
