"""A scene's machine as other programs are told it."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.peers.planar_machine import NotModelledError, machine_of


def test_the_arm_that_reaches():
    scene = scenes.get("two-link-reach")
    machine = machine_of(scene)
    assert machine.root == "torque" and machine.links == (scene.plant.link1, scene.plant.link2)
    assert machine.angles == pytest.approx((-np.pi / 2, -np.pi / 2)) and machine.gravity == (0.0, -9.81)
    assert machine.held.shape == (150, 2) and machine.duration == pytest.approx(3.0)


def test_a_prescribed_root_turns_as_the_plant_says():
    scene = scenes.get("spin-up", time=2.0, speed=0.1)
    angle, rate = machine_of(scene).root_motion
    held = np.array([scene.nominal_input(t) for t in scene.times])
    motion = scene.plant.simulate(scene.initial[0], held, scene.times, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(angle, motion["hub_angle"], atol=1e-7)
    np.testing.assert_allclose(rate, motion["hub_angle_rate"], atol=1e-7)


def test_outputs_of_the_tip():
    machine = dataclasses.replace(machine_of(scenes.get("spin-up")), compare=("tip_x", "tip_u", "tip_deflection"))
    found = machine.outputs(np.array([[0.0, 10.0], [8.0, 6.0]]), np.array([np.pi / 2, 0.0]))
    np.testing.assert_allclose(found, [[0.0, -10.0, 0.0], [8.0, -2.0, 6.0]], atol=1e-14)


@pytest.mark.parametrize("name", ["spacecraft-slew", "spacecraft-orbit", "slider-crank-run"])
def test_what_is_no_chain_of_beams_says_why(name):
    with pytest.raises(NotModelledError, match=r"hub|crank"):
        machine_of(scenes.get(name))


def test_what_the_models_leave_out():
    arm = scenes.get("single-link-slew")
    off = dataclasses.replace(arm.plant.payload, offset=(0.1, 0.0, 0.0))
    for scene, words in (
        (dataclasses.replace(arm, compare=("root_curvature",)), "root_curvature"),
        (arm.with_plant(dataclasses.replace(arm.plant, payload=off)), "off the tip"),
        (arm.with_plant(dataclasses.replace(arm.plant, hub_radius=0.1)), "off the hub"),
        (arm.with_plant(dataclasses.replace(arm.plant, gravity=9.81)), "straight"),
    ):
        with pytest.raises(NotModelledError, match=words):
            machine_of(scene)
