import dataclasses
import re

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import PliantError
from pliant.studies.closed_loop.closed_loop import closed_loop, dearer, run


@pytest.fixture(scope="module", params=["single-link-slew", "two-link-reach"])
def case(request):
    scene = linear_reach() if request.param == "two-link-reach" else scenes.get(request.param)
    return scene, *closed_loop(scene)


@pytest.mark.every(2)
def test_scene_regulator_is_stable_on_every_variation(case):
    _, _, loops = case
    assert [loop.name for loop in loops[:3]] == ["the design plant", "payload.mass -50%", "payload.mass +50%"]
    assert loops[3].states > loops[0].states
    for loop in loops:
        assert loop.stable and not loop.spillover and loop.radius < 1
        assert loop.cost > 0 and loop.final_error < 0.1
        assert loop.verdict.startswith("stable")


@pytest.mark.campaign
def test_radius_is_that_of_the_design(case):
    _, law, loops = case
    assert loops[0].radius == pytest.approx(np.abs(law.poles).max(), rel=1e-9)


@pytest.mark.every(2)
def test_inputs_stay_within_the_limits(case):
    scene, _, loops = case
    for loop in loops:
        assert (np.abs(loop.motion.u) <= np.array(scene.limits) * (1 + 1e-12)).all()


def test_cost_is_the_weighted_squares_summed_over_the_control_periods(case):
    """Written out from the scene's tables; both goals are at rest, the two links' torques hold them."""
    scene, _, loops = case
    motion, goal = loops[0].motion, dict(scene.goal)
    held = dict(zip((s.name for s in scene.plant.inputs), scene.target[1]))
    assert len(goal) == len(held)
    rates = [w * (motion[name] - goal.get(name, 0.0)) ** 2 for name, w in scene.weights]
    rates += [w * (motion[name] - held[name]) ** 2 for name, w in scene.effort]
    assert loops[0].cost == pytest.approx(scene.dt * np.sum(rates, axis=0)[:-1].sum(), rel=1e-12)


def linear_reach(**changes):
    """The two links in clamped-free modes without the shortening."""
    scene = scenes.get("two-link-reach", **changes)
    return scene.with_plant(dataclasses.replace(scene.plant, kinematics="linear", basis="clamped-free", modes=(2, 2)))


def test_spillover_is_named_with_its_mode():
    """Cheap effort and fast sampling: one of the modes beyond the design's six is driven unstable."""
    scene = linear_reach(dt=0.005, duration=1.7)
    effort = tuple((name, weight / 100) for name, weight in scene.effort)
    _, loops = closed_loop(dataclasses.replace(scene, effort=effort))
    assert all(loop.stable for loop in loops[:3])
    dear = loops[3]
    assert dear.stable is False and dear.spillover and dear.radius > 1
    said = re.fullmatch(
        r"unstable by spillover: mode (\d+) of the plant, .* Hz .* grows at .* 1/s; the design model has only 6",
        dear.verdict,
    )
    assert int(said[1]) > 6
    assert np.abs(dear.motion["tip1_deflection_rate"][300:]).max() > 1.0


@pytest.mark.campaign
def test_mode_that_the_design_has_at_another_frequency_is_named_so():
    """Two polynomials a link put mode 5 at 41 Hz where it is at 31 Hz; sampled at 50 Hz they fold apart."""
    scene = scenes.get("two-link-reach", dt=0.02, duration=0.5)
    plant = dataclasses.replace(scene.plant, kinematics="stiffened", basis="polynomial", modes=(2, 2))
    design = [m.frequency_hz for m in plant.linearize(*scene.with_plant(plant).target).modes()]
    _, loops = closed_loop(scene.with_plant(plant))
    dear = loops[3]
    assert dear.stable is False and not dear.spillover
    assert "mode 5 of the plant, 31.3 Hz" in dear.verdict
    assert dear.verdict.endswith(f"the design model has it at {design[4]:.3g} Hz")


def test_dearer_of_a_rigid_plant_bends():
    for name in scenes.names():
        rungs = scenes.get(name).plant.ladder()
        assert dearer(rungs[0]).nx > rungs[0].nx or len(rungs) == 1


def test_a_run_that_takes_too_long_is_given_up_and_says_how_far_it_came(case):
    scene, law, _ = case
    told = r"given up: its first 0\.\d+ of .* s have taken 0 s of processor time, of which it has 0"
    with pytest.raises(PliantError, match=told):
        run(scene, law, patience=0.0)


def test_dearer_of_a_tree_has_more_shapes_in_its_own_kinematics():
    tree = scenes.get("six-axis-pick").plant
    assert dearer(tree).kinematics == tree.kinematics and dearer(tree).nx > tree.nx
