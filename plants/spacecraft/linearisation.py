"""Where a spacecraft's equations are linearised: at the accelerations of a nominal; its frequencies at rest."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from pliant.plants.core import parameters
from pliant.plants.core.argument_gates import require_finite
from pliant.plants.core.imports import linalg
from pliant.plants.core.quaternions import matrix_of
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.arguments import one_state

from .declaration import SpacecraftDeclaration

Array = np.ndarray


def _orbit_rate(craft: SpacecraftDeclaration, p: Any) -> Array:
    """[rad/s], (nt,) where it is a parameter that varies."""
    path = "environment.orbit.rate"
    if path not in craft.varied:
        return np.asarray(parameters.get(craft, path), dtype=float)
    values = craft.nominal_parameters if p is None else np.asarray(p, dtype=float)
    return values[..., craft.varied.index(path)]


def nominal_accelerations(craft: SpacecraftDeclaration, nominal: Trajectory, p: Any) -> Array:
    """The unknowns a (nt, 6 + n) with which a nominal moves. Without translation the hub's is what balances the
    forces.
    """
    at, x, dx = craft.layout, nominal.x, nominal.derivative()
    R, orbit = matrix_of(x[:, at.quaternion]), craft.environment.orbit
    if craft.translation:
        pushed = dx[:, at.velocity]
        if orbit is not None:
            turning = _orbit_rate(craft, p)[..., None] * [0.0, -1.0, 0.0]
            pushed = pushed + 2 * np.cross(turning, x[:, at.velocity])
            pushed += np.cross(turning, np.cross(turning, x[:, at.position]))
        hub = np.einsum("tji,tj->ti", R, pushed)
    else:
        hub = np.zeros((len(x), 3))
    n = len(craft.coordinates)
    a = np.concatenate([hub, dx[:, at.omega], dx[:, at.rates : at.rates + n]], axis=1)
    if not craft.translation:
        r = craft.residual(x, a, nominal.u, w=nominal.w, p=p, t=nominal.t)
        M = craft.mass_matrix(x, p=p)
        a[:, :3] = -np.linalg.solve(M[:, :3, :3], r[:, :3, None])[..., 0]
    return a


def natural_frequencies(craft: SpacecraftDeclaration, x0: Any, p: Any) -> Array:
    """Undamped, from the stiffness and mass of the free spacecraft at rest at x0 (nx,)."""
    x = np.array(one_state(craft, x0))
    x[craft.layout.velocity] = 0.0
    x[craft.layout.omega.start :] = 0.0
    values = require_finite("natural_frequencies.p", craft.nominal_parameters if p is None else p, (len(craft.varied),))
    bodies = dataclasses.replace(craft, varied=())
    for path, value in zip(craft.varied, values):
        if path.partition(".")[0] == "appendages":  # the hub's part is in the mass matrix
            bodies = parameters.put(bodies, path, float(value))
    at = craft.layout
    n, first = 6 + len(craft.coordinates), at.quaternion.stop - 6
    K, free = np.zeros((n, n)), np.ones(n, dtype=bool)
    for body, hinge, modes in zip(bodies.appendages, at.hinges, at.modes):
        turns = np.arange(hinge.start, hinge.stop) - first
        K[turns, turns] = body.hinge.stiffness
        free[turns] = body.hinge.drive != "motion"
        count, bent = modes.stop - modes.start, slice(modes.start - first, modes.stop - first)
        K[bent, bent] = body.stiffness_factor * body.data.stiffness[:count, :count]
    both = np.ix_(free, free)
    M = craft.mass_matrix(x, p=p)[both]
    try:
        squares = linalg.eigh(K[both], M, eigvals_only=True)
    except np.linalg.LinAlgError:
        craft.dynamics(x, p=p)  # says which motion has no inertia
        raise
    found = np.sqrt(np.maximum(squares, 0.0))
    return found[found > 1e-6 * found.max(initial=0.0)]
