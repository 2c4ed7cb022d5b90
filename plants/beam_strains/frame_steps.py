"""From section to section in space: the turn that curvature makes over a step, and how it changes with the curvature.

F' = F k~ and F(xi + h) = F exp(Omega), Omega by Magnus' series of sixth order from the curvatures k_1, k_2, k_3 at the
three Gauss nodes of the step. It is that of the transpose, whose equation stands the usual way round:

    a = -h k_2, b = -sqrt(15)/3 h (k_3 - k_1), c = -10/3 h (k_3 - 2 k_2 + k_1), d = a x b,
    -Omega = a + c/12 + (d - 20 a - c) x (b - a x (2 c + d)/60)/240

Source   S. Blanes, F. Casas and J. Ros, "Improved high order integrators based on the Magnus expansion", BIT 40 (2000),
         434-450, the scheme of order 6 at Gauss nodes
"""

from __future__ import annotations

import math
from functools import lru_cache

import casadi as ca
import numpy as np

from pliant.plants.core.quaternions import cross
from pliant.plants.exact_rotations.quadrature import Array

TERMS = 9  # of sine and cosine: complete to rounding for half a turn a step
NODES = np.array([0.5 - math.sqrt(15) / 10, 0.5, 0.5 + math.sqrt(15) / 10])
COMBINED = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, -1.0], [-1.0, 2.0, -1.0]])  # a, b, c of the curvatures
COMBINED *= np.array([[1.0], [math.sqrt(15) / 3], [10 / 3]])


def combined(k: Array, h: float) -> Array:
    """(a, b, c), or rows of it, (9, n) from the curvatures' rows (3 nodes, 3 axes, n)."""
    return h * np.einsum("ij,jkn->ikn", COMBINED, k).reshape(9, -1)


def rotation_vector(y: ca.SX) -> ca.SX:
    """Omega (3,) of y = (a, b, c)."""
    a, b, c = y[:3], y[3:6], y[6:]
    d = ca.cross(a, b)
    return -(a + c / 12 + ca.cross(d - 20 * a - c, b - ca.cross(a, 2 * c + d) / 60) / 240)


def exponential(omega: ca.SX) -> ca.SX:
    """The quaternion (4,) of a rotation vector."""
    square = ca.sumsqr(omega) / 4
    return ca.vertcat(_series(square, 0), _series(square, 1) / 2 * omega)


def _series(z: ca.SX, first: int) -> ca.SX:
    """sum_k (-z)^k/(2 k + first)!."""
    total = ca.SX(0)
    for k in reversed(range(TERMS)):
        total = 1 / math.factorial(2 * k + first) - z * total
    return total


def left_rates(p: ca.SX) -> ca.SX:
    """(3, 4) with angular velocity in reference axes = 2 (3, 4) dp/dt of a unit quaternion."""
    return ca.horzcat(-p[1:], p[0] * ca.SX.eye(3) + cross(p[1:]))


@lru_cache(maxsize=1)
def step() -> ca.Function:
    """y (9,) -> quaternion (4,) of a step, and T (3, 9): the end spins at T y' against the start, start's axes."""
    y = ca.SX.sym("y", 9)
    omega = ca.SX.sym("omega", 3)
    e = exponential(omega)
    turned = ca.Function("turned", [omega], ca.cse([e, 2 * left_rates(e) @ ca.jacobian(e, omega)]))
    found = rotation_vector(y)
    e, T = turned(found)
    return ca.Function("step", [y], ca.cse([e, T @ ca.jacobian(found, y)]))
