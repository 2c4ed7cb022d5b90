"""Rests of plants with quaternions: the forces on the speeds, and that the quaternions keep their length."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.dynamics.equilibrium import RestConditions

Array = np.ndarray


class TurnedForces(RestConditions):
    """dq/dt, M dv/dt = r and |quaternion|^2 - 1."""

    def still(self) -> Array:
        """Speeds."""
        return np.arange(self.plant.nx) >= len(self.plant.coordinates)

    def _lengths(self, x: Array) -> tuple[Array, Array]:
        """(|quaternion|^2 - 1, its slopes in x)."""
        held = self.plant.attitudes
        found, slopes = np.zeros(len(held)), np.zeros((len(held), len(x)))
        for k, a in enumerate(held):
            found[k], slopes[k, a.quaternion] = x[a.quaternion] @ x[a.quaternion] - 1, 2 * x[a.quaternion]
        return found, slopes

    def forces(self, x: Array, u: Array, at: Array) -> Array:
        n = len(self.plant.coordinates)
        rate = super().forces(x, u, at)
        moved = self.plant.mass_matrix(at, p=self.p) @ rate[n:]
        return np.concatenate([rate[:n], moved, self._lengths(x)[0]])

    def slopes(self, x: Array, u: Array) -> Array:
        n, own = len(self.plant.coordinates), super().slopes(x, u)
        lengths = np.hstack([self._lengths(x)[1], np.zeros((len(self.plant.attitudes), len(u)))])
        return np.vstack([own[:n], self.plant.mass_matrix(x, p=self.p) @ own[n:], lengths])


def stiffness(plant: Any) -> NumericFunction:
    """(t, x, u, w, p) -> K (nv, nv): -dr by small turns and by the other coordinates."""
    t, x, u, w, p = plant.symbols
    n = len(plant.coordinates)
    along = ca.jacobian(plant.coordinate_rates(x), x[n:])
    return function("stiffness", [t, x, u, w, p], [ca.jacobian(-plant._terms[1], x[:n]) @ along], matrices=True)
