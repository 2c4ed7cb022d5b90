"""One-state and two-state plants whose motions are known in closed form."""

from dataclasses import dataclass

import casadi as ca

from pliant.plants import Plant, Signal


@dataclass(frozen=True, kw_only=True)
class Vibration(Plant):
    """x'' = -omega^2 x + u + w: from (1, 0), free, x = cos(omega t). The output is x + u."""

    omega: float = 3.0

    states = (Signal("place", "m"), Signal("speed", "m/s"))
    inputs = (Signal("push", "m/s^2"),)
    disturbances = (Signal("wind", "m/s^2"),)
    outputs = (Signal("sum", ""),)
    label = "vibration"

    def ode(self, t, x, u, w):
        return ca.vertcat(x[1], u + w - self.omega**2 * x[0])

    def output(self, t, x, u, w):
        return x[0] + u

    def ladder(self):
        return (self,)


@dataclass(frozen=True, kw_only=True)
class Blowing(Plant):
    """x' = x^2 + u: from 1, x = 1 / (1 - t), which is infinite at t = 1."""

    states = (Signal("size", ""),)
    inputs = (Signal("feed", ""),)
    disturbances = ()
    outputs = (Signal("size", ""),)
    label = "blowing up"

    def ode(self, t, x, u, w):
        return x**2 + u

    def output(self, t, x, u, w):
        return x

    def ladder(self):
        return (self,)
