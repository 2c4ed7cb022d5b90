"""Jacobians of equations of motion M a = r as they stand, at any accelerations a, not only those that solve them.

With a held, dM a + M da = dr gives da = M^-1 (dr - dM a); the plant gives da, its rate dx/dt as a function of a, and
the accelerations that solve the equations. At those the Jacobians are the plant's own, with fewer operations than the
derivative of M^-1 r takes.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple, cast

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.native.batch_kernels import NativeFunction, random_points


class Differentiated(NamedTuple):
    """The equations M a = r of a plant with m accelerations, differentiated at accelerations `a` held."""

    a: ca.SX  # (m,) symbols
    rate: ca.SX  # (nx,) dx/dt at a
    change: ca.SX  # (m, nx + nu + nw) da by (x, u, w)
    solved: ca.SX  # (m,) the accelerations that solve the equations


class ResidualJacobians:
    """[A, B, E, C, D, F] at the accelerations that solve the equations and at others."""

    def __init__(self, plant: PlantLike, output: Callable[[], ca.SX], equations: Differentiated) -> None:
        _, x, u, w, _ = plant.symbols
        self._z = ca.vertcat(x, u, w)
        self.plant, self.accelerations, self._output = plant, equations.solved, output
        self._symbols = [*plant.symbols, equations.a]
        rate = ca.jacobian(equations.rate, self._z)
        self._rates = self._parted(rate + ca.jacobian(equations.rate, equations.a) @ equations.change)
        self._moved = ca.Function("moved", self._symbols, self._rates)

    def _parted(self, J: ca.SX) -> list[ca.SX]:
        plant = self.plant
        ends = [0, plant.nx, plant.nx + plant.nu, plant.nx + plant.nu + plant.nw]
        return [J[:, s:e] for s, e in pairwise(ends)]

    @cached_property
    def blocks(self) -> ca.Function:
        """[A, B, E, C, D, F] at accelerations."""
        outputs = self._parted(ca.jacobian(self._output(), self._z))
        return ca.Function("blocks", self._symbols, [*self._rates, *outputs])

    def slopes(self) -> ca.SX:
        """[A, B] (nx, nx + nu) at the plant's own accelerations, sparse."""
        return cast(ca.SX, ca.horzcat(*self._moved(*self.plant.symbols, self.accelerations)[:2]))

    @cached_property
    def states(self) -> NumericFunction:
        """(t, x, u, w, p) -> [A, B] at the plant's own accelerations: without outputs, at a fraction of the cost."""
        symbols = list(self.plant.symbols)
        return function("states", symbols, list(self._moved(*symbols, self.accelerations))[:2], matrices=True)

    @cached_property
    def states_along(self) -> NumericFunction:
        """(t, x, u, w, p, a) -> [A] at accelerations a (m,)."""
        return function("states_along", self._symbols, self._rates[:1], matrices=True)

    @cached_property
    def solved(self) -> NumericFunction:
        """(t, x, u, w, p) at the plant's own accelerations."""
        symbols = list(self.plant.symbols)
        return function("jacobians", symbols, list(self.blocks(*symbols, self.accelerations)), matrices=True)

    @cached_property
    def along(self) -> NumericFunction:
        """(t, x, u, w, p, a) at accelerations a (m,); native where the plant's own Jacobians are."""
        a = ca.SX.sym("a", self.accelerations.shape[0])
        symbols = [*self.plant.symbols, a]
        found = function("along", symbols, list(self.blocks(*symbols)), matrices=True)
        if not isinstance(self.plant.__dict__.get("_jacobians"), NativeFunction):
            return found
        rng = np.random.default_rng(0)
        points = random_points(self.plant, rng)
        moving = rng.uniform(-1.0, 1.0, (a.shape[0], points[0].shape[1]))
        return NativeFunction(found.function, [*points, moving], matrices=True)
