"""Two plants of a user that answer none of a plant's questions themselves, and a scene of each.

The crane's numbers are of a load on a massless rope under a trolley: (M + m) x'' + m L lean'' = pull at lean = 0.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import (
    LagrangianPlant,
    Plant,
)
from pliant.plants.core.parameters import quantity
from pliant.plants.core.signals import Signal

TROLLEY, LOAD, ROPE, g = 4.0, 1.0, 2.0, 9.81


@dataclass(frozen=True, kw_only=True)
class Crane(LagrangianPlant):
    """A trolley on a rail and a load on a rope: the coordinate that is driven comes last."""

    trolley: float = quantity("kg", "positive", TROLLEY)
    load: float = quantity("kg", "positive", LOAD, uncertain=True)

    coordinates = (Signal("lean", "rad"), Signal("place", "m"))
    states = (Signal("lean", "rad"), Signal("place", "m"), Signal("sway", "rad/s"), Signal("going", "m/s"))
    inputs = (Signal("pull", "N"),)
    disturbances = ()
    outputs = (Signal("hook", "m"), Signal("leaning", "rad"))
    label = "crane"

    def kinetic_energy(self, q, v):
        x = v[1] + ROPE * ca.cos(q[0]) * v[0]
        y = ROPE * ca.sin(q[0]) * v[0]
        return self.trolley * v[1] ** 2 / 2 + self.load * (x**2 + y**2) / 2

    def potential_energy(self, q):
        return -self.load * g * ROPE * (ca.cos(q[0]) - 1)

    def dissipation(self, q, v):
        return v[0] ** 2 / 10

    def generalized_force(self, t, q, v, u, w):
        return ca.vertcat(0, u[0])

    def output(self, t, x, u, w):
        return ca.vertcat(x[1] + ROPE * ca.sin(x[0]), x[0])

    def outline(self, x, points=30):
        hook = np.array([x[1] + ROPE * np.sin(x[0]), -ROPE * np.cos(x[0])])
        return np.linspace([x[1], 0.0], hook, points)[None]

    def ladder(self):
        return (self,)


@dataclass(frozen=True, kw_only=True)
class Tables(Plant):
    """Two turntables coupled by their masses, M = [[2, 0.5], [0.5, 1]]: a rate before the angles, inputs swapped."""

    stiffness: float = quantity("N m/rad", "nonnegative", 0.0)

    states = (Signal("zeta", "rad/s"), Signal("alpha", "rad"), Signal("beta", "rad"), Signal("omega", "rad/s"))
    inputs = (Signal("second", "N m"), Signal("first", "N m"))
    disturbances = ()
    outputs = (Signal("gap", "rad"), Signal("turned", "rad"))
    label = "tables"

    def ode(self, t, x, u, w):
        load = ca.vertcat(u[1] - self.stiffness * x[1], u[0] - self.stiffness * x[2])
        a = ca.DM([[1.0, -0.5], [-0.5, 2.0]]) @ load / 1.75
        return ca.vertcat(a[1], x[3], x[0], a[0])

    def output(self, t, x, u, w):
        return ca.vertcat(x[2] - x[1], x[1])

    def ladder(self):
        return (self,)


COMMON = {"about": "made in a test", "dt": 0.02, "substeps": 4, "duration": 2.0, "move_time": 1.0}
LIFT = Scene(
    name="crane",
    plant=Crane(),
    start=(("place", 0.0),),
    goal=(("place", 1.0),),
    limits=(100.0,),
    weights=(("place", 10.0), ("going", 1.0)),
    effort=(("pull", 1e-3),),
    observe=("place", "going", "leaning"),
    compare=("hook",),
    **COMMON,
)
TURN = Scene(
    name="tables",
    plant=Tables(stiffness=1.0),
    start=(("alpha", 0.0), ("beta", 0.0)),
    goal=(("alpha", 0.5), ("beta", -1.0)),
    limits=(40.0, 50.0),
    weights=(("alpha", 10.0), ("beta", 10.0)),
    effort=(("first", 1e-3), ("second", 1e-3)),
    observe=("alpha", "beta", "zeta", "omega"),
    compare=("gap",),
    **COMMON,
)
