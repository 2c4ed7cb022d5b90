"""A small linear plant for controllers, with its objective."""

import casadi as ca
import numpy as np
import pytest

from pliant.controllers import Objective
from pliant.plants import Plant, Signal


class Cart(Plant):
    """A cart with a spring-held, hardly damped mass: linear, with a free rigid-body mode."""

    A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [0, 4.0, 0, 0.02], [0, -8.0, 0, -0.04]])
    B = np.array([[0], [0], [1.0], [-1.0]])
    states = tuple(Signal(n, u) for n, u in (("s", "m"), ("q", "m"), ("s_rate", "m/s"), ("q_rate", "m/s")))
    inputs = (Signal("force", "N"),)
    disturbances = ()
    outputs = (Signal("mass", "m"),)
    label = "cart"

    def ode(self, t, x, u, w):
        return ca.DM(self.A) @ x + ca.DM(self.B) @ u

    def output(self, t, x, u, w):
        return x[0] + x[1]

    def ladder(self):
        return (self,)


@pytest.fixture
def cart():
    """Objectives of the cart: `cart(dt=0.05, limits=(-1, 1))`."""

    def made(**changes) -> Objective:
        given = {"weights": {"mass": 5.0, "s_rate": 0.3}, "effort": {"force": 0.1}, "dt": 0.1, **changes}
        return Objective(plant=Cart(), x_goal=np.zeros(4), u_goal=np.zeros(1), **given)

    return made
