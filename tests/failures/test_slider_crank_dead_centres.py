"""Where a slider-crank has no answer: a crank not shorter than the rod, and what the dead centres hide."""

import dataclasses
import math

import numpy as np
import pytest

from pliant.plants import EquilibriumError
from pliant.plants.slider_crank.plant import SliderCrank
from pliant.plants.slider_crank.rigid_kinematics import RigidSliderCrank

PLANT = SliderCrank.textbook()
FREE = dataclasses.replace(PLANT, crank_speed=None, kinematics="rigid")
DEAD = (0.0, math.pi, -math.pi, 2 * math.pi)


@pytest.mark.parametrize("radius", [0.28, 0.3, 5.0])
def test_crank_must_be_shorter_than_the_rod(radius):
    with pytest.raises(ValueError, match=rf"SliderCrank.crank_radius = {radius} must be > 0 and < rod.length = 0.28"):
        dataclasses.replace(PLANT, crank_radius=radius)


def test_printed_inverted_ratio_has_no_real_rod_angle():
    """lambda = l/r = 5.09 in sin phi2 = -lambda sin phi1: real within 11 degrees of the dead centres only."""
    angles = np.radians(np.arange(12, 169))
    assert np.all(0.28 / 0.055 * np.sin(angles) > 1)
    assert np.isfinite(PLANT.rigid.motion(angles, 1.0).rod_angle).all()


@pytest.mark.parametrize("angle", DEAD)
def test_slider_force_and_crank_speed_cannot_be_found_at_a_dead_centre(angle):
    for ask in (PLANT.rigid.held_force, PLANT.rigid.crank_rate):
        with pytest.raises(ValueError, match=r"no dead centre.*dx/dphi1"):
            ask(angle, 1.0)
    assert abs(PLANT.rigid.lever(angle)) < 1e-15
    motion = PLANT.rigid.motion(angle, 10.0)
    assert np.isfinite(motion).all() and abs(motion.slider_speed) < 1e-13


@pytest.mark.parametrize("angle", DEAD)
def test_slider_force_does_not_reach_a_crank_at_rest_in_a_dead_centre(angle):
    push = FREE.linearize(FREE.state(angle)).E[1, 0]
    away = FREE.linearize(FREE.state(angle + 0.5)).E[1, 0]
    assert abs(push) < 1e-12 < 1e-3 < abs(away)
    flexible = dataclasses.replace(FREE, kinematics="stiffened")
    assert abs(flexible.linearize(flexible.state(angle)).E[flexible.nx // 2, 0]) < 1e-12


def test_held_force_is_the_equilibrium_of_the_plant():
    for angle in (0.3, 1.9, -2.5):
        torque = FREE.equilibrium(crank_angle=angle)[1][0]
        assert FREE.rigid.held_force(angle, torque) == pytest.approx(FREE.force, rel=1e-9)


def test_no_angle_balances_a_torque_past_the_largest_lever():
    with pytest.raises(EquilibriumError):
        FREE.equilibrium(torque=10.0)


@pytest.mark.parametrize("x", [0.2249, 0.3351, -0.3, math.nan])
def test_slider_cannot_be_beyond_its_dead_centres(x):
    with pytest.raises(ValueError, match=r"slider_x = .* must be within \[0.225, 0.335\]"):
        PLANT.rigid.crank_angle_at(x)


def test_crank_angle_is_found_between_the_dead_centres_and_lost_as_the_root_at_them():
    for angle in (0.0, 0.4, 1.5, 3.0, math.pi):
        x = float(PLANT.rigid.motion(angle, 1.0).slider_x)
        assert PLANT.rigid.crank_angle_at(x) == pytest.approx(angle, abs=3e-7)
        assert PLANT.rigid.crank_angle_at(x, upper=False) == pytest.approx(-angle, abs=3e-7)
    # A rounding of x moves the angle by its root.
    assert PLANT.rigid.crank_angle_at(0.335 - 1e-14) > 1e-7


def test_rigid_mechanism_checks_its_lengths():
    with pytest.raises(ValueError, match=r"RigidSliderCrank.crank_radius = 2.0 must be > 0 and < rod_length = 1.0"):
        RigidSliderCrank(2.0, 1.0)
