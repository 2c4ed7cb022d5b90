import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.closed_loop import closed_loop, dearer


@pytest.fixture(scope="module", params=scenes.names())
def case(request):
    scene = scenes.get(request.param)
    return scene, *closed_loop(scene)


def test_scene_regulator_is_stable_on_every_variation(case):
    _, _, loops = case
    assert [loop.name for loop in loops[:3]] == ["the design plant", "payload.mass -50%", "payload.mass +50%"]
    assert loops[3].states > loops[0].states
    for loop in loops:
        assert loop.stable and not loop.spillover and loop.radius < 1
        assert loop.cost > 0 and loop.final_error < 0.1
        assert loop.verdict.startswith("stable")


def test_radius_is_that_of_the_design(case):
    _, law, loops = case
    assert loops[0].radius == pytest.approx(np.abs(law.poles).max(), rel=1e-9)


def test_inputs_stay_within_the_limits(case):
    scene, _, loops = case
    for loop in loops:
        assert (np.abs(loop.motion.u) <= np.array(scene.limits) * (1 + 1e-12)).all()


def test_cost_is_the_cost_of_the_motion(case):
    scene, _, loops = case
    assert loops[0].cost == scene.cost(loops[0].motion)


def test_spillover_is_named_with_its_mode():
    """Cheap effort and fast sampling: the third mode of link 1, which the design lacks, is driven unstable."""
    scene = scenes.get("two-link-reach")
    effort = tuple((name, weight / 100) for name, weight in scene.effort)
    _, loops = closed_loop(dataclasses.replace(scene, dt=0.005, effort=effort))
    assert all(loop.stable for loop in loops[:3])
    dear = loops[3]
    assert dear.stable is False and dear.spillover and dear.radius > 1
    assert dear.verdict.startswith("unstable by spillover: ") and "(q13" in dear.verdict
    assert np.abs(dear.motion["tip1_deflection_rate"][300:]).max() > 1.0


def test_dearer_of_a_rigid_plant_bends():
    for name in scenes.names():
        rigid = scenes.get(name).plant.ladder()[0]
        assert dearer(rigid).nx > rigid.nx
