"""Equations are those of the energies; forces at rest are weights; wrenches work as positions change."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Beam, ElasticJoint, FlexibleTree, Joint, LagrangianPlant, Payload, TreeBody, beams
from pliant.plants.multibody_recursion.kinematics import weight_energy
from pliant.plants.multibody_recursion.newton_euler import forces, work

STRIP = Beam.rectangular(0.8, width=0.03, depth=0.01, material=beams.ALUMINIUM)


def test_weight(space):
    tree = space("linear")
    n = len(tree.coordinates)
    q, still = ca.SX.sym("q", n), ca.SX.zeros(n)
    g = ca.SX(ca.DM([1.0, -2.0, 3.0]))
    walk = tree._walk(q, still)
    f = ca.Function("f", [q], [forces(walk, g, {}), ca.gradient(weight_energy(walk, g), q)])
    own, wanted = f(np.r_[np.arange(4.0), 0.01 * np.arange(n - 4)])
    np.testing.assert_allclose(np.array(own), np.array(wanted), atol=1e-12)


def test_a_force_at_a_frame(space):
    """J^T F with J the derivative of the frame's place."""
    tree = space()
    x = 0.01 * np.arange(tree.nx)
    symbols = tree.symbols
    n = len(tree.coordinates)
    q, v = symbols[1][:n], symbols[1][n:]
    names = [s.name for s in tree.outputs]
    for place, at in (("tip", 0), ("middle", 6)):
        w = ca.SX.zeros(tree.nw)
        w[at : at + 3] = ca.SX(ca.DM([1.0, 2.0, 3.0]))
        Q = tree.generalized_force(symbols[0], q, v, ca.SX.zeros(tree.nu), w)
        row = names.index(f"{place}_x")
        position = tree.expressions[1][row : row + 3]
        wanted = ca.jtimes(position, q, ca.SX(ca.DM([1.0, 2.0, 3.0])), True)
        own, other = ca.Function("f", [symbols[1]], [Q, wanted])(x)
        np.testing.assert_allclose(np.array(own), np.array(other), atol=1e-12)


def test_nothing_works_without_wrenches(space):
    tree = space("rigid")
    walk = tree._walk(ca.SX.sym("q", 4), ca.SX.zeros(4))
    assert work(walk, {}).is_zero()


@pytest.mark.parametrize("kinematics", ["linear", "stiffened"])
def test_equations_are_those_of_the_energies(space, kinematics):
    """Recursion against Lagrange's equations of the energies, T = v'Mv/2 of the recursion's own M."""
    matches_energies(space(kinematics), np.random.default_rng(4))


def matches_energies(tree, rng):
    """M and r at random states, relative to the largest."""
    symbols = tree.symbols[:4]
    found = ca.Function("found", list(symbols), list(tree.equations(*symbols)[:2]))
    wanted = ca.Function("wanted", list(symbols), list(LagrangianPlant.equations.__wrapped__(tree, *symbols)[:2]))
    n, m = len(tree.coordinates), len(tree.moving)
    for _ in range(2):
        x = np.r_[rng.uniform(-2, 2, m), 0.02 * rng.uniform(-1, 1, n - m), rng.uniform(-2, 2, n)]
        given = (0.0, x, rng.uniform(-1, 1, tree.nu), rng.uniform(-1, 1, tree.nw))
        for a, b in zip(found(*given), wanted(*given), strict=True):
            np.testing.assert_allclose(np.array(a), np.array(b), rtol=0, atol=1e-11 * np.abs(np.array(b)).max())


@pytest.mark.parametrize("seed", range(4))
def test_random_trees_have_the_equations_of_their_energies(seed):
    """Any parents, joints, welds, stations and beams."""
    rng = np.random.default_rng(seed)
    names, bodies = ["base"], []
    for k in range(5):
        kind = ("revolute", "prismatic", "fixed", "revolute")[rng.integers(4)] if k else "revolute"
        axis = rng.normal(size=3)
        joint = Joint(
            name=f"j{k}",
            kind=kind,
            axis=tuple(axis / np.linalg.norm(axis)) if rng.integers(2) else (0.0, -1.0, 0.0),
            position=tuple(0.3 * rng.normal(size=3)),
            rotation=tuple(rng.uniform(-2, 2, 3)),
            station=float(rng.choice([0.4, 1.0])),
            turned=bool(rng.integers(2)),
        )
        beam, modes = (STRIP, None)[rng.integers(2)], tuple(int(n) for n in rng.integers(0, 3, 4))
        made = {"mass": 0.5, "centre": tuple(0.2 * rng.normal(size=3)), "inertia": 0.02, "beam": beam, "modes": modes}
        bodies.append(TreeBody(name=f"b{k}", joint=joint, parent=names[rng.integers(len(names))], **made))
        names.append(f"b{k}")
    load = Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.04, 0.0))
    options = {"kinematics": ("linear", "stiffened")[seed % 2], "tip": names[rng.integers(1, 6)]}
    matches_energies(FlexibleTree(bodies=tuple(bodies), payload=load, **options), rng)


def test_power_is_the_rate_of_energy(space):
    """dE/dt = power put in less power lost, exactly: with springs, friction, damping, motors and loads."""
    tree = space()
    gear = ElasticJoint(stiffness=200.0, damping=0.3, ratio=20.0, rotor_inertia=1e-4, rotor_friction=1e-3)
    joints = [
        {"elastic": gear, "damping": 0.1},
        {"friction": 0.2, "stiffness": 3.0, "rest": 0.4},
        {"drive": "acceleration"},
        {"drive": "none", "armature": 0.01},
    ]
    bodies = tuple(
        dataclasses.replace(
            b,
            joint=dataclasses.replace(b.joint, **changes),
            beam=b.beam and dataclasses.replace(b.beam, damping=1e-3),
        )
        for b, changes in zip(tree.bodies, joints, strict=True)
    )
    tree = dataclasses.replace(tree, bodies=bodies)
    t, x, u, w, _ = tree.symbols
    _, _, T, V = tree.equations(t, x, u, w)
    rate = ca.jtimes(T + V, x, tree.expressions[0])
    balance = ca.Function("balance", [x, u, w], [rate - tree.net_power(), rate])
    rng = np.random.default_rng(5)
    for _ in range(3):
        n = len(tree.coordinates)
        x0 = np.r_[rng.uniform(-1, 1, 5), 0.01 * rng.uniform(-1, 1, n - 5), rng.uniform(-1, 1, n)]
        lacking, rate_there = balance(x0, rng.uniform(-1, 1, tree.nu), rng.uniform(-1, 1, tree.nw))
        T0 = tree.kinetic(x0)
        speeds = np.abs(tree.dynamics(x0)).max()
        assert abs(float(lacking)) < 1e-12 * max(1.0, T0) * speeds
        assert abs(float(rate_there)) > 1e-6
