"""A plant whose rates depend on the time itself, for what marches or differentiates steps."""

import casadi as ca

from pliant.plants import Plant, Signal


class Shaken(Plant):
    """A pendulum whose pivot shakes: its equation knows the time."""

    states = (Signal("angle", "rad"), Signal("angle_rate", "rad/s"))
    inputs = (Signal("torque", "N m"),)
    disturbances = outputs = ()
    label = "shaken pendulum"

    def ode(self, t, x, u, w):
        return ca.vertcat(x[1], -(9.81 + 30 * ca.cos(8 * t)) * ca.sin(x[0]) + u * t)

    def output(self, t, x, u, w):
        return ca.SX(0, 1)

    def ladder(self):
        return (self,)
