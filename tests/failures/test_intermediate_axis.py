"""Spin about the intermediate axis diverges; booms can move that axis: the hub's is z, the whole spacecraft's is y."""

import dataclasses

import numpy as np
import pytest

from pliant.plants.spacecraft.plant import FlexibleSpacecraft

CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear", translation=False)
RIGID = dataclasses.replace(CRAFT, kinematics="rigid")
INERTIA = np.array([200.0, 1310 / 3, 1400 / 3])  # hub and two slender rods of 10 kg, 5 m, rooted 1 m off the centre
SPIN = 0.1


def growth(craft, axis):
    """Largest real part of the frozen roots in a steady spin."""
    return craft.linearize(craft.state({f"rate_{axis}": SPIN})).eigenvalues.real.max()


def test_only_the_composite_intermediate_axis_diverges():
    for axis in "xz":
        assert growth(RIGID, axis) < 1e-7
        assert growth(CRAFT, axis) < 1e-7
    I1, I2, I3 = INERTIA
    expected = SPIN * np.sqrt((I2 - I1) * (I3 - I2) / (I1 * I3))  # Euler's equations linearised
    assert growth(RIGID, "y") == pytest.approx(expected, rel=1e-9)
    assert expected == pytest.approx(0.02758104939472546, rel=1e-6)  # the reference file's figure
    assert growth(CRAFT, "y") == pytest.approx(0.027560462, abs=1e-8)  # flexibility shifts it a little


def test_the_hub_alone_would_point_at_another_axis():
    alone = dataclasses.replace(RIGID, appendages=())
    assert growth(alone, "z") > 0.01
    assert growth(alone, "y") < 1e-7


def test_the_nonlinear_plant_tumbles():
    """A small disturbance grows at the predicted rate, then the spin turns over."""
    x = CRAFT.state(rate_y=SPIN, rate_x=1e-5)
    t = np.linspace(0, 500, 501)
    run = CRAFT.simulate(x, None, t, rtol=1e-8)
    across = np.hypot(run["rate_x"], run["rate_z"])
    k = np.flatnonzero((across > 1e-4) & (np.arange(len(t)) < np.argmax(across > 5e-3)))  # the first rise
    assert np.polyfit(t[k], np.log(across[k]), 1)[0] == pytest.approx(0.02756, rel=0.03)
    assert run["rate_y"].min() < -0.9 * SPIN
    steady = CRAFT.simulate(CRAFT.state(rate_z=SPIN, rate_x=1e-5), None, t, rtol=1e-8)
    assert np.hypot(steady["rate_x"], steady["rate_y"]).max() < 1e-4
