"""The signals of a linear model, of one point or along a motion: their names, and how many its matrices must fit; the
model at one point for python-control.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.core.argument_gates import require_flag, require_names, require_text
from pliant.plants.core.signals import OwnsArrays, Signal, as_signals, names, rows_by_name

if TYPE_CHECKING:
    import control

    from .lti import LinearModel

KINDS = ("states", "inputs", "disturbances", "outputs")


class ModelSignals(OwnsArrays):
    """Base of `LinearModel` and `LTVModel`, whose fields the four tuples are."""

    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    outputs: tuple[Signal, ...]

    def _matrix_shapes(self) -> dict[str, tuple[int, int]]:
        """Shapes of A, B, E, C, D, F at one point."""
        nx, nu, nw, ny = (len(getattr(self, kind)) for kind in KINDS)
        return {"A": (nx, nx), "B": (nx, nu), "E": (nx, nw), "C": (ny, nx), "D": (ny, nu), "F": (ny, nw)}

    def _check_signals(self) -> None:
        """ValueError unless the signals of each kind are named, each name once."""
        for kind in KINDS:
            signals = getattr(self, kind)
            object.__setattr__(self, kind, as_signals(f"{type(self).__name__}.{kind}", signals, len(signals), ""))

    @property
    def state_names(self) -> tuple[str, ...]:
        """Of dx (nx,), in order."""
        return names(self.states)

    @property
    def input_names(self) -> tuple[str, ...]:
        """Of du (nu,), in order."""
        return names(self.inputs)

    @property
    def disturbance_names(self) -> tuple[str, ...]:
        """Of dw (nw,), in order."""
        return names(self.disturbances)

    @property
    def output_names(self) -> tuple[str, ...]:
        """Of dy (ny,), in order."""
        return names(self.outputs)


def state_space(model: LinearModel, disturbances: bool, outputs: Any, name: str | None) -> control.StateSpace:
    """See `LinearModel.to_control`."""
    import control

    disturbances = require_flag("to_control.disturbances", disturbances)
    name = None if name is None else require_text("to_control.name", name)
    count = len(model.inputs) + (len(model.disturbances) if disturbances else 0)
    C, D, seen = model.C, np.hstack([model.D, model.F]), list(model.output_names)
    if outputs is not None:
        listed = (
            model.state_names
            if outputs == "states"
            else [outputs]
            if isinstance(outputs, str)
            else require_names("to_control.outputs", outputs)
        )
        rows, seen = rows_by_name(model, listed), list(listed)
        C, D = rows.C, np.hstack([rows.D, rows.F])
    return control.StateSpace(
        model.A,
        np.hstack([model.B, model.E])[:, :count],
        C,
        D[:, :count],
        0 if model.dt is None else model.dt,
        states=list(model.state_names),
        inputs=list(model.input_names + model.disturbance_names)[:count],
        outputs=seen,
        name=name,
    )
