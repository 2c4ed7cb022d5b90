"""Jacobians of equations of motion M a = r as they stand, at any accelerations a, not only those that solve them.

With a held, dM a + M da = dr gives da = M^-1 (dr - dM a); the plant gives da, its rate dx/dt as a function of a, and
the accelerations that solve the equations. At those the Jacobians are the plant's own, with fewer operations than the
derivative of M^-1 r takes.
"""

from __future__ import annotations

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

    def __init__(self, plant: PlantLike, output: ca.SX, equations: Differentiated) -> None:
        _, x, u, w, _ = plant.symbols
        z = ca.vertcat(x, u, w)
        self.plant, self.accelerations = plant, equations.solved
        rate = ca.jacobian(equations.rate, z) + ca.jacobian(equations.rate, equations.a) @ equations.change
        ends = [0, plant.nx, plant.nx + plant.nu, plant.nx + plant.nu + plant.nw]
        blocks = [J[:, s:e] for J in (rate, ca.jacobian(output, z)) for s, e in pairwise(ends)]
        self.blocks = ca.Function("blocks", [*plant.symbols, equations.a], blocks)

    def slopes(self) -> ca.SX:
        """[A, B] (nx, nx + nu) at the plant's own accelerations, sparse."""
        return cast(ca.SX, ca.horzcat(*self.blocks(*self.plant.symbols, self.accelerations)[:2]))

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
