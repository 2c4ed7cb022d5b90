"""Controllers that travel in the middle of a slew; references, shapers, regulators and plans."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from travelling import RIGID, SLEW, Roll, fields, nominal
from travelling_models import along_the_slew, rigid_model

from pliant.controllers import (
    LQG,
    LQR,
    MPC,
    NMPC,
    PD,
    TVLQR,
    ComputedTorque,
    Objective,
    Policy,
    Predictive,
    delayed,
    loop,
    margins,
    optimal,
    plan,
    riccati,
    rl,
    sensors_of,
    shaper_for,
    spillover,
)  # fmt: skip
from pliant.controllers.base.controller import Feedback
from pliant.controllers.base.joint_reference import Follow, RestToRest

ROLL = Roll()
traveller, record = ROLL.traveller, ROLL.record

WIDE = dataclasses.replace(SLEW, limits=(1e6,))  # an input at its limit is the same whatever a copy remembers


@cache
def readings(count: int = 12) -> np.ndarray:
    """Deviations of 16 signals at most."""
    return 1e-4 * np.random.default_rng(0).standard_normal((count, 16))


def acts(law: Any, start: int = 6) -> np.ndarray:
    """Six acts about the goal of the slew, from act `start` on."""
    x, u = SLEW.target
    known = dict(zip([s.name for s in SLEW.plant.states + SLEW.plant.outputs], [*x, *SLEW.plant.measure(x, u)]))
    y = np.array([known[r] for r in law.reads]) + readings()[:, : len(law.reads)]
    dt = law.dt or 0.01
    return np.array([law.act(k * dt, y[k]) for k in range(start, start + 6)])


def used(law: Any) -> Any:
    law.reset()
    acts(law, 0)
    return law


def law(name: str, make: Callable[[], Any]) -> None:
    traveller(name, acts)(lambda: used(make()))


law("LQR", lambda: LQR.for_scene(WIDE))
law("LQR that integrates", lambda: LQR.for_scene(WIDE, integral={"hub_angle": 10.0}))
law("LQG", lambda: LQG.for_scene(WIDE))
law("LQG late", lambda: LQG.for_scene(WIDE, delay=2))
law("PD", lambda: PD.for_scene(WIDE))
law("computed torque", lambda: ComputedTorque.for_scene(WIDE))
law("TVLQR", lambda: TVLQR.for_scene(WIDE))
law("predictive", lambda: Predictive.for_scene(WIDE, delay=2))
law("MPC", lambda: MPC.for_scene(SLEW))
law("MPC that remembers", lambda: MPC.for_scene(SLEW, rates=[40.0]))
law("MPC that estimates", lambda: MPC.for_scene(SLEW, track=("hub_angle",)))
law("MPC along", lambda: MPC.for_scene(SLEW, nominal=nominal()))
law("NMPC", lambda: NMPC.for_scene(SLEW, horizon=6))
law("feedback", lambda: Feedback(np.array([[3.0, 1.0]]), ("hub_angle", "hub_angle_rate")))


@traveller("objective", lambda o: (o.cost(np.full((3, SLEW.plant.nx), 0.1), np.full((3, 1), 0.2)), o.x_goal))
def _objective() -> Any:
    return Objective.of(SLEW)


record("follow")(lambda: Follow(0.1, *(np.linspace(0, k, 8).reshape(4, 2) for k in (1, 2, 3))))
traveller("rest to rest", lambda r: [r(t) for t in (0.0, 0.3, 2.0)])(
    lambda: RestToRest([0.0], [1.0], 0.5, shaper_for([3.0]))
)
traveller("shaper", lambda s: (fields(s), s.residual(2.5), (s * s).times))(lambda: shaper_for([3.0, 8.0], "zvd"))
traveller("policy", acts)(lambda: used(Policy.for_scene("single-link-slew")))
traveller("sensors", lambda s: [k.read(0.3, 0.01, np.random.default_rng(0)) for k in s])(lambda: sensors_of(SLEW.plant))


def filtered(kalman: Any) -> Any:
    return [(kalman.step(y[: len(kalman.sensors)], [0.1]), kalman.estimate, kalman.covariance) for y in readings()[:5]]


@traveller("Kalman", filtered)
def _kalman() -> Any:
    kalman = LQG.for_scene(WIDE).filter
    filtered(kalman)
    return kalman


def rigid_law() -> Any:
    return LQR.design(rigid_model(), np.diag([10.0, 1.0]), np.eye(1), dt=0.01)


record("margins")(lambda: margins(loop(rigid_model(), rigid_law())))
record("loop")(lambda: loop(rigid_model(), rigid_law()))
LADDER = [step for step in SLEW.plant.ladder() if step.nx >= SLEW.plant.nx][:2]
record("spillover")(lambda: spillover(LQG.for_scene(WIDE), [r.linearize(r.rest_state) for r in LADDER]))
record("delayed model")(lambda: delayed(rigid_model().discretize(0.01), 2))
record("regulator")(lambda: riccati.lqr(rigid_model().A, rigid_model().B, np.eye(2), np.eye(1)))
record("regulator along")(lambda: riccati.tvlqr(along_the_slew(), np.eye(SLEW.plant.nx), np.eye(1)))
RIGID_SLEW = dataclasses.replace(
    SLEW, plant=RIGID, observe=("hub_angle", "hub_angle_rate"), weights=(("hub_angle", 10.0), ("hub_angle_rate", 0.1)),
    bounds=(), compare=("hub_angle",),
)  # fmt: skip
record("optimal motion")(lambda: optimal(Objective.of(RIGID_SLEW), RIGID_SLEW.initial[0], 20, substeps=3))
record("planned motion")(lambda: plan(RIGID_SLEW))
traveller("nominal input", lambda f: [f(t) for t in (0.0, 0.1, 0.4)])(lambda: SLEW.nominal_input)
record("converged plan")(lambda: NMPC.for_scene(SLEW, horizon=6).iterate(SLEW.initial[0], tolerance=1e-3))


for label, made in {
    "PPO settings": rl.PPOSettings(),
    "SAC settings": rl.SACSettings(),
}.items():
    record(label)(lambda made=made: made)
