"""Rests of a pendulum on a ball joint, against what hangs straight down; its frequencies in closed form."""

import numpy as np
import pytest

from pliant.plants import EquilibriumError, FlexibleTree, Frame, Joint, TreeBody


def test_hangs_down(pendulum):
    x0, u0 = pendulum.equilibrium(guess={"ball_quaternion_0": 0.9, "ball_quaternion_1": 0.3, "ball_quaternion_2": 0.2})
    np.testing.assert_allclose(np.linalg.norm(x0[:4]), 1.0, rtol=1e-12)
    np.testing.assert_allclose(x0[[1, 2]], 0.0, atol=1e-9)
    assert not u0.any()


def test_held_aslant_by_torques(pendulum):
    """m g l sin(angle) about the axis of the turn."""
    angle = 0.4
    x0, u0 = pendulum.equilibrium(
        ball_quaternion_0=np.cos(angle / 2),
        ball_quaternion_1=np.sin(angle / 2),
        ball_quaternion_2=0,
        ball_quaternion_3=0,
    )
    np.testing.assert_allclose(u0, [2.0 * 9.81 * 0.5 * np.sin(angle), 0, 0], atol=1e-9)
    assert np.abs(pendulum.dynamics(x0, u0)).max() < 1e-9


def test_frequencies(pendulum):
    """Of a physical pendulum, twice: sqrt(m g l/(J + m l^2)); the spin about the rod has none."""
    wanted = np.sqrt(2.0 * 9.81 * 0.5 / (0.1 + 2.0 * 0.25))
    np.testing.assert_allclose(pendulum.natural_frequencies(), [wanted, wanted], rtol=1e-10)
    roots = np.sort(np.linalg.eigvals(pendulum.linearize(pendulum.rest_state).A).imag)
    np.testing.assert_allclose(roots[-2:], wanted, rtol=1e-10)


def test_none(pendulum):
    with pytest.raises(EquilibriumError):
        pendulum.equilibrium(ball_quaternion_0=1.0, ball_quaternion_1=1.0)


def test_a_load_on_a_ball_is_below_or_above_it_however_the_ball_stands():
    """Its centre is level with the ball where nothing is turned: a quarter turn away it hangs, or stands."""
    mast = TreeBody(name="mast", joint=Joint(name="cart", kind="prismatic", axis=(1, 0, 0)), mass=2.0, inertia=0.1)
    ball = Joint(name="ball", kind="spherical", rotation=(0.0, -np.pi / 2, 0.0), drive="none")
    load = TreeBody(name="load", joint=ball, mass=0.4, centre=(0.0, 0.0, 0.3), inertia=0.01)
    tree = FlexibleTree.serial([mast, load], frames=(Frame(name="eye", body="load", position=(0.0, 0.0, 0.3)),))
    x0, u0 = tree.equilibrium()
    at = [s.name for s in tree.outputs].index("eye_x")
    assert abs(tree.measure(x0, u0)[at]) < 1e-6 and abs(tree.measure(x0, u0)[at + 2]) == pytest.approx(0.3)
    assert np.abs(tree.dynamics(x0, u0)).max() < 1e-8
