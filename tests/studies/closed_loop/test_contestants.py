"""Who plays, what is played, and what a controller is told."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import (
    LQG,
    LQR,
    MPC,
    NMPC,
    Led,
    MultiModelLQR,
    PeriodicLQG,
    PeriodicLQR,
    PeriodicMPC,
    PeriodicTVLQR,
    Policy,
)
from pliant.envs import scenes
from pliant.plants import PliantError
from pliant.studies.closed_loop.contestants import CONTESTANTS, MARGIN, OfSeed, designed, playable

SLEW = scenes.get("single-link-slew")
ROUND = dataclasses.replace(
    scenes.get("slider-crank-run"), dt=5 / 192, substeps=100, duration=5 / 24
)  # a turn is 16 periods


def test_all_scenes_with_inputs_are_played():
    named = {s.name for s in playable()}
    assert set(scenes.names()) <= named
    assert {"single-link-slew-gentle", "two-link-reach-weak"} <= named
    assert len({s.name for s in playable()}) == len(playable())
    assert {"LQR", "MPC", "trained policy"} < set(CONTESTANTS)


def test_it_is_told_bounds_inside_those_that_end_a_run():
    seen = []
    designed(SLEW, lambda scene: seen.append(scene) or LQR.for_scene(scene))
    assert MARGIN == 0.1
    assert dict(seen[0].bounds) == pytest.approx({"tip_deflection": 0.27, "hub_angle_rate": 10.8})
    assert dataclasses.replace(seen[0], bounds=SLEW.bounds) == SLEW
    assert isinstance(designed(SLEW, MPC.for_scene), MPC)


def test_why_there_is_none_in_one_line():
    def refuse(scene):
        raise PliantError("no law\nsecond line")

    assert designed(SLEW, refuse) == "PliantError: no law"
    half = dataclasses.replace(SLEW, limits=(20.0,))
    assert "it was trained for limits of [40.]" in designed(half, CONTESTANTS["trained policy"])
    fast = dataclasses.replace(SLEW, dt=0.01)
    assert designed(fast, lambda scene: LQR.for_scene(SLEW)).endswith("acts every 0.02 s, the scene's period is 0.01 s")
    policy = designed(SLEW, CONTESTANTS["trained policy"])
    assert isinstance(policy, Policy) and np.array_equal(policy.limits, [40.0])


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("LQR", PeriodicLQR),
        ("LQR, delay 0 to 1", PeriodicLQR),
        ("TVLQR", PeriodicTVLQR),
        ("MPC", PeriodicMPC),
        ("NMPC", NMPC),
        ("LQG", PeriodicLQG),
        ("robust LQG", PeriodicLQG),
        ("multi-model LQR", PeriodicLQR),
        ("multi-model, sensors", PeriodicLQG),
    ],
)
def test_where_the_goal_is_a_cycle_the_law_of_a_cycle_plays(name, kind):
    assert isinstance(designed(ROUND, CONTESTANTS[name]), kind)


def test_a_goal_that_is_a_cycle_has_its_regulator():
    assert isinstance(designed(ROUND, CONTESTANTS["LQR, delay known"]).law, PeriodicLQR)
    off = dataclasses.replace(ROUND, dt=0.0123)
    assert "whole control periods" in designed(off, CONTESTANTS["LQR"])


def test_a_narrow_bound_on_bending_is_kept_by_a_law_that_is_led():
    gentle = scenes.get("single-link-slew-gentle")
    assert isinstance(designed(gentle, CONTESTANTS["multi-model LQR"]), Led)
    assert isinstance(designed(SLEW, CONTESTANTS["multi-model LQR"]), MultiModelLQR)


def test_robust_lqg_where_the_goal_is_no_point_is_an_lqg_with_dearer_inputs_that_lasts():
    """spin-up turns on: robust_lqg refuses it. LQG as the scene prices it leaves a bound with all at once at +-30 %."""
    spin = scenes.get("spin-up")
    law = designed(spin, CONTESTANTS["robust LQG"])
    assert isinstance(law, LQG)
    gains = [np.abs(one.law.K).max() for one in (law, LQG.for_scene(spin), LQG.for_scene(spin, effort=10.0))]
    assert gains[0] < gains[1] and gains[0] == pytest.approx(gains[2])


def test_the_policy_of_a_seed_is_found_by_its_folder(tmp_path):
    Policy.for_scene("single-link-slew").save(tmp_path / "single-link-slew-3" / "policy")
    assert isinstance(designed(SLEW, OfSeed(str(tmp_path), 3)), Policy)
    assert designed(SLEW, OfSeed(str(tmp_path), 4)).endswith("no policy of seed 4 was trained on single-link-slew")
