"""Articulated bodies against the mass matrix, factored dense with pivoting by another program (LAPACK)."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from random_trees import random_tree

from pliant.plants import Beam, ElasticJoint, FlexibleTree, Frame, Joint, ModalData, Payload, TreeBody
from pliant.plants.multibody import tree_dynamics
from pliant.plants.multibody_joints.freedoms import ends
from pliant.plants.multibody_recursion.articulated import Articulated
from pliant.plants.multibody_recursion.composite import mass_matrix

BOOM = Beam(length=3.0, area=8e-5, I_y=1e-10, I_z=2.7e-9, J=4e-10, density=2700.0, E=70e9, G=26e9)
PANEL = ModalData.from_participation(
    mass=4.0,
    centre=(1.5, 0.0, 0.1),
    inertia=((0.5, 0.0, 0.0), (0.0, 13.0, 0.0), (0.0, 0.0, 13.0)),
    frequencies=(2.0, 5.0),
    damping=(0.01, 0.01),
    L_translation=((0.0, 0.0, 1.2), (0.0, 0.9, 0.0)),
    L_rotation=((0.0, -2.4, 0.0), (0.0, 0.0, 1.6)),
)
PLATFORM = Payload(mass=500.0, inertia=200.0, offset=(0.1, 0.0, 0.05))


def star(**options):
    """Hinged booms, one of them with a ball at its end, and a panel on a body."""
    made = [
        TreeBody(
            name=f"b{k}",
            parent="base",
            joint=Joint(name=f"j{k}", position=(k, 1.0, 0.1)),
            beam=BOOM,
            modes=(1, 1, 1, 0),
        )
        for k in range(3)
    ]
    ball = Joint(name="ball", kind="spherical", station=1.0)
    made.append(TreeBody(name="end", parent="b1", joint=ball, mass=1.0, centre=(0.1, 0.0, 0.0), inertia=0.1))
    made.append(TreeBody(name="panel", parent="base", joint=Joint(name="axle", axis=(0.6, 0.0, 0.8)), modal=PANEL))
    sled = Joint(name="sled", kind="planar", axis=(0.0, 0.6, 0.8), position=(0.0, 0.0, 1.0))
    made.append(TreeBody(name="sledge", parent="base", joint=sled, mass=2.0, centre=(0.0, 0.3, 0.0), inertia=0.2))
    return FlexibleTree(bodies=tuple(made), **{"base": "free", "platform": PLATFORM, "tip": "end", **options})


def chain(n: int = 12) -> FlexibleTree:
    """Rigid links about z and y in turn; the second joint has armature."""
    bodies = [
        TreeBody(
            name=f"b{k}",
            joint=Joint(
                name=f"j{k}", axis=((0, 0, 1), (0, 1, 0))[k % 2], position=(float(k > 0), 0, 0), armature=0.2 * (k == 1)
            ),
            mass=1.0,
            centre=(0.5, 0.0, 0.02),
            inertia=((0.01, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)),
        )
        for k in range(n)
    ]
    return FlexibleTree.serial(bodies)


def compared(tree: FlexibleTree, given: tuple[int, ...] = (), seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """(a by articulated bodies, a by M^-1), those `given` as they are."""
    rng = np.random.default_rng(seed)
    inner = tree._walk(*(ca.SX.sym(c, k) for c, k in (("q", len(tree.coordinates)), ("v", len(tree.speeds)))))
    n = inner.v.shape[0]
    r, told = ca.SX.sym("r", n), ca.SX.sym("given", len(given))
    armature = {slot.v: ca.SX(slot.joint.armature) for slot in tree.slots}
    own = Articulated(inner, r, armature, dict(zip(given, ca.vertsplit(told) if given else (), strict=True)))
    M = mass_matrix(inner)
    for k, more in armature.items():
        M[k, k] += more
    q, v = ca.symvar(inner.q), ca.symvar(inner.v)
    found = ca.Function("f", [ca.vertcat(*q), ca.vertcat(*v), r, told], [own.accelerations(), ca.densify(M)])
    x = np.where(np.arange(len(q)) < ends(tree.slots)[0], 1.0, 0.01) * rng.standard_normal(len(q))
    for slot in tree.slots:
        if slot.turn is not None:
            at = slot.turn[0]
            x[at : at + 4] = rng.standard_normal(4)
            x[at : at + 4] /= np.linalg.norm(x[at : at + 4])
    force, known = rng.standard_normal(n), rng.standard_normal(len(given))
    a, M = (np.array(e) for e in found(x, np.zeros(n), force, known))
    free = [k for k in range(n) if k not in given]
    want = np.zeros(n)
    want[list(given)] = known
    want[free] = np.linalg.solve(M[np.ix_(free, free)], force[free] - M[np.ix_(free, given)] @ known)
    assert ca.Function("p", [ca.vertcat(*q)], [ca.mmin(ca.vertcat(*own.pivots))])(x) > 0
    return a.ravel(), want


@pytest.mark.parametrize("kinematics", ["rigid", "linear", "stiffened", "strain"])
def test_beams_that_carry_others(space, kinematics) -> None:
    found, want = compared(space(kinematics))
    np.testing.assert_allclose(found, want, rtol=0, atol=1e-10 * np.abs(want).max())


@pytest.mark.parametrize("seed", range(6))
def test_any_tree(seed) -> None:
    found, want = compared(random_tree(seed, bodies=6), seed=seed)
    np.testing.assert_allclose(found, want, rtol=0, atol=1e-10 * np.abs(want).max())


@pytest.mark.parametrize(("options", "given"), [({}, ()), ({}, (6, 9)), ({"base": "driven"}, tuple(range(6)))])
def test_joints_and_bodies_of_every_kind(options, given) -> None:
    found, want = compared(star(**options), given)
    np.testing.assert_allclose(found, want, rtol=0, atol=1e-10 * np.abs(want).max())


def test_a_long_chain_with_armature() -> None:
    found, want = compared(chain())
    np.testing.assert_allclose(found, want, rtol=0, atol=1e-10 * np.abs(want).max())


def test_a_tree_with_motors_is_solved_the_same_both_ways(monkeypatch) -> None:
    """Of a plant: from `dynamics`, small trees by M = L D L^T, large ones so."""
    gear = ElasticJoint(stiffness=900.0, damping=0.2, ratio=60.0, rotor_inertia=1e-4)
    tree = star(base="fixed")
    geared = dataclasses.replace(tree.bodies[0], joint=dataclasses.replace(tree.bodies[0].joint, elastic=gear))
    tree = dataclasses.replace(tree, bodies=(geared, *tree.bodies[1:]))
    x = np.random.default_rng(0).uniform(-0.1, 0.1, tree.nx)
    found = []
    for least in (10_000, 0):
        monkeypatch.setattr(tree_dynamics, "ARTICULATED", least)
        own = dataclasses.replace(tree, frames=(Frame(name=f"f{least}", body="end"),))  # equal plants share
        first = own.turns[0][1]
        x[first : first + 4] = (0.5, 0.5, -0.5, 0.5)
        found.append(own.dynamics(x, np.arange(float(own.nu)), w=np.arange(float(own.nw))))
    np.testing.assert_allclose(*found, rtol=0, atol=1e-10 * np.abs(found[0]).max())
