"""LQG: an elastic arm slewed on what its sensors read, and how far the loop is from instability."""

import numpy as np

from pliant.controllers import LQG, LQR, loop, margins, sensors
from pliant.envs import scenes

scene = scenes.get("single-link-slew")
lqg = LQG.for_scene(scene)  # its plant's own sensors; the scene's cost, limits and start
for sensor in lqg.filter.sensors:
    print(f"{sensor.kind} on {sensor.output}: {sensor.deviation(lqg.dt):.2g} {sensor.unit} a sample")


class Noisy:
    """The loop with noise and quanta on every reading."""

    dt, reads, reset = lqg.dt, lqg.reads, lqg.reset
    rng = np.random.default_rng(0)

    def act(self, t, y):
        return lqg.act(t, sensors.read(lqg.filter.sensors, y, lqg.dt, self.rng))


motion = scene.plant.simulate(scene.initial[0], Noisy(), scene.times, rtol=1e-8, atol=1e-10)
best = scene.plant.simulate(scene.initial[0], LQR.for_scene(scene), scene.times, rtol=1e-8, atol=1e-10)
print(f"cost {scene.cost(motion) / scene.cost(best):.4f} times that of the LQR that reads every state")
print(margins(loop(lqg.filter.model, lqg)))
