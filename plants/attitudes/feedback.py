"""The linear model of a plant with quaternions in signals that a controller can read by name.

Small turns are no signals, and their rates are not the angular velocities. Here the attitude's outputs stand for the
turns and the angular velocities themselves for their rates, by an exact change of coordinates z = S xi.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.core.signals import index
from pliant.plants.linear.lti import LinearModel

from .deviations import Attitude

FELT = 1e-9  # of the largest entry of A above which the rest feels an attitude
TURNS = 1e-12  # [rad/s] above which an attitude turns


def feedback_model(plant: Any, x0: Any, u0: Any, p: Any) -> LinearModel:
    """The attitude's outputs in the place of turns; an attitude that turns at (x0, u0) is left out, ValueError where
    the rest feels it.
    """
    model = plant.linearize(x0, u0, p=p)
    x, dx, at = np.asarray(x0, dtype=float), plant.dynamics(x0, u0, p=p), plant.small
    S, n = np.zeros((at.n, at.n)), at.n
    S[[at.at(k) for k in at.kept]] = at.forward(x)[at.kept]
    states, values, rates = list(model.states), np.zeros(n), np.zeros(n)
    for k in at.kept:
        states[at.at(k)], values[at.at(k)], rates[at.at(k)] = plant.states[k], x[k], dx[k]
    gone, told, turning = list[int](), list[int](), list[Attitude]()
    told_by = [index(plant.outputs, name, "output") for name in plant.attitude_outputs]  # three of each attitude
    for i, a in enumerate(plant.attitudes):
        turn, outputs = range(n)[at.turn(a)], told_by[3 * i : 3 * i + 3]
        turns = bool(np.abs(dx[a.quaternion]).max() > TURNS)
        for j, k in zip(turn, outputs, strict=True):
            S[j] = np.eye(n)[j] if turns else model.C[k]
            states[j], values[j] = plant.outputs[k], model.y0[k]
        if turns:
            gone, told, turning = [*gone, *turn], [*told, *outputs], [*turning, a]
    A, C = S @ np.linalg.solve(S.T, model.A.T).T, np.linalg.solve(S.T, model.C.T).T
    B, E = S @ model.B, S @ model.E
    rows = [k for k in range(n) if k not in gone]
    outputs = [k for k in range(plant.ny) if k not in told]
    for a in turning:
        if np.abs(A[rows, at.turn(a)]).max() > FELT * np.abs(A).max():
            whose = f"{a.name!r} of {plant.label}" if a.name else plant.label
            raise ValueError(
                f"feedback_model: the attitude of {whose} turns at x0 (quaternion rates {dx[a.quaternion]}) and the "
                "rest feels it: no constant feedback can be designed there"
            )
    return LinearModel(
        A[np.ix_(rows, rows)], B[rows], E[rows], C[np.ix_(outputs, rows)], model.D[outputs], model.F[outputs],
        states=tuple(states[i] for i in rows),
        inputs=model.inputs,
        disturbances=model.disturbances,
        outputs=tuple(model.outputs[i] for i in outputs),
        x0=values[rows],
        u0=model.u0,
        w0=model.w0,
        y0=model.y0[outputs],
        f0=rates[rows],
    )  # fmt: skip
