"""Gyros, accelerometers and the base's reaction, from what the machine does otherwise."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Joint, TreeBody

ALL = ("gyro", "accelerometer", "reaction")


def random_state(tree, seed):
    rng = np.random.default_rng(seed)
    n, m = len(tree.coordinates), len(tree.moving)
    x = np.r_[rng.uniform(-1, 1, m), 0.01 * rng.uniform(-1, 1, n - m), rng.uniform(-1, 1, n)]
    return x, rng.uniform(-1, 1, tree.nu), rng.uniform(-1, 1, tree.nw)


def by_name(tree, y):
    return dict(zip((s.name for s in tree.outputs), y, strict=True))


@pytest.mark.parametrize("kinematics", ["linear", "stiffened"])
def test_accelerometers_read_the_acceleration_less_gravity(space, kinematics):
    """Its length is that of d2p/dt2 - g of the place, from the outputs' positions."""
    tree = space(kinematics, devices=ALL)
    x, u, w = tree.symbols[1:4]
    rate, y = tree.expressions
    names = [s.name for s in tree.outputs]
    at = [names.index(f"{place}_x_rate") for place in tree.places]
    speeds = ca.vertcat(*[y[i : i + 3] for i in at])
    second = ca.Function("f", [x, u, w], [ca.jtimes(speeds, x, rate)])
    given = random_state(tree, 0)
    a = np.array(second(*given)).reshape(-1, 3) - np.array(tree.gravity)
    read = by_name(tree, tree.measure(given[0], given[1], w=given[2]))
    for place, wanted in zip(tree.places, a, strict=True):
        own = np.array([read[f"{place}_accelerometer_{axis}"] for axis in "xyz"])
        np.testing.assert_allclose(np.linalg.norm(own), np.linalg.norm(wanted), rtol=1e-9)


def test_the_reaction_is_what_a_base_that_is_held_takes(space):
    """Six joints below the base whose motion is given and that stand still: r - M a of theirs is what holds them."""
    tree = space(devices=("reaction",))
    held = [
        TreeBody(name=f"h{k}", joint=Joint(name=f"h{k}", kind=kind, axis=axis, drive="acceleration"))
        for k, (kind, axis) in enumerate((kind, tuple(e)) for kind in ("prismatic", "revolute") for e in np.eye(3))
    ]
    roots = tuple(dataclasses.replace(b, parent="h5") if b.parent == "base" else b for b in tree.bodies)
    below = dataclasses.replace(tree, bodies=(*held, *roots), devices=())
    x, u, w = random_state(tree, 1)
    n = len(tree.coordinates)
    still = np.zeros(6)
    x6, u6 = np.r_[still, x[:n], still, x[n:]], np.r_[still, u]
    t, xs, us, ws, _ = below.symbols
    M, r, _, _ = below.equations(t, xs, us, ws)
    values = ca.Function("f", [xs, us, ws], [(r - M @ below.expressions[0][n + 6 :])[:6]])
    wanted = np.array(values(x6, u6, w)).ravel()
    own = tree.measure(x, u, w=w)[-6:]
    np.testing.assert_allclose(own, wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())


def test_at_rest_the_base_carries_the_weight(space):
    tree = space("rigid", devices=ALL, loads=())
    x0, u0 = tree.equilibrium(j1=0.3, j2=-0.4, j3=0.1, j4=0.2)
    read = by_name(tree, tree.measure(x0, u0))
    mass = sum(b.mass + (b.beam.mass if b.beam else 0.0) for b in tree.bodies) + tree.payload.mass
    np.testing.assert_allclose([read[f"base_force_{a}"] for a in "xyz"], [0, 0, -9.81 * mass], atol=1e-9)
    felt = np.linalg.norm([read[f"tip_accelerometer_{a}"] for a in "xyz"])
    np.testing.assert_allclose(felt, 9.81, rtol=1e-12)
    assert all(read[f"middle_gyro_{a}"] == 0 for a in "xyz")


def test_gyros_read_the_turn(space):
    tree = space("rigid", devices=("gyro",))
    x = np.zeros(8)
    x[4] = 2.0  # about z of the base
    read = by_name(tree, tree.measure(x))
    np.testing.assert_allclose([read[f"middle_gyro_{a}"] for a in "xyz"], [0, 0, 2.0], atol=1e-15)
    assert ("gyro", "tip_gyro_x") in [(s.device, s.signal) for s in tree.sensors()]


def test_refused(space):
    with pytest.raises(ValueError, match=r"FlexibleTree\.devices\[0\] = 'lidar': no such device; choose from orient"):
        space(devices=("lidar",))
