"""Linear models play a scene's motion as well as they can: against simulation, and against what must be exact."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.charts.linear_runs import NoLinearModel, linear_run, simplifies
from pliant.studies.common.reference_motions import Motions

MOTIONS = Motions(scenes.get("single-link-slew", duration=0.6))
LADDER = MOTIONS.ladder


def apart(run, plant):
    return np.abs(run.play() - MOTIONS.converged(plant)).max()


def test_along_the_rigid_motion_is_far_nearer_than_that_motion():
    plant = LADDER[1]
    run = linear_run(MOTIONS, plant, "ltv", MOTIONS.scene.dt / 5)
    assert run.states == plant.nx and run.made > 0
    assert apart(run, plant) < 0.2 * np.abs(MOTIONS.converged(LADDER[0]) - MOTIONS.converged(plant)).max()


def test_the_cheapest_variant_has_nothing_to_be_linearised_along():
    assert not simplifies(MOTIONS, LADDER[0], "ltv") and not simplifies(MOTIONS, LADDER[0], "reduced")
    assert simplifies(MOTIONS, LADDER[0], "linear") and simplifies(MOTIONS, LADDER[1], "ltv")


def test_about_the_start_is_exact_for_small_motions():
    """A motion through a thousandth of the angle: second-order terms are a millionth."""
    scene = dataclasses.replace(MOTIONS.scene, goal=tuple((name, 1e-3 * value) for name, value in MOTIONS.scene.goal))
    small, plant = Motions(scene), LADDER[1]
    run, moved = linear_run(small, plant, "linear"), small.converged(plant)
    size = np.abs(moved - moved[0]).max()
    assert np.abs(run.play() - moved).max() < 3e-3 * size
    half = linear_run(small, LADDER[-1], "reduced")
    assert half.states == 6 and np.abs(half.play() - small.converged(LADDER[-1])).max() < 3e-2 * size


@pytest.mark.parametrize("rung", [1, 2, -1])
def test_half_the_states_err_by_no_more_than_told_beforehand(rung):
    """Of the linear model with all states, in the root mean square; the worst input for the bound is another one."""
    whole, half = (linear_run(MOTIONS, LADDER[rung], kind) for kind in ("linear", "reduced"))
    off = np.sqrt(np.square(half.play() - whole.play()).sum(axis=1).mean())
    assert whole.rms_bound is None
    assert 1e-4 * half.rms_bound < off <= half.rms_bound


def test_a_start_that_is_no_equilibrium_says_so():
    falling = Motions(scenes.get("cantilever-drop", duration=0.2))
    with pytest.raises(NoLinearModel, match=r"no linear model: the start is no equilibrium, d\("):
        linear_run(falling, falling.ladder[1], "linear")


def test_a_nominal_that_has_no_like_says_so():
    falling = Motions(scenes.get("cantilever-drop", duration=0.6))
    other = next(plant for plant in falling.ladder if plant.label.startswith("substructured"))
    with pytest.raises(NoLinearModel, match="the motion of strain, modes 1 has no like in the states of this variant"):
        linear_run(falling, other, "ltv", 0.05)
