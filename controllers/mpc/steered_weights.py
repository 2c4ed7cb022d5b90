"""Weights and cost to go of an MPC where something is conserved or free, as LQR has them (see `riccati.steerable`).

With z = down x the part that inputs steer and u = F x + v, the cost z'Q z + v'R v + 2 z'N v is one of x and u:

    Q_x = down'Q down - down'N F - (down'N F)' + F'R F    N_x = down'N - F'R    P_x = down'P down

so that the prediction stays one of all states and its law without limits is LQR's.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.quadratic_weights import weight_matrices
from pliant.controllers.riccati.steerable import steerable
from pliant.plants.core.argument_gates import require_finite, require_seconds
from pliant.plants.linear.lti import LinearModel

Array = np.ndarray


class SteeredWeights(NamedTuple):
    """Of x'Q x + u'R u + 2 x'N u, continuous, and P (nx, nx) of its cost to go, inputs held over a step."""

    Q: Array
    R: Array
    N: Array
    P: Array | None  # None: nothing is conserved or free, the cost to go is that of the problem as it stands
    left: tuple[tuple[str, ...], tuple[str, ...]]  # in words: what is conserved, what is free


def step_weights(model: LinearModel, Q: Any, R: Any, N: Any) -> tuple[Array, Array, Array]:
    """(Q, R, N) as arrays."""
    Q, R, cross = weight_matrices("MPC", model, Q, R)
    return Q, R, cross if N is None else cross + require_finite("MPC.N", N, cross.shape)


def steered_weights(model: LinearModel, Q: Any, R: Any, N: Any, dt: Any, start: Any) -> SteeredWeights:
    """Of a continuous model. start (nx,): where the motion begins; what is conserved and weighed must have the goal's
    value there, else UncontrollableError names it.
    """
    given, (Q, R, N) = (Q, R, N), step_weights(model, Q, R, N)
    off = None if start is None else require_finite("MPC.start", start, model.x0.shape) - model.x0
    part = steerable(model.A, model.B, Q, N, model.state_names, start=off)
    if dt is None or len(part.names) == len(model.A):
        return SteeredWeights(*given, None, ((), ()))
    dt = require_seconds("MPC.dt", dt)
    Qz, Nz = part.weights(Q, N)
    found = riccati.dlqr(*riccati.sampled(*part.system(model.A, model.B), Qz, R, Nz, dt=dt), names=part.names, dt=dt)
    cross = part.down.T @ Nz
    bent = cross @ part.F
    Q = part.down.T @ Qz @ part.down - bent - bent.T + part.F.T @ R @ part.F
    return SteeredWeights((Q + Q.T) / 2, R, cross - part.F.T @ R, part.cost(found.P), (part.conserved, part.free))
