"""The curvature that a beam has at rest, about z: a number [1/m] or a function of xi in [0, 1]."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import require_finite, require_function, shown
from pliant.plants.core.parameters import is_symbolic, number_or_symbol
from pliant.plants.exact_rotations.quadrature import Array, points

POINTS = 64  # by which a function is integrated: exact for polynomials of degree 63
RESOLVED = 1e-6
TRIED = np.array([0.0, 0.3, 1.0])


def rest_curvature(name: str, value: Any) -> Any:
    """The gate of the field: a number, a symbol, or a function of xi (k,) that returns (k,) finite numbers."""
    if not callable(value) or is_symbolic(value):
        return number_or_symbol(name, value, "finite", "1/m")
    require_function(name, value)
    try:
        found = value(TRIED.copy())
        require_finite(f"{name}(xi)", np.asarray(found, dtype=float), TRIED.shape)
    except Exception as error:
        raise ValueError(
            f"{name} = {shown(value)} must be a number or a function of xi (k,) within [0, 1] that returns (k,) [1/m]: "
            f"{error}"
        ) from error
    return value


def is_curved(value: Any) -> bool:
    """Whether a beam of this curvature at rest is anything but straight."""
    return callable(value) or is_symbolic(value) or value != 0.0


@dataclass(frozen=True, eq=False)
class RestShape:
    """A beam of `length` [m] at rest, its root along x: angle of its sections and its curvature."""

    curvature: float | ca.SX | Callable[[Array], Array]  # [1/m]
    length: Any  # [m]

    def angle(self, xi: Array) -> ca.SX:
        """Of the sections at xi (k,) against the root, (k,) [rad]."""
        if callable(self.curvature) and not is_symbolic(self.curvature):
            at = points(POINTS)
            return self.length * ca.SX(ca.DM(at.cumulative(xi) @ self._values(at.xi)))
        return self.length * self.curvature * ca.SX(ca.DM(xi))

    def bent(self, xi: Array) -> ca.SX:
        """d angle/d xi at xi (k,), (k,) [rad]."""
        if callable(self.curvature) and not is_symbolic(self.curvature):
            return self.length * ca.SX(ca.DM(self._values(xi)))
        return self.length * self.curvature * ca.SX.ones(len(xi))

    def enough(self, first: int, panels: int = 1) -> int:
        """The fewest points of a panel, from `first` on, that place the beam at rest to RESOLVED of its length."""
        if not is_curved(self.curvature):
            return min(first, POINTS)
        xi = np.linspace(0.0, 1.0, 17)
        exact = self._places(POINTS, 1, xi)
        for m in range(min(first, POINTS), POINTS):
            if np.abs(self._places(m, panels, xi) - exact).max() <= RESOLVED:
                return m
        return POINTS

    def _places(self, m: int, panels: int, xi: Array) -> Array:
        """At xi (k,) by m points on each of the panels, (k, 2), over the length."""
        at = points(m, panels)
        angle = np.asarray(ca.DM(self.angle(at.xi))).ravel()
        return at.cumulative(xi) @ np.column_stack([np.cos(angle), np.sin(angle)])

    def _values(self, xi: Array) -> Array:
        own: Any = self.curvature
        return np.asarray(own(np.asarray(xi, dtype=float)), dtype=float)
