"""Verdicts of scenes: what has no part in them, and in which coordinates they are told."""

import pytest

from pliant.envs import scenes
from pliant.plants.stability import assess
from pliant.studies.stability.verdicts import left_out, verdict_of


def test_what_is_left_out_of_a_spacecrafts_verdict():
    """The attitude only where nothing feels it; hinges whose motion is given; wheels without friction."""
    spin, orbit = scenes.get("spacecraft-spin"), scenes.get("spacecraft-orbit")
    hinges = {"hinge1_1", "hinge2_1", "hinge1_1_rate", "hinge2_1_rate"}
    own = spin.plant.linearize(*spin.target, attitude="quaternion")
    assert set(left_out(spin.plant, own)) == {*hinges, *(f"quaternion_{k}" for k in range(4))}
    assert set(left_out(orbit.plant, orbit.goal_model)) == {*hinges, *(f"wheel{k}_momentum" for k in (1, 2, 3))}
    arm = scenes.get("single-link-slew")
    assert left_out(arm.plant, arm.goal_model) == ()


@pytest.mark.campaign
def test_turns_from_a_turning_attitude_would_show_a_growth_of_their_own():
    """Why a free spacecraft is judged in body rates: in turns the slew's frozen roots and growth are far larger."""
    scene = scenes.get("spacecraft-slew")
    motion = scene.nominal_motion(rtol=1e-8, atol=1e-10)
    naive = assess(scene.plant.linearize_along(motion))
    found, _ = verdict_of(scene)
    assert naive.evidence["growth"].total > 4 and naive.evidence["frozen_time"].rightmost.max() > 0.03
    assert found.evidence["growth"].total < 1.1 and found.evidence["frozen_time"].rightmost.max() < 1e-4
