"""PD and rigid computed torque against closed forms and against what sampling and flexibility do to them."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers.base.joint_reference import Follow, Joints, RestToRest, joints
from pliant.controllers.joint_control.collocation import loop_eigenvalues, rigid_inertia
from pliant.controllers.joint_control.computed_torque import ComputedTorque
from pliant.controllers.joint_control.input_shaping import shaper
from pliant.controllers.joint_control.pd import PD
from pliant.envs import scenes
from pliant.plants import LargeDeflectionBeam, PliantError, SingleLinkArm, TwoLinkArm


def test_rest_to_rest_is_the_quintic() -> None:
    move = RestToRest(np.array([1.0]), np.array([3.0]), 2.0)
    r, dr, ddr = move(1.0)
    assert r == pytest.approx(2.0)
    assert dr == pytest.approx(15 / 8 * 2 / 2)  # peak rate of the minimum-jerk motion: 15/8 of the mean
    assert ddr == pytest.approx(0.0)
    assert move(-1.0)[0] == 1.0 and move(9.0)[0] == 3.0


def test_shaped_reference_is_the_convolution() -> None:
    by = shaper(5.0, 0.1)
    move, plain = RestToRest(np.zeros(1), np.ones(1), 1.0, by), RestToRest(np.zeros(1), np.ones(1), 1.0)
    for t in (0.2, 0.9, 1.7):
        for k in range(3):
            want = sum(a * plain(t - s)[k] for s, a in zip(by.times, by.amplitudes))
            np.testing.assert_allclose(move(t)[k], want, atol=1e-14)
    assert move.duration == pytest.approx(1.0 + by.duration)


def test_follow_goes_on_at_its_last_rate() -> None:
    motion = Follow(0.1, np.array([[0.0], [1.0]]), np.array([[2.0], [3.0]]), np.zeros((2, 1)))
    assert motion(0.0)[0] == 0.0 and motion(0.1)[0] == 1.0
    assert motion(0.3)[0] == pytest.approx(1.6)


def test_rigid_inertia_is_the_rigid_mass_matrix() -> None:
    arm = TwoLinkArm.textbook()
    x0, u0 = arm.equilibrium(theta1=-0.9, theta2=0.6)
    rigid = arm.ladder()[0]
    np.testing.assert_allclose(
        rigid_inertia(arm, x0, u0, ("theta1_rate", "theta2_rate")),
        rigid.mass_matrix(np.array([-0.9, 0.6, 0.0, 0.0])),
        rtol=1e-9,
    )


def test_gains_place_the_poles_of_a_rigid_joint() -> None:
    """Double integrator: s^2 + 2 z b s + b^2."""
    rigid = dataclasses.replace(SingleLinkArm.textbook(), hub_friction=0.0).ladder()[0]
    law = PD.design(rigid, np.zeros(2), np.zeros(1), bandwidth=4.0, damping=0.5)
    found = loop_eigenvalues(rigid.linearize(np.zeros(2)), law.K, law.reads, None)
    np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(np.roots([1.0, 4.0, 16.0])), rtol=1e-9)


@pytest.mark.parametrize("modes", [1, 3, 6])
@pytest.mark.parametrize("bandwidth", [0.5, 5.0, 50.0])
def test_without_sampling_no_elastic_mode_is_driven_unstable(modes: int, bandwidth: float) -> None:
    arm = dataclasses.replace(TwoLinkArm.textbook(), modes=(modes, modes), gravity=0.0, hub_inertia=(0.1, 0.02))
    x0, u0 = np.zeros(arm.nx), np.zeros(2)
    law = PD.design(arm, x0, u0, bandwidth=bandwidth)
    found = loop_eigenvalues(arm.linearize(x0), law.K, law.reads, None)
    assert found.real.max() < 0


def test_computed_torque_gives_the_rigid_arm_the_wanted_acceleration() -> None:
    arm = TwoLinkArm.textbook()
    rigid, rng = arm.ladder()[0], np.random.default_rng(4)
    move = RestToRest(np.array([-1.0, 0.3]), np.array([0.5, -0.4]), 1.5)
    law = ComputedTorque.design(arm, move, bandwidth=3.0, damping=0.8)
    for t in (0.0, 0.4, 1.1, 2.0):
        x = rng.standard_normal(4)
        r, dr, ddr = move(t)
        wanted = ddr + 2 * 0.8 * 3.0 * (dr - x[2:]) + 9.0 * (r - x[:2])
        np.testing.assert_allclose(rigid.dynamics(x, law.act(t, x))[2:], wanted, rtol=1e-9, atol=1e-9)


def test_for_scene_slews_and_holds() -> None:
    scene = scenes.get("single-link-slew")
    law = PD.for_scene(scene)
    motion = scene.plant.simulate(scene.initial[0], law, scene.times, rtol=1e-7, atol=1e-9)
    assert abs(motion["hub_angle"][-1] - 1.0) < 1e-5
    sampled = loop_eigenvalues(scene.plant.linearize(*scene.target), law.K, law.reads, law.dt)
    assert sampled.real.max() < -3.0


def test_feedforward_holds_the_sagging_arm_at_its_goal() -> None:
    """At the goal u is what the elastic equilibrium takes, not what the rigid one would."""
    scene = scenes.get("two-link-reach")
    law = PD.for_scene(scene)
    x, u = scene.target
    names = [s.name for s in scene.plant.states]
    y = x[[names.index(name) for name in law.reads]]
    np.testing.assert_allclose(law.act(10.0, y), u, rtol=1e-9)


def test_shaped_reference_calms_the_loop_of_a_soft_joint() -> None:
    """A PD too soft to damp the arm: the shaped motion ends with a small part of the vibration."""
    scene = scenes.get("single-link-slew")
    x0, u0 = scene.target
    soft = PD.design(
        scene.plant, x0, u0, bandwidth=60.0, damping=0.3, reference=RestToRest(np.zeros(1), np.ones(1), 0.25), dt=1e-3
    )
    calm = soft.shaped(scene.plant.linearize(x0, u0), "zvd")
    t = np.arange(0.0, 1.6, 1e-3)
    left = []
    for law in (soft, calm):
        motion = scene.plant.simulate(scene.initial[0], law, t, rtol=1e-8, atol=1e-10)
        late = t > law.reference.duration + 0.02
        left.append(np.abs(motion["tip_deflection"][late][:400]).max())
    assert left[1] < 0.1 * left[0]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: RestToRest(np.zeros(1), np.zeros(2), 1.0), "must be"),
        (lambda: RestToRest(np.zeros(1), np.zeros(1), 0.0), "time = 0.0 must be > 0"),
        (lambda: PD.design(SingleLinkArm.textbook(), np.zeros(6), [0.0], bandwidth=0.0), "bandwidth = 0.0 must be > 0"),
        (
            lambda: PD.design(SingleLinkArm.textbook(), np.zeros(6), [0.0], bandwidth=1.0, damping=-1.0),
            "damping = -1.0 must be > 0",
        ),
        (lambda: PD.for_scene(scenes.get("single-link-slew")).act(0.0, np.array([np.nan, 0.0])), "PD.y"),
    ],
)
def test_bad_input(call, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        call()


def test_plants_without_joints_say_so() -> None:
    with pytest.raises(PliantError, match=r"tip_force_x.*no joint for each input"):
        joints(LargeDeflectionBeam.textbook())
    assert joints(TwoLinkArm.textbook()) == Joints(("theta1", "theta2"), ("theta1_rate", "theta2_rate"))
