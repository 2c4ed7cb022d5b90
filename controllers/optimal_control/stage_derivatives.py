"""An expression in a plant's symbols with its first and second derivatives along (x, u), for lanes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import function

if TYPE_CHECKING:
    from pliant.controllers.base.objective import Objective

Array = np.ndarray


class StageTerms:
    """An expression e (ne,) in the plant's symbols with its derivatives, for lanes."""

    def __init__(self, objective: Objective, expression: ca.SX) -> None:
        plant = objective.plant
        self._expression, self._symbols = ca.densify(expression), list(plant.symbols)
        self._z, self.ne = ca.vertcat(plant.symbols[1], plant.symbols[2]), expression.numel()
        self._nz = plant.nx + plant.nu
        if self.ne:
            slope = ca.reshape(ca.densify(ca.jacobian(self._expression, self._z)), self.ne * self._nz, 1)
            self._values = function("terms", self._symbols, [self._expression, slope])
            m = ca.SX.sym("m", self.ne)
            H = ca.hessian(ca.dot(m, self._expression), self._z)[0]
            self._curvature = function("curvature", [*self._symbols, m], [ca.vec(H)]) if H.nnz() else None

    def values(self, t: Array, x: Array, u: Array, w: Array, p: Array) -> list[Array]:
        """e (B, ne) and de/d(x, u) (B, ne, nz)."""
        B = len(x)
        if not self.ne:
            return [np.zeros((B, 0)), np.zeros((B, 0, self._nz))]
        e, slope = self._values(t[:, None], x, u, w, p, batch=B)
        return [e, slope.reshape(B, self._nz, self.ne).transpose(0, 2, 1)]

    def curvature(self, t: Array, x: Array, u: Array, w: Array, p: Array, m: Array) -> Array:
        """d2(m'e)/d(x, u)^2 (B, nz, nz)."""
        B = len(x)
        if not self.ne or self._curvature is None:
            return np.zeros((B, self._nz, self._nz))
        return self._curvature(t[:, None], x, u, w, p, m, batch=B)[0].reshape(B, self._nz, self._nz)
