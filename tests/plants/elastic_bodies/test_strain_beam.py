"""Beams of exact rotations in a tree: the library's planar arms, its large beam in space, stiffened beams, energy."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import (
    Beam,
    FlexibleTree,
    Joint,
    LargeDeflectionBeam,
    Payload,
    SingleLinkArm,
    TreeBody,
    TwoLinkArm,
    beams,
)
from pliant.plants.elastic_bodies.bent_beam import BentBeam
from pliant.plants.elastic_bodies.strain_beam import StrainBeam
from pliant.plants.multibody_parts.spatial import Motion
from pliant.plants.multibody_parts.tree_beam import TreeBeam

OFFSET = Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.04, 0.0))
DOWN = (0.0, -9.81, 0.0)
STRIP = Beam(length=1.0, area=8e-5, I_y=1.2e-9, I_z=6e-10, J=1.4e-9, density=2700.0, E=1.4e9, G=5.2e8, damping=1e-3)
ASIDE = Payload(mass=0.1, inertia=1e-5, offset=(0.0, 0.1, 0.05))
ASLANT = (1.0, -3.0, -9.81)


def agree(arm, tree, bend):
    """Accelerations, A and B at a state bent by half its length, relative to the largest entry; M."""
    rng = np.random.default_rng(1)
    n = len(arm.coordinates)
    size = np.array([1.0 if s.unit == "rad" else bend for s in tree.coordinates])
    x, u = np.r_[size, size] * rng.uniform(-1, 1, 2 * n), rng.uniform(-1, 1, arm.nu)
    given = arm.dynamics(x, u)
    np.testing.assert_allclose(tree.dynamics(x, u), given, rtol=0, atol=1e-12 * np.abs(given).max())
    for a, b in zip(arm.jacobians(x, u)[:2], tree.jacobians(x, u)[:2], strict=True):
        np.testing.assert_allclose(b, a, rtol=0, atol=1e-11 * np.abs(a).max())
    M = arm.mass_matrix(x)
    np.testing.assert_allclose(tree.mass_matrix(x), M, rtol=0, atol=1e-13 * np.abs(M).max())


@pytest.mark.parametrize("basis", ["polynomial", "clamped-free"])
def test_equals_single_link_arm(basis):
    arm = SingleLinkArm.textbook()
    link = dataclasses.replace(arm.link, damping=3e-4)
    arm = dataclasses.replace(
        arm, link=link, kinematics="strain", basis=basis, modes=3, gravity=9.81, payload=OFFSET, hub_friction=0.1
    )
    body = TreeBody(name="link", joint=Joint(name="hub", damping=0.1), inertia=1.3, beam=link, modes=(3, 0, 0, 0))
    tree = FlexibleTree.serial([body], kinematics="strain", basis=basis, gravity=DOWN, payload=OFFSET)
    agree(arm, tree, 0.1 * link.length)


def test_equals_two_link_arm():
    arm = dataclasses.replace(
        TwoLinkArm.textbook(), kinematics="strain", basis="polynomial", modes=(2, 3), hub_inertia=(0.1, 0.02),
        joint_friction=(0.2, 0.1), payload=OFFSET,
    )  # fmt: skip
    first = TreeBody(
        name="one", joint=Joint(name="theta1", damping=0.2), inertia=0.1, beam=arm.link1, modes=(2, 0, 0, 0)
    )
    second = TreeBody(
        name="two", joint=Joint(name="theta2", damping=0.1), mass=arm.joint_mass, inertia=0.02, beam=arm.link2,
        modes=(3, 0, 0, 0),
    )  # fmt: skip
    agree(arm, FlexibleTree.serial([first, second], kinematics="strain", gravity=DOWN, payload=OFFSET), 0.1)


def tip(modes):
    """Where the tip of a cantilever with a payload at its side stands, let go under gravity aslant, (3, 3) [m]."""
    body = TreeBody(name="b", joint=Joint(name="f", kind="fixed"), beam=STRIP, modes=modes)
    tree = FlexibleTree.serial([body], kinematics="strain", gravity=ASLANT, payload=ASIDE)
    motion = tree.simulate(np.zeros(tree.nx), None, [0.0, 0.2, 0.4, 0.5], rtol=1e-8, audit=True)
    assert motion.stats["energy_balance"] < 1e-8
    return np.column_stack([motion[f"tip_{axis}"] for axis in "xyz"])[1:]


# LargeDeflectionBeam(beam=STRIP, payload=ASIDE, gravity=ASLANT, planar=False, modes=4, twists=4), rtol 1e-9: the
# campaign below computes it
LARGE = {0.5: (0.72521724, -0.28994963, -0.5498546)}


@pytest.mark.parametrize(("modes", "within"), [((2, 2, 1, 0), 8e-3), ((3, 3, 2, 0), 1.2e-3), ((4, 4, 3, 0), 1.2e-4)])
def test_tends_to_the_large_beam_in_space(modes, within):
    """Bent by 0.62 of its length in both planes and twisted by the payload; ten times nearer with each shape."""
    np.testing.assert_allclose(tip(modes)[-1], LARGE[0.5], rtol=0, atol=within)


@pytest.mark.campaign
def test_the_large_beam_itself():
    beam = LargeDeflectionBeam(
        beam=STRIP, root="clamped", gravity=ASLANT, payload=ASIDE, kinematics="strain", modes=4, twists=4, planar=False
    )
    motion = beam.simulate(np.zeros(beam.nx), None, [0.0, 0.2, 0.4, 0.5], rtol=1e-8)
    found = np.column_stack([motion[f"tip_{axis}"] for axis in "xyz"])[1:]
    np.testing.assert_allclose(found[-1], LARGE[0.5], rtol=0, atol=1e-6)
    np.testing.assert_allclose(tip((4, 4, 3, 0)), found, rtol=0, atol=1.2e-4)


def test_bends_alike_in_both_planes():
    """A beam turned by a quarter about its axis, with I_y and I_z exchanged, is the same machine, bent in one plane."""
    turned = dataclasses.replace(STRIP, I_y=STRIP.I_z, I_z=STRIP.I_y)
    made = [
        FlexibleTree.serial(
            [TreeBody(name="b", joint=Joint(name="j"), beam=b, beam_rotation=r, modes=m)], kinematics="strain"
        )
        for b, r, m in ((STRIP, (0, 0, 0), (2, 0, 1, 1)), (turned, (np.pi / 2, 0, 0), (0, 2, 1, 1)))
    ]
    q = np.array([0.7, 0.2, -0.05, 0.1, 1e-4])
    sign = np.array([1, -1, -1, 1, 1.0])  # z there is -y here
    given = made[0].dynamics(np.r_[q, q])[5:]
    np.testing.assert_allclose(
        made[1].dynamics(np.r_[sign * q, sign * q])[5:], sign * given, rtol=1e-9, atol=1e-9 * np.abs(given).max()
    )


def test_small_bends_are_the_stiffened_beam():
    """Forces of motion, weight and strain are the same to first order in the bend: the gap falls by 100 where that
    falls by ten. (The sections' turning inertia, which the other leaves out, is made small here.)
    """
    thin = dataclasses.replace(STRIP, I_y=1.2e-15, I_z=6e-16, J=1.4e-15, E=1.4e15, G=5.2e14)
    straight = TreeBeam(thin, (1, 1, 1, 0), "polynomial", True)
    eta, rate, found = ca.SX.sym("eta", 3), ca.SX.sym("rate", 3), []
    motion = Motion(*(ca.SX(ca.DM(v)) for v in np.random.default_rng(0).normal(size=(3, 3))))
    for body in (BentBeam(straight), StrainBeam(straight)):
        load, Q = body.inertial(motion, motion.U, eta, rate)
        at = body.section(0.7, eta, rate)
        found.append(ca.vertcat(*load, Q, body.resistance(eta, rate), at.shift, at.shift_rate, at.turn, at.turn_rate))
    gap = ca.Function("gap", [eta, rate], [found[1] - found[0]])
    v = np.array([0.3, -0.2, 0.1])
    size = [np.abs(np.array(gap(s * v, s * v))).max() for s in (1e-2, 1e-3)]
    assert size[0] < 2e-3
    assert size[0] > 90 * size[1]


def test_end_of_a_beam_bent_to_an_arc():
    """Constant curvature in x-z under an end moment: a circle, and its section turned by the arc's angle."""
    beam = StrainBeam(TreeBeam(STRIP, (0, 1, 0, 0), "polynomial", True))  # phi of one coordinate: xi^2
    eta = ca.SX(ca.DM([0.3]))
    end = beam.section(1.0, eta, ca.SX.zeros(1))
    angle = -float(ca.DM(end.turn[1]))
    p = np.array(ca.DM(ca.densify(end.shift))).ravel()
    np.testing.assert_allclose(p, [np.sin(angle) / angle, 0.0, (1 - np.cos(angle)) / angle], atol=2e-5)
    assert angle > 0.9


def test_twist_follows_the_bends():
    """A beam bent in both planes turns about its axis without twist: c' = a' sin b, by quadrature of its own."""
    beam = StrainBeam(TreeBeam(STRIP, (2, 2, 0, 0), "polynomial", True))
    eta = np.array([0.2, 0.05, -0.15, 0.02])
    end = beam.section(1.0, ca.SX(ca.DM(eta)), ca.SX.zeros(4))
    x, w = np.polynomial.legendre.leggauss(40)
    xi, w = (1 + x) / 2, w / 2
    by, _ = beam.straight.bent_bases
    c = w @ (by.phi(xi, 2) @ eta[:2] * np.sin(-by.phi(xi, 1) @ eta[2:]))
    np.testing.assert_allclose(float(ca.DM(end.turn[0])), c, rtol=1e-3)
    assert abs(c) > 0.02


@pytest.mark.parametrize("seconds", [1, pytest.param(20, marks=pytest.mark.campaign)])
def test_work_done_equals_energy_gained(seconds):
    """Two beams in space bent by a third of their length, a branch half-way along the first, torques at the joints."""
    soft = Beam.rectangular(0.9, 0.03, 0.02, beams.Material(density=2700.0, E=4e7, G=1.6e7, damping=1e-3))
    joint = {"damping": 0.1, "stiffness": 5.0}
    bodies = (
        TreeBody(name="a", joint=Joint(name="j1", axis=(0, 0.6, 0.8), **joint), beam=soft, modes=(1, 1, 1, 1)),
        TreeBody(
            name="b", joint=Joint(name="j2", axis=(0, 1, 0), rotation=(0.3, 0.2, 0.1), **joint), beam=soft,
            modes=(1, 2, 1, 0),
        ),
        TreeBody(
            name="c", parent="a", joint=Joint(name="j3", axis=(1, 0, 0), station=0.5, **joint), mass=0.1, inertia=1e-3,
            centre=(0, 0.1, 0),
        ),
    )  # fmt: skip
    tree = FlexibleTree(bodies=bodies, kinematics="strain", gravity=(0.3, -0.5, -1.0), tip="b")
    t = np.linspace(0, seconds, 4 * seconds + 1)
    motion = tree.simulate(
        np.zeros(tree.nx), lambda t: np.array([0.5, 0.3, 0.1]) * np.sin(2 * t), t, rtol=1e-10, audit=True
    )
    assert motion.stats["energy_balance"] < 1e-9
    deflections = [motion[f"{b}_deflection_{axis}"] for b in "ab" for axis in "yz"]
    assert np.ptp(deflections, axis=1).max() > 0.1
