"""Plants for python-control: a NonlinearIOSystem whose linearisation stays exact."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import control

    from .plant import Plant


@cache
def system_class() -> type[control.NonlinearIOSystem]:
    """The class of a plant's system: made when first asked for, as python-control takes a second to import."""
    import control

    class PlantIOSystem(control.NonlinearIOSystem):
        """A plant as a NonlinearIOSystem; `linearize` uses automatic differentiation, not differences."""

        def __init__(self, plant: Plant) -> None:
            super().__init__(
                lambda t, x, u, params: plant.dynamics(x, u, t=t),
                lambda t, x, u, params: plant.measure(x, u, t=t),
                states=[s.name for s in plant.states],
                inputs=[s.name for s in plant.inputs],
                outputs=[s.name for s in plant.outputs],
                name=type(plant).__name__,
            )
            self.plant = plant

        def linearize(self, x0: Any = None, u0: Any = None, t: float = 0, **kwargs: Any) -> control.StateSpace:
            """The exact linear model about (x0, u0), which may be an OperatingPoint; as python-control's own method."""
            if isinstance(x0, control.OperatingPoint):
                x0, u0 = x0.states, x0.inputs if u0 is None else u0
            x = np.broadcast_to(np.asarray(0.0 if x0 is None else x0, dtype=float), self.plant.nx)
            u = np.broadcast_to(np.asarray(0.0 if u0 is None else u0, dtype=float), self.plant.nu)
            return self.plant.linearize(x, u, t=t).to_control()

    return PlantIOSystem


def to_control(plant: Plant) -> control.NonlinearIOSystem:
    """The plant as a control.NonlinearIOSystem."""
    return system_class()(plant)
