"""A slew about one axis fixed in the body: the rigid spacecraft is brought from rest to rest exactly."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import FlexibleSpacecraft, Wheel
from pliant.plants.spacecraft.eigenaxis import slew

CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="rigid", translation=False)
TIME = 20.0


def turned(axis, angle):
    """The state at rest, turned by `angle` [rad] about a unit axis."""
    q = np.r_[np.cos(angle / 2), np.sin(angle / 2) * np.asarray(axis)]
    return CRAFT.state({f"quaternion_{k}": float(v) for k, v in enumerate(q)})


@pytest.mark.parametrize(
    ("axis", "angle"), [((1.0, 0.0, 0.0), 0.7), ((0.0, 0.6, 0.8), 2.5), ((0.48, -0.6, 0.64), -1.9)]
)
def test_it_ends_where_it_should_at_rest_and_turns_about_one_axis(axis, angle):
    """The final attitude is the quaternion of the turn (Euler's theorem); on the way the rate keeps its direction."""
    torque = slew(CRAFT, CRAFT.state(), turned(axis, angle), TIME)
    motion = CRAFT.simulate(CRAFT.state(), torque, np.linspace(0.0, TIME, 41))
    at = CRAFT.layout
    end, want = motion.x[-1, at.quaternion], turned(axis, angle)[at.quaternion]
    np.testing.assert_allclose(end * np.sign(end @ want), want, atol=1e-8)
    np.testing.assert_allclose(motion.x[-1, at.omega], 0.0, atol=1e-9)
    rates = motion.x[1:-1, at.omega]
    across = rates - np.outer(rates @ axis, axis)
    assert np.abs(across).max() < 1e-8 * np.abs(rates).max() + 1e-10
    assert np.sign(rates[20] @ axis) == np.sign(angle)


def test_the_shorter_way_round_is_taken():
    """A turn by 350 degrees is one by -10: its torque is that of the small turn."""
    far, near = (
        slew(CRAFT, CRAFT.state(), turned((0.0, 0.0, 1.0), a), TIME) for a in (np.deg2rad(350), np.deg2rad(-10))
    )
    np.testing.assert_allclose(far(3.0), near(3.0), atol=1e-9 * np.abs(near(3.0)).max())


PYRAMID = tuple((a / 3**0.5, b / 3**0.5, 1 / 3**0.5) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1)))


def with_wheels(axes, friction=0.0):
    wheels = tuple(Wheel(axis=a, inertia=0.1, friction=friction) for a in axes)
    return dataclasses.replace(CRAFT, hub=dataclasses.replace(CRAFT.hub, wheels=wheels))


@pytest.mark.parametrize("friction", [0.0, 0.02])
@pytest.mark.parametrize("axes", [((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0)), PYRAMID])
def test_wheels_take_up_the_momentum_and_give_it_back(axes, friction):
    """The total momentum stays 0: on the way the wheels hold what the hub has, at the end they rest as it does."""
    craft, axis = with_wheels(axes, friction), np.array([0.48, -0.6, 0.64])
    end = craft.state(dict(zip([f"quaternion_{k}" for k in range(4)], turned(axis, 1.2)[CRAFT.layout.quaternion])))
    motion = craft.simulate(craft.state(), slew(craft, craft.state(), end, TIME), np.linspace(0.0, TIME, 41))
    np.testing.assert_allclose(motion.x[-1], end, atol=1e-7)
    middle = motion.x[20]
    assert np.abs(middle[craft.layout.wheels]).max() > 1.0
    np.testing.assert_allclose(craft.momentum(middle)[1], 0.0, atol=1e-7)


def test_what_it_cannot_do_is_refused():
    craft, end = with_wheels([(0.0, 0.0, 1.0)]), turned((1.0, 0, 0), 0.5)
    for words, begin, to, time in (
        (r"rest_to_rest\.time = -1 must be > 0 \[s\]", craft.state(), craft.state(), -1),  # no torque, once
        (r"rest_to_rest\.end has shape", craft.state(), craft.state()[:-1], TIME),
        (r"rest_to_rest\.begin = None must be an array", None, craft.state(), TIME),
    ):
        with pytest.raises(ValueError, match=words):
            craft.rest_to_rest(begin, to, time)
    with pytest.raises(ValueError, match="inputs that turn it about"):
        slew(craft, craft.state(), np.append(end, 0.0), TIME)
    with pytest.raises(ValueError, match="wheels at rest"):
        slew(craft, craft.state(wheel1_momentum=1.0), np.append(end, 0.0), TIME)
