"""Springs, stops, damping and friction of every kind of joint: their work is the energy they take and lose."""

import casadi as ca
import numpy as np
import pytest
from moved_states import moved

from pliant.plants import FlexibleTree, Joint, TreeBody
from pliant.plants.core.quaternions import quaternion


def test_power_is_the_rate_of_energy(held):
    t, x, u, w, _ = held.symbols
    _, _, T, V = held.equations(t, x, u, w)
    balance = ca.Function("b", [x, u, w], [ca.jtimes(T + V, x, held.expressions[0]) - held.net_power(), V])
    rng = np.random.default_rng(1)
    for seed in range(3):
        lacking, V0 = balance(moved(held, seed), rng.uniform(-1, 1, held.nu), rng.uniform(-1, 1, held.nw))
        assert abs(float(lacking)) < 1e-12 * max(1.0, abs(float(V0))) * 100
    assert abs(float(balance(held.rest_state, np.zeros(held.nu), np.zeros(held.nw))[1])) < 1e-15


@pytest.mark.parametrize("seconds", [1, pytest.param(20, marks=pytest.mark.campaign)])
def test_energy_balance(held, seconds):
    """Audited by the integrator over the motion, stops struck."""
    push = np.linspace(0.5, 1.0, held.nu)
    t = np.linspace(0, seconds, 4 * seconds + 1)
    motion = held.simulate(held.rest_state, lambda t: push * np.sin(2 * t), t, rtol=1e-11, atol=1e-13, audit=True)
    assert motion.stats["energy_balance"] < 1e-9


def ball(**changes):
    joint = Joint(name="j", kind="spherical", **changes)
    return FlexibleTree.serial([TreeBody(name="a", joint=joint, mass=1.0, inertia=0.5)], gravity=(0, 0, 0))


def turned(tree, vector):
    x = tree.rest_state
    x[:4] = quaternion(vector)
    return x


def test_a_turn_in_space_is_sprung_by_its_sine():
    """k sin(theta) about the axis of the turn, the same of q and -q."""
    tree, turn = ball(stiffness=3.0), np.array([0.3, -0.5, 0.4])
    angle = np.linalg.norm(turn)
    wanted = -3.0 * np.sin(angle) * turn / angle / 0.5
    x = turned(tree, turn)
    np.testing.assert_allclose(tree.dynamics(x)[4:], wanted, rtol=1e-12)
    x[:4] *= -1
    np.testing.assert_allclose(tree.dynamics(x)[4:], wanted, rtol=1e-12)
    np.testing.assert_allclose(tree.potential(x), 3.0 * (1 - np.cos(angle)), rtol=1e-12)


def test_a_turn_in_space_is_stopped():
    """k z dz/dtheta = k z sin(theta)/sin(upper) with z = (cos(upper) - cos(theta))/sin(upper), far from its rounded
    corner; far within the limit nothing.
    """
    tree = ball(stop_stiffness=1e4, stop_width=1e-4, upper=0.8)
    axis = np.array([0.6, 0.0, 0.8])
    torque = -0.5 * tree.dynamics(turned(tree, 0.85 * axis))[4:] @ axis
    z = (np.cos(0.8) - np.cos(0.85)) / np.sin(0.8)
    np.testing.assert_allclose(torque, 1e4 * z * np.sin(0.85) / np.sin(0.8), rtol=1e-8)
    assert np.abs(tree.dynamics(turned(tree, 0.5 * axis))[4:]).max() < 1e-3


def test_dry_friction_is_along_the_motion():
    tree = ball(friction=2.0, friction_rate=1e-6)
    x = tree.rest_state
    x[4:] = [0.3, 0.4, 0.0]
    np.testing.assert_allclose(tree.dynamics(x)[4:], [-2.0 * 0.6 / 0.5, -2.0 * 0.8 / 0.5, 0.0], rtol=1e-9)
