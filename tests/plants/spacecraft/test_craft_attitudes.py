"""A spacecraft's linear model in signals against the rates of those signals on the nonlinear plant."""

import dataclasses

import numpy as np
import pytest

from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.environment import Environment, Orbit

CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear", translation=False)
ORBITING = dataclasses.replace(CRAFT, environment=Environment(orbit=Orbit(rate=1e-3)))


def standing(craft):
    """At rest in reference axes, turned by 60 degrees about an axis; the attitude of an orbit is no equilibrium."""
    axis = np.array([0.6, 0.0, 0.8])
    x = craft.state(dict(zip([f"quaternion_{k}" for k in range(4)], [np.cos(np.pi / 6), *(0.5 * axis)])))
    if craft.environment.orbit is not None:
        x[craft.layout.omega] = craft.turn(x).T @ [0.0, -1e-3, 0.0]
    return x


@pytest.mark.parametrize("craft", [CRAFT, ORBITING], ids=["free", "orbit"])
def test_equals_the_rates_of_the_signals(craft):
    """dz/dt = A dz + B du for z the model's states, from central differences along the plant's own rates."""
    x0, u = standing(craft), np.zeros(3)
    model = craft.feedback_model(x0)
    known = [s.name for s in craft.states + craft.outputs]
    picks = [known.index(s.name) for s in model.states]

    def signals(x):
        return np.concatenate([x, craft.measure(x)])[picks]

    def rates(x, u):
        h, dx = 1e-3, craft.dynamics(x, u)
        return (signals(x + h * dx) - signals(x - h * dx)) / (2 * h)

    np.testing.assert_allclose(model.x0, signals(x0), atol=1e-14)
    rng, scale = np.random.default_rng(0), np.abs(model.A).max()
    for _ in range(10):
        step = 1e-6 * rng.normal(size=craft.nx)
        both = [craft.consistent(x0 + sign * step) for sign in (1, -1)]
        dz, dr = (f(both[0]) - f(both[1]) for f in (signals, lambda x: rates(x, u)))
        np.testing.assert_allclose(model.A @ dz, dr, atol=1e-6 * scale * np.abs(dz).max())
    push = rng.normal(size=3)
    np.testing.assert_allclose(model.B @ push, (rates(x0, push) - rates(x0, -push)) / 2, atol=1e-9)
    own = np.sort_complex(np.round(craft.linearize(x0).eigenvalues, 9))
    apart = own[np.abs(own) > 1e-2]
    assert max(np.abs(model.eigenvalues - z).min() for z in apart) < 1e-8


def test_a_steady_spin_has_no_attitude_to_feed_back():
    model = CRAFT.feedback_model(CRAFT.state(rate_z=0.1))
    assert len(model.states) == CRAFT.nx - 4
    assert not any(s.name.startswith("attitude") for s in model.states + model.outputs)
    assert np.abs(model.f0).max() < 1e-12
    with pytest.raises(ValueError, match=r"turns at x0 .* and the rest feels it"):
        ORBITING.feedback_model(ORBITING.state(rate_z=0.1))


def test_consistent_states_have_a_unit_quaternion():
    at, x = CRAFT.layout.quaternion, np.zeros((3, CRAFT.nx))
    x[1, at], x[2, at] = [2.0, 0.0, 0.0, 0.0], [3.0, 0.0, -4.0, 0.0]
    x[:, at.stop :] = 0.3
    found = CRAFT.consistent(x)
    np.testing.assert_allclose(found[:, at], [[1, 0, 0, 0], [1, 0, 0, 0], [0.6, 0, -0.8, 0]], atol=1e-15)
    np.testing.assert_array_equal(found[:, at.stop :], x[:, at.stop :])
    assert not x[0, at].any()
