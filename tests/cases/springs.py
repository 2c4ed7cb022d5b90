"""A mass on a spring and a damper, its motions known in closed form, its parameters named for identification."""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from pliant.plants import Experiment, Plant, Signal
from pliant.plants.core.parameters import quantity, validate


@dataclass(frozen=True, kw_only=True)
class Spring(Plant):
    """mass x'' + damping x' + stiffness x = force; measured: x and the mass's acceleration."""

    mass: float = quantity("kg", "positive", 2.0)
    damping: float = quantity("N s/m", "nonnegative", 0.8)
    stiffness: float = quantity("N/m", "positive", 50.0)

    states = (Signal("x", "m"), Signal("v", "m/s"))
    inputs = (Signal("force", "N"),)
    disturbances = ()
    outputs = (Signal("place", "m"), Signal("felt", "m/s^2"))
    label = "spring"

    def __post_init__(self):
        validate(self)

    def ode(self, t, x, u, w):
        return ca.vertcat(x[1], (u[0] - self.damping * x[1] - self.stiffness * x[0]) / self.mass)

    def output(self, t, x, u, w):
        return ca.vertcat(x[0], self.ode(t, x, u, w)[1])

    def ladder(self):
        return (self,)


@dataclass(frozen=True, kw_only=True)
class Runaway(Spring):
    """mass x'' = stiffness x^3 + force: gone to infinity in finite time."""

    def ode(self, t, x, u, w):
        return ca.vertcat(x[1], (u[0] + self.stiffness * x[0] ** 3) / self.mass)


SPRING = Spring()
GONE = Experiment(t=np.linspace(0.0, 20.0, 401), measured={"place": np.ones(401)}, start=(1.0, 0.0), name="gone")
VARIED = SPRING.vary("mass", "damping", "stiffness")
TRUE = {"mass": 2.0, "damping": 0.8, "stiffness": 50.0}
NOISE = {"place": 2e-4, "felt": 1e-2}


def pushed(seconds: float = 4.0, rate: float = 50.0, seed: int = 0, **options) -> Experiment:
    """The spring under a random square wave, played by dop853, read with noise."""
    t = np.arange(round(seconds * rate) + 1) / rate
    rng = np.random.default_rng([7, seed])
    force = np.cumprod(np.where(rng.uniform(size=len(t)) < 0.1, -1.0, 1.0))[:, None]
    return Experiment.of(SPRING.simulate(np.zeros(2), force, t), noise=NOISE, seed=seed, **options)
