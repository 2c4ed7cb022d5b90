"""A TVLQR outside its funnel saturates: it bends the arm past its bound, or lets it fall. The funnel says so before."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import TVLQR, plan
from pliant.envs import scenes
from pliant.plants import IntegrationError, MassMatrixError

BASE = scenes.get("single-link-slew")
SLEW = dataclasses.replace(BASE, bounds=(("tip_deflection", 0.012), ("hub_angle_rate", 12.0)))
AWAY = SLEW.initial[0] - np.array([0.8, 0, 0, 0, 0, 0])  # the arm stands 0.8 rad behind where the nominal begins

# The same arm balanced upright: the hub's 12 N m hold it up to 0.42 rad of lean, the link weighs 29 N m when level.
UPRIGHT = dataclasses.replace(
    BASE,
    plant=dataclasses.replace(BASE.plant, gravity=9.81),
    start=(("hub_angle", np.pi / 2 - 0.2),),
    goal=(("hub_angle", np.pi / 2 + 0.2),),
    limits=(12.0,),
    bounds=(("tip_deflection", 0.3),),
    move_time=2.0,
    duration=6.0,
)


def run(scene, law, start):
    return scene.plant.simulate(start, law, scene.times, method="rk4", step=scene.dt / scene.substeps)


def pushed(scene, rate):
    x = scene.initial[0].copy()
    x[3] += rate
    return x


def test_naive_trust_bends_the_arm_past_its_bound():
    law = TVLQR.for_scene(SLEW)
    motion = run(SLEW, law, AWAY)
    assert np.abs(motion.u).max() == 40.0
    assert np.abs(motion["tip_deflection"]).max() > 1.3 * 0.012


def test_it_is_known_beforehand():
    law = TVLQR.for_scene(SLEW)
    assert not law.funnel.inside(0.0, AWAY) and law.funnel.use(0.0, AWAY) > 10
    assert law.funnel.inside(0.0, SLEW.initial[0] + 0.05 * (AWAY - SLEW.initial[0]))


def test_a_plan_from_where_the_arm_is_holds():
    again = plan(SLEW, x0=AWAY, time=1.6)
    law = TVLQR.for_scene(SLEW, nominal=again)
    assert law.funnel.inside(0.0, AWAY)
    motion = run(SLEW, law, AWAY)
    assert np.abs(motion.u).max() < 36.0 + 1e-6
    assert np.abs(motion["tip_deflection"]).max() <= 0.012 + 1e-6
    assert np.abs(motion.x[-1] - SLEW.target[0]).max() < 1e-6


def test_the_balanced_arm_falls_from_outside_and_stands_from_inside():
    law = TVLQR.for_scene(UPRIGHT)
    hard, soft = pushed(UPRIGHT, -0.8), pushed(UPRIGHT, -0.04)
    assert law.funnel.use(0.0, hard) > 100 and law.funnel.inside(0.0, soft)
    try:
        fallen = run(UPRIGHT, law, hard)["hub_angle"].min()
    except (IntegrationError, MassMatrixError):
        fallen = -np.inf
    assert fallen < 0  # below the level: the feedback asks for more than 12 N m and gets 12
    motion = run(UPRIGHT, law, soft)
    assert np.abs(motion.u).max() < 12.0 and np.abs(motion.x[-1] - UPRIGHT.target[0]).max() < 1e-6


def test_a_slower_nominal_has_room_for_a_push_that_a_fast_one_has_not():
    fast = TVLQR.for_scene(UPRIGHT, nominal=plan(UPRIGHT, time=1.3, reserve=0.0))
    slow = TVLQR.for_scene(UPRIGHT, nominal=plan(UPRIGHT, time=4.0))
    push = pushed(UPRIGHT, -0.05)
    assert not fast.funnel.inside(0.0, push) and slow.funnel.inside(0.0, push)
    assert np.abs(run(UPRIGHT, fast, push).u).max() == pytest.approx(12.0)
    assert np.abs(run(UPRIGHT, slow, push).u).max() < 11.0
