"""Wheels and thrusters on bodies of a tree: a spacecraft's, a thrust at the end of a bent beam, refusals."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import (
    Beam,
    FlexibleSpacecraft,
    FlexibleTree,
    Frame,
    FrameThruster,
    Hub,
    Joint,
    Payload,
    Thruster,
    TreeBody,
    Wheel,
    beams,
)

STRIP = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.ALUMINIUM)
MOMENTS, AXES, FRICTION = (0.5, 0.7), ((0.0, 0.0, 1.0), (0.6, 0.8, 0.0)), 0.1
NOZZLE, ALONG = (0.3, 0.2, 0.1), (0.0, 0.6, 0.8)


def across(J, axis):
    """What a thin disc adds to its hub's inertia but about its axis."""
    return J / 2 * (np.eye(3) - np.outer(axis, axis))


def test_equal_those_of_a_spacecraft():
    """Wheels spin and are torqued, a thruster fires, booms are bent: every acceleration."""
    bare = np.diag([200.0, 150.0, 180.0])
    whole = bare + sum(across(J, axis) for J, axis in zip(MOMENTS, AXES, strict=True))
    wheels = tuple(Wheel(axis=axis, inertia=J, friction=FRICTION) for J, axis in zip(MOMENTS, AXES, strict=True))
    nozzle = (Thruster(position=NOZZLE, direction=ALONG),)
    hub = Hub(mass=500.0, inertia=tuple(map(tuple, whole)), wheels=wheels, thrusters=nozzle)
    craft = dataclasses.replace(FlexibleSpacecraft.textbook(), hub=hub)
    bodies = [
        TreeBody.wheel(f"w{k}", "hub", inertia=J, axis=axis, friction=FRICTION)
        for k, (J, axis) in enumerate(zip(MOMENTS, AXES, strict=True))
    ]
    for k, a in enumerate(craft.appendages):
        joint = Joint(name=f"mount{k}", kind="fixed", position=a.position, rotation=(0, 0, np.pi * k))
        bodies.append(TreeBody(name=f"boom{k}", parent="hub", joint=joint, modal=a.data))
    platform = Payload(mass=500.0, inertia=tuple(map(tuple, bare)))
    tree = FlexibleTree(
        bodies=tuple(bodies), base="free", root="hub", platform=platform, gravity=(0, 0, 0), tip="hub",
        frames=(Frame(name="nozzle", body="hub", position=NOZZLE),),
        thrusters=(FrameThruster(frame="nozzle", direction=ALONG),),
    )  # fmt: skip
    rng, x, z = np.random.default_rng(0), craft.state(), tree.state()
    q, eta, omega, rate, spin = rng.normal(size=4), 0.05 * rng.normal(size=6), *(rng.normal(size=m) for m in (3, 6, 2))
    q = q / np.linalg.norm(q)
    x[3:7], x[7:13], x[16:19], x[19:25] = q, eta, omega, rate
    x[25:] = [J * (s + np.dot(axis, omega)) for J, axis, s in zip(MOMENTS, AXES, spin, strict=True)]
    z[3:7], z[9:15], z[18:21], z[21:23], z[23:] = q, eta, omega, spin, rate
    given = craft.dynamics(x, [0.3, -0.2, 4.0])  # torques on the hub
    own = tree.dynamics(z, [-0.3, 0.2, 4.0])  # on the wheels
    size = np.abs(given).max()
    np.testing.assert_allclose(own[15:21], given[13:19], rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(own[23:], given[19:25], rtol=0, atol=1e-12 * size)
    momenta = [
        J * (own[21 + k] + np.dot(axis, own[18:21])) for k, (J, axis) in enumerate(zip(MOMENTS, AXES, strict=True))
    ]
    np.testing.assert_allclose(momenta, given[25:], rtol=0, atol=1e-12 * size)


def test_a_thrust_at_the_end_of_a_beam_is_a_force_there():
    """In the frame's axes: the disturbance of the same force, turned as the end has."""
    body = TreeBody(name="b", joint=Joint(name="j"), beam=STRIP, modes=(2, 1, 1, 0))
    tree = FlexibleTree.serial(
        [body], kinematics="strain", frames=(Frame(name="end", body="b"),), devices=("accelerometer",),
        thrusters=(FrameThruster(frame="end", direction=(0, 0, 1)),),
    )  # fmt: skip
    assert [s.name for s in tree.inputs] == ["j_torque", "end_thrust"]
    x = np.r_[0.4, 0.1, 0.03, 0.05, 0.2, np.zeros(5)]
    E = tree.jacobians(x, [0.0, 0.0])[2][5:, :3]
    B = tree.jacobians(x, [0.0, 0.0])[1][5:, 1]
    along = np.linalg.lstsq(E, B, rcond=None)[0]  # the direction in the base's axes
    np.testing.assert_allclose(E @ along, B, atol=1e-10 * np.abs(B).max())
    np.testing.assert_allclose(np.linalg.norm(along), 1.0, rtol=1e-9)
    assert abs(along[2]) < 1.0


def test_work_of_a_thrust_is_energy():
    """Of a beam that a thrust swings and bends."""
    soft = Beam.rectangular(1.0, 0.03, 0.02, beams.Material(density=2700.0, E=4e8, G=1.6e8))
    tree = FlexibleTree.serial(
        [TreeBody(name="b", joint=Joint(name="j"), beam=soft, modes=(1, 1, 1, 0))], gravity=(0, 0, 0),
        frames=(Frame(name="end", body="b"),), thrusters=(FrameThruster(frame="end", direction=(0, 0.8, 0.6)),),
    )  # fmt: skip
    motion = tree.simulate(
        np.zeros(8), lambda t: np.array([0.0, np.sin(5 * t)]), np.linspace(0, 1, 6), rtol=1e-10, audit=True
    )
    assert motion.stats["energy_balance"] < 1e-9


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            {"thrusters": (FrameThruster(frame="nose", direction=(1, 0, 0)),)},
            r"thrusters\[0\]\.frame = 'nose' must be",
        ),
        ({"thrusters": (FrameThruster(frame="tip", direction=(1, 0, 0)),) * 2}, r"thrusters\[1\]\.frame = 'tip'"),
        ({"thrusters": ("tip",)}, r"thrusters\[0\]"),
    ],
)
def test_refused(change, says):
    body = TreeBody(name="b", joint=Joint(name="j"), mass=1.0, inertia=0.1)
    with pytest.raises(ValueError, match=says):
        FlexibleTree.serial([body], **change)
    with pytest.raises(ValueError, match=r"TreeBody\.wheel\.inertia = -1"):
        TreeBody.wheel("w", "hub", inertia=-1)
    with pytest.raises(ValueError, match=r"FrameThruster\.direction"):
        FrameThruster(frame="tip", direction=(0, 0, 0))
