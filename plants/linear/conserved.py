"""The conserved quantities of a linear model, as the total momentum of a craft turned by wheels, and the model without.

Each leaves an eigenvalue at rest that no loop moves. It is no failure of a loop: the motion stays where w'x has the
value that it began with, and what a loop does there is that of the model restricted to w'x = 0. See `rest_spaces`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pliant.plants.core.signals import Signal

from .lti import LinearModel
from .rest_spaces import Array, Conserved, conserved_by, unfelt


def conserved(model: LinearModel) -> Conserved:
    """The conserved quantities of a model, by the left null space of [A, B] ([A - 1, B] where it is sampled)."""
    return conserved_by(model.A, model.B, model.dt, model.state_names)


def free(model: LinearModel, felt: Array) -> tuple[str, ...]:
    """In words what inputs change and neither the model nor `felt` (m, nx) feels."""
    return unfelt(model.A, model.B, felt, model.dt, model.state_names).names


def moved(model: LinearModel, felt: Array | None = None) -> LinearModel:
    """What inputs can move: the model itself, or where it conserves something its restriction to w'x = 0.

    felt (m, nx): all that a loop makes of the states; then what neither it nor the model feels is left out too. The
    states of the answer are combinations of the model's, which are outputs of it, by their names: without what is left
    out.
    """
    nx = len(model.A)
    loose = None if felt is None else unfelt(model.A, model.B, felt, model.dt, model.state_names)
    if loose is not None and loose.directions.shape[1]:
        up, down = loose.up, loose.down
    else:
        up = down = np.eye(nx)
    found = conserved_by(down @ model.A @ up, down @ model.B, model.dt, ("",) * len(down))
    up, down = up @ found.up, found.down @ down
    if len(down) == nx:
        return model
    own = [i for i, s in enumerate(model.outputs) if s.name not in model.state_names]
    return replace(
        model,
        A=down @ model.A @ up,
        B=down @ model.B,
        E=down @ model.E,
        C=np.vstack([up, model.C[own] @ up]),
        D=np.vstack([np.zeros((nx, model.B.shape[1])), model.D[own]]),
        F=np.vstack([np.zeros((nx, model.E.shape[1])), model.F[own]]),
        states=tuple(Signal(f"free{k + 1}", "1") for k in range(up.shape[1])),
        outputs=(*model.states, *(model.outputs[i] for i in own)),
        x0=down @ model.x0,
        y0=np.concatenate([model.x0, model.y0[own]]),
        f0=down @ model.f0,
    )
