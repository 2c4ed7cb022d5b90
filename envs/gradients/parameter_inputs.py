"""A plant whose randomised parameters are inputs: the step's derivatives with respect to inputs are then theirs too.

Parameter i enters as p_i = p_i,0 + s_i c_i, with s_i = SHARE |p_i,0|, so that an input c_i of one is a moderate change.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.core.plant_protocol import PlantLike

SHARE = 0.1  # of a parameter, that its input of one changes it by
SMALLEST = 1e-3  # of a parameter that is zero


class ParameterInputs:
    """`plant` with inputs [u; c] (nu + np,) and no parameters; equal where the plants are."""

    def __init__(self, plant: PlantLike) -> None:
        self.plant = plant
        self.scale = np.where(plant.nominal_parameters == 0, SMALLEST, SHARE * np.abs(plant.nominal_parameters))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "plant":
            raise AttributeError(name)
        return getattr(self.plant, name)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ParameterInputs) and self.plant == other.plant

    def __hash__(self) -> int:
        return hash((ParameterInputs, self.plant))

    @property
    def nu(self) -> int:
        return self.plant.nu + len(self.plant.varied)

    @property
    def varied(self) -> tuple[str, ...]:
        return ()

    @property
    def nominal_parameters(self) -> np.ndarray:
        return np.zeros(0)

    @cached_property
    def symbols(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
        t, x, _, w, _ = self.plant.symbols
        return t, x, ca.SX.sym("v", self.nu), w, ca.SX(0, 1)

    def _of_inputs(self, *expressions: ca.SX) -> list[ca.SX]:
        """Expressions in the plant's u and p, in [u; c]."""
        _, _, u, _, p = self.plant.symbols
        v = self.symbols[2]
        own = self.plant.nominal_parameters + self.scale * v[self.plant.nu :]
        return ca.substitute(list(expressions), [u, p], [v[: self.plant.nu], own])

    @cached_property
    def expressions(self) -> tuple[ca.SX, ca.SX]:
        rate, output = self._of_inputs(*self.plant.expressions)
        return rate, output

    @cached_property
    def _dynamics(self) -> NumericFunction:
        return function("dynamics", list(self.symbols), [self.expressions[0]])

    def slopes(self) -> ca.SX:
        """[df/dx, df/du, df/dc] (nx, nx + nu + np), sparse."""
        plant: Any = self.plant
        by_parameters = ca.jacobian(plant.expressions[0], plant.symbols[4]) @ ca.diag(ca.SX(self.scale))
        (found,) = self._of_inputs(ca.horzcat(plant.slopes(), ca.sparsify(by_parameters)))
        return found
