"""The linear model of a spacecraft in signals that a controller can read by name.

The deviations of `linearisation` are not signals: q is a small turn, the rates are those of the deviations. Here
the attitude outputs stand for q and the body rates themselves for dq/dt, by an exact change of coordinates z = S xi.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.linear.lti import LinearModel

from .declaration import SpacecraftDeclaration
from .linearisation import deviation_maps

FELT = 1e-9  # of the largest entry of A above which the rest feels the attitude
TURNS = 1e-12  # [rad/s] above which the attitude turns


def feedback_model(craft: SpacecraftDeclaration, x0: Any, u0: Any, p: Any) -> LinearModel:
    """See FlexibleSpacecraft.feedback_model."""
    model = craft.linearize(x0, u0, p=p)
    x = np.asarray(x0, dtype=float)
    at, n = craft.layout, craft.nx - 1
    attitude = slice(at.quaternion.start, at.quaternion.stop - 1)
    dx = craft.dynamics(x, u0, p=p)
    turns = bool(np.abs(dx[at.quaternion]).max() > TURNS)
    T = deviation_maps(craft, x)[0]
    kept = np.delete(np.arange(craft.nx), np.arange(at.quaternion.start, at.quaternion.stop))
    S = np.zeros((n, n))
    S[np.delete(np.arange(n), np.arange(attitude.start, attitude.stop))] = T[kept]
    S[attitude] = np.eye(n)[attitude] if turns else model.C[:3]
    A, B, E, C = S @ np.linalg.solve(S.T, model.A.T).T, S @ model.B, S @ model.E, np.linalg.solve(S.T, model.C.T).T
    signals = list(np.insert(np.delete(np.arange(craft.nx), np.r_[at.quaternion]), attitude.start, [-3, -2, -1]))
    states = tuple(craft.outputs[i + 3] if i < 0 else craft.states[i] for i in signals)
    values = np.array([model.y0[i + 3] if i < 0 else x[i] for i in signals])
    rates = np.array([0.0 if i < 0 else dx[i] for i in signals])
    rows, outputs = np.arange(n), np.arange(craft.ny)
    if turns:
        rows = np.delete(rows, np.r_[attitude])
        outputs = outputs[3:]
        if np.abs(A[np.ix_(rows, np.r_[attitude])]).max() > FELT * np.abs(A).max():
            raise ValueError(
                f"feedback_model: the attitude of {craft.label} turns at x0 (quaternion rates {dx[at.quaternion]}) and "
                "the rest feels it: no constant feedback can be designed there"
            )
    square = np.ix_(rows, rows)
    return LinearModel(
        A[square],
        B[rows],
        E[rows],
        C[np.ix_(outputs, rows)],
        model.D[outputs],
        model.F[outputs],
        states=tuple(states[i] for i in rows),
        inputs=model.inputs,
        disturbances=model.disturbances,
        outputs=tuple(model.outputs[i] for i in outputs),
        x0=values[rows],
        u0=model.u0,
        w0=model.w0,
        y0=model.y0[outputs],
        f0=rates[rows],
    )
