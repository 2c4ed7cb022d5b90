"""A load on a rope that is wound up: of no length it has no equations, so that zero is no state of it."""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from pliant.plants import LagrangianPlant, Signal
from pliant.plants.core.parameters import quantity


@dataclass(frozen=True, kw_only=True)
class Hoist(LagrangianPlant):
    """T = m (v_rope^2 + (rope v_sway)^2) / 2, in polar coordinates; it pulls at the rope and twists the load's arm."""

    at_home: bool = True
    mass: float = quantity("kg", "positive", 1.0)
    coordinates = property(lambda self: (Signal("rope", "m"), Signal("sway", "rad")))
    inputs = property(lambda self: (Signal("pull", "N"), Signal("wind", "N m")))
    disturbances = property(lambda self: ())
    outputs = property(lambda self: (Signal("load_x", "m"), Signal("load_y", "m")))
    label = property(lambda self: "hoist")

    @property
    def rest_state(self):
        return np.array([4.0, 0.0, 0.0, 0.0]) if self.at_home else super().rest_state

    def kinetic_energy(self, q, v):
        return 0.5 * self.mass * (v[0] ** 2 + (q[0] * v[1]) ** 2)

    def potential_energy(self, q):
        return -9.81 * self.mass * q[0] * ca.cos(q[1])

    def dissipation(self, q, v):
        return 0.1 * ca.sumsqr(v)

    def generalized_force(self, t, q, v, u, w):
        return u

    def output(self, t, x, u, w):
        return ca.vertcat(x[0] * ca.sin(x[1]), -x[0] * ca.cos(x[1]))
