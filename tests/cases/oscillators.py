"""An oscillator and a plant of one state, whose motions are known in closed form."""

from dataclasses import dataclass

import casadi as ca

from pliant.plants import Plant, Signal


@dataclass(frozen=True, kw_only=True)
class Oscillator(Plant):
    """x'' + 2 zeta omega x' + omega^2 x = u + w; the output is x + u."""

    omega: float = 10.0
    zeta: float = 0.0

    states = (Signal("x", "m"), Signal("x_rate", "m/s"))
    inputs = (Signal("u", "m/s^2"),)
    disturbances = (Signal("w", "m/s^2"),)
    outputs = (Signal("sum", ""),)
    label = "oscillator"

    def ode(self, t, x, u, w):
        return ca.vertcat(x[1], u + w - self.omega**2 * x[0] - 2 * self.zeta * self.omega * x[1])

    def output(self, t, x, u, w):
        return x[0] + u

    def ladder(self):
        return (self,)


@dataclass(frozen=True, kw_only=True)
class Scalar(Plant):
    """One state: x' = rate x, or a logarithm that ends at x = 1."""

    rate: float = -1.0
    ends: bool = False

    states = (Signal("x", ""),)
    inputs = ()
    disturbances = ()
    outputs = (Signal("y", ""),)
    label = "scalar"

    def ode(self, t, x, u, w):
        return 2 + ca.sqrt(1 - x) if self.ends else self.rate * x + ca.sin(t)

    def output(self, t, x, u, w):
        return x

    def ladder(self):
        return (self,)
