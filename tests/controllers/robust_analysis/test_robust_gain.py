"""Gains of motions that end, with an uncertain block: a closed form, and the published two-link arm."""

import numpy as np
import pytest
from evidence import agrees
from finite_horizon_arm import arm, gains, in_its_loop, nominal

from pliant.controllers.robust_analysis.robust_gain import UncertainLTV, end_gain, robust_gain, shows

X = np.array([[0.652, 0.0912], [0.0912, 25.76]])  # over the square of the nominal gain
WORST = -0.8, 22.86, 28.57  # of (-0.8 s + 22.86)/(s + 28.57), a first-order all-pass


@pytest.fixture(scope="module")
def published():
    plant = arm()
    ltv = plant.linearize_along(nominal(plant))
    return in_its_loop(ltv, gains(ltv))


def scalar(a=-1.0, m=60):
    one, t = np.ones((m, 1, 1)), np.linspace(0, 2, m)
    return UncertainLTV(t, a * one, one, one, one, 0 * one, 0 * one, np.ones((1, 1)))


def test_a_scalar_gain_has_a_closed_form():
    """int_0^T e^(2 a (T - s)) ds of the largest energy."""
    assert end_gain(scalar()) == pytest.approx(np.sqrt((1 - np.exp(-4)) / 2), rel=1e-6)


def test_a_constant_block_is_within_the_bound():
    """Delta = size makes dx/dt = (a + size) x + d, one of the blocks that the bound is over."""
    size, system = 0.5, scalar()
    a = -1.0 + size
    worst = np.sqrt((1 - np.exp(4 * a)) / (-2 * a))
    closed = system.closed(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.array([[size]]))
    assert end_gain(closed) == pytest.approx(worst, rel=1e-6)
    for first in (0.3, 1.0, 3.0):
        assert not shows(system, 0.999 * worst, np.diag([first, 0.01]), size=size)


@pytest.mark.campaign
def test_the_bound_of_a_scalar_is_close():
    system = scalar()
    found = robust_gain(system, size=0.5, pole=1.0)
    worst = np.sqrt(1 - np.exp(-2.0))
    assert worst < found.upper < 1.1 * worst


def test_gain_of_the_published_arm(published):
    """LTVTools, demo/TwoLinkRobotArm/twoLinkRobot_LQR.m: 0.05509 expected, by ode23s to 5e-3."""
    agrees(
        end_gain(published),
        0.05509,
        within=5e-3,
        of="robust_gain",
        what="gain of a two-link arm in its loop",
        source="LTVTools (Seiler et al. 2019), twoLinkRobot_LQR.m",
        kind="other program",
    )


def test_robust_gain_of_the_published_arm(published):
    """The same file: 0.062 expected for a block of 0.8, and about 0.0575 for the worst of 100 random blocks."""
    unit = end_gain(published) ** 2
    assert shows(published, 0.059, X * unit, size=0.8)
    assert not shows(published, 0.0575, X * unit, size=0.8)


def test_a_block_of_first_order_stays_within(published):
    lead, b, a = WORST
    block = np.array([[-a]]), np.array([[1.0]]), np.array([[b - lead * a]]), np.array([[lead]])
    assert end_gain(published) < end_gain(published.closed(*block)) < 0.059


def test_what_is_no_multiplier(published):
    with pytest.raises(ValueError, match="positive definite"):
        shows(published, 0.06, -np.eye(2), size=0.8)
    with pytest.raises(ValueError, match="size"):
        robust_gain(published, size=-1.0)
