"""An input that acts 20 ms late: the regulator that ignores it fails, the one that predicts holds."""

import dataclasses

from pliant.controllers import LQR, Predictive
from pliant.controllers.linear_quadratic.delay import delay_margin
from pliant.envs import scenes
from pliant.studies.closed_loop.evaluation_scene import finer, play
from pliant.studies.closed_loop.rollout import nominal, rollout

scene = scenes.get("two-link-reach")
lqr = LQR.for_scene(scene)  # designed on two modes a link
model = scene.plant.linearize(*scene.target).discretize(scene.dt)
print(f"LQR bears {delay_margin(model, lqr.K)} periods of delay")

played = play(scene, finer(scene.plant))  # three modes a link
late = dataclasses.replace(nominal(played), delay=1)
naive = rollout(played, lqr, late)
print(f"LQR: {naive.failure}")

knowing = rollout(played, Predictive.for_scene(scene, delay=1), late)
print(f"on the predicted state: cost {knowing.cost:.4f}, {rollout(played, lqr).cost:.4f} without delay")
