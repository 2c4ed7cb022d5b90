"""Jacobians of equations of motion M a = r as they stand, at any accelerations a, not only those that solve them."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.native.batch_kernels import NativeFunction, random_points

if TYPE_CHECKING:
    from .lagrangian import LagrangianPlant


def along(plant: LagrangianPlant) -> NumericFunction:
    """[A, B, E, C, D, F] as a function of (t, x, u, w, p, a), a (n,) the accelerations; driven ones are the inputs.

    Rows of the rates: M^-1 (dr - d(M a)). Native where the plant's own Jacobians are.
    """
    from .lagrangian import ldl, ldl_solve

    t, x, u, w, p = plant.symbols
    M, r, _, _ = plant._terms
    n, nx = len(plant.coordinates), plant.nx
    a, z = ca.SX.sym("a", n), ca.vertcat(x, u, w)
    moving, change = ca.SX(a), ca.SX(n, z.shape[0])
    for i, k in plant.driven.items():
        moving[i], change[i, nx + k] = u[k], 1
    free = [i for i in range(n) if i not in plant.driven]
    if free:
        lacking = (r - M @ moving)[free]
        change[free, :] = ldl_solve(*ldl(M[free, free]), ca.jacobian(lacking, z))
    rate = ca.vertcat(ca.jacobian(x[n:], z), change)
    y = ca.jacobian(plant.expressions[1], z)
    ends = [0, nx, nx + plant.nu, nx + plant.nu + plant.nw]
    blocks = [J[:, s:e] for J in (rate, y) for s, e in pairwise(ends)]
    found = function("along", [t, x, u, w, p, a], blocks, matrices=True)
    if not isinstance(plant.__dict__.get("_jacobians"), NativeFunction):
        return found
    rng = np.random.default_rng(0)
    points = random_points(plant, rng)
    return NativeFunction(found.function, [*points, rng.uniform(-1.0, 1.0, (n, points[0].shape[1]))], matrices=True)
