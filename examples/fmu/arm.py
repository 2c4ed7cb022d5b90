"""An arm as an FMU 3.0 for co-simulation, by PythonFMU3: torque in, hub angle and tip out.

    pip install pythonfmu3 fmpy
    pythonfmu3 build -f examples/fmu/arm.py

The machine that runs it needs Python with Pliant: what PythonFMU3 packs is this file, not the C of `export_c`.
"""

import numpy as np
from pythonfmu3 import Float64, Fmi3Causality, Fmi3Slave, Fmi3Variability

from pliant.envs import scenes

STEP = 1e-3  # [s] of the classical Runge-Kutta method; communication steps are multiples of it
MOVES = Fmi3Variability.continuous


class Arm(Fmi3Slave):
    """The plant of single-link-slew from the scene's start."""

    def __init__(self, **kwargs) -> None:
        super().__init__(**kwargs)
        scene = scenes.get("single-link-slew")
        self.plant, self.x = scene.plant, scene.initial[0].copy()
        self.step = self.plant.stepper(STEP)
        self.time = self.hub_torque = self.hub_angle = self.tip_y = 0.0
        self.register_variable(Float64("time", causality=Fmi3Causality.independent, variability=MOVES))
        self.register_variable(Float64("hub_torque", causality=Fmi3Causality.input, variability=MOVES))
        for name in ("hub_angle", "tip_y"):
            self.register_variable(Float64(name, causality=Fmi3Causality.output, variability=MOVES))

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Over a communication step, the torque held."""
        u = np.array([self.hub_torque])
        for _ in range(round(step_size / STEP)):
            self.x = self.step(self.x[None], u[None])[0]
        found = dict(zip((s.name for s in self.plant.outputs), self.plant.measure(self.x, u).tolist()))
        self.hub_angle, self.tip_y, self.time = found["hub_angle"], found["tip_y"], current_time + step_size
        return True
