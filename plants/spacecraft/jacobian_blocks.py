"""Jacobians of the spacecraft's equations, block by block.

The linearisation is of the residual r(x, u, a) = M a + bias - loads at the accelerations a that solve r = 0: da/dx =
-M^-1 dr/dx, with the same elimination as the equations themselves.
"""

from __future__ import annotations

import casadi as ca

from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.dynamics.residual_jacobians import Differentiated

from .block_arrow import accelerations, eliminate, solve
from .declaration import SpacecraftDeclaration
from .equations import rate_of, shares
from .layout import Layout


def differentiated(craft: SpacecraftDeclaration) -> Differentiated:
    """The equations of all bodies at accelerations held: only the blocks that each can depend on."""
    t, x, u, w, _ = craft.symbols
    own = craft.symbolic
    parts = shares(own, t, x, u, w)
    solved, _ = accelerations(parts)
    a = ca.SX.sym("a", solved.shape[0])
    z = ca.vertcat(x, u, w)
    columns = []
    for k, share in enumerate(parts):
        mine = ca.vertcat(a[:6], a[share.own])
        columns.append(_sparse_jacobian(share.M @ mine + share.r, z, craft.layout, k - 1, craft.nx, craft.nu))
        if share.given is not None:  # a driven acceleration is its input
            n = share.given.shape[0]
            first = craft.nx + craft.layout.hinge_inputs[k - 1].start
            columns[-1][:, first : first + n] += share.M[:, 6 : 6 + n]
    da = solve(parts, eliminate(parts), columns)
    for k, share in enumerate(parts[1:]):
        if share.given is not None:
            for j in range(share.given.shape[0]):
                da[share.own[j], craft.nx + craft.layout.hinge_inputs[k].start + j] = 1
    return Differentiated(a, rate_of(own, x, u, a), da, solved)


def _sparse_jacobian(r: ca.SX, z: ca.SX, at: Layout, i: int, nx: int, nu: int) -> ca.SX:
    """dr/dz of one body's residual, differentiated by the columns that it can depend on."""
    places = [at.position, at.quaternion, at.velocity, at.omega, at.wheels]
    shifts = [0] * len(places)
    if i >= 0:
        places += [at.hinges[i], at.modes[i], at.hinge_rates[i], at.mode_rates[i], at.hinge_inputs[i]]
        shifts += [0, 0, 0, 0, nx]
    else:
        places += [at.hub_inputs, slice(0, 6)]
        shifts += [nx, nx + nu]
    at_columns = [k + shift for s, shift in zip(places, shifts) for k in range(s.start, s.stop)]
    J = ca.SX(r.shape[0], z.shape[0])
    J[:, at_columns] = ca.jacobian(r, z[at_columns])
    return J


def residual_function(craft: SpacecraftDeclaration) -> NumericFunction:
    """(t, x, u, w, p, a) -> (M a + r (6 + n,), M (6 + n, 6 + n)); driven hinges count as free."""
    t, x, u, w, p = craft.symbols
    parts = shares(craft.symbolic, t, x, u, w)
    count = 6 + sum(len(s.own) for s in parts[1:])
    a, M, r = ca.SX.sym("a", count), ca.SX(count, count), ca.SX.zeros(count)
    for share in parts:
        rows = [*range(6), *share.own]
        M[rows, rows] += share.M
        r[rows] += share.r
    return function("residual", [t, x, u, w, p, a], [M @ a + r, M])
