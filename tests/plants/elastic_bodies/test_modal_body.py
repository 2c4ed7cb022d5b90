"""Bodies given by their modes in a tree: FlexibleSpacecraft, the same beam as a beam, bodies on their nodes, energy."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import (
    Beam,
    FlexibleSpacecraft,
    FlexibleTree,
    Frame,
    Joint,
    ModalData,
    Payload,
    TreeBody,
    beams,
)
from pliant.plants.elastic_bodies.modal_body import ModalBody
from pliant.plants.modal_data.modal_fields import ModalNode

BOOM = Beam.rectangular(1.2, 0.03, 0.02, beams.Material(density=2700.0, E=4e8, G=1.6e8, damping=1e-3))
PANEL = ModalData.panel(BOOM, width=0.4, modes=(1, 1))


@pytest.mark.parametrize("kinematics", ["linear", "stiffened"])
def test_equals_flexible_spacecraft(kinematics):
    """Accelerations at a bent state that turns and is pushed; A where the quaternion stays of unit length, B and E."""
    craft = FlexibleSpacecraft.textbook()
    softer = [dataclasses.replace(a, damping=0.02, stiffness_factor=0.7) for a in craft.appendages]
    craft = dataclasses.replace(craft, kinematics=kinematics, appendages=tuple(softer))
    bodies = [
        TreeBody(
            name=f"boom{i}", parent="hub", modal=a.data, damping_ratio=a.damping, stiffness_factor=a.stiffness_factor,
            joint=Joint(name=f"mount{i}", kind="fixed", position=a.position, rotation=(0, 0, np.pi * i)),
        )
        for i, a in enumerate(craft.appendages)
    ]  # fmt: skip
    hub = Payload(mass=craft.hub.mass, inertia=craft.hub.inertia)
    options = {"base": "free", "root": "hub", "platform": hub, "tip": "hub", "gravity": (0, 0, 0)}
    tree = FlexibleTree(bodies=tuple(bodies), kinematics=kinematics, **options)
    rng, x, still = np.random.default_rng(0), craft.state(), np.zeros(craft.nu)
    q = rng.normal(size=4)
    x[:3], x[3:7], x[7:13] = rng.normal(size=3), q / np.linalg.norm(q), 0.05 * rng.normal(size=6)
    x[13:19], x[19:] = rng.normal(size=6), 0.3 * rng.normal(size=6)
    w = np.r_[10 * rng.normal(size=3), np.zeros(3)]  # a force; torques are in the hub's axes there, the base's here
    given = craft.dynamics(x, still, w=w)
    np.testing.assert_allclose(tree.dynamics(x, w=w), given, rtol=0, atol=1e-13 * np.abs(given).max())
    (A, B, E), (own, _, loads) = craft.jacobians(x, still, w=w)[:3], tree.jacobians(x, w=w)[:3]
    along = np.eye(25)
    along[3:7, 3:7] -= np.outer(x[3:7], x[3:7])
    np.testing.assert_allclose(own @ along, A @ along, rtol=0, atol=1e-12 * np.abs(A).max())
    np.testing.assert_allclose(loads[:, :3], E[:, :3], rtol=0, atol=1e-15)
    np.testing.assert_allclose(loads[:, 3:] @ craft.turn(x), B, rtol=0, atol=1e-15)


def test_a_boom_as_modes_is_the_beam_of_these_modes():
    """Of small motions: mass matrix, stiffness and damping of the arm with either; a payload on the node turns too."""
    common = {"gravity": (0, 0, 0), "basis": "clamped-free", "payload": Payload(mass=0.3, inertia=0.02)}
    joint = Joint(name="j")
    beam = FlexibleTree.serial([TreeBody(name="b", joint=joint, beam=BOOM, modes=(2, 2, 0, 0))], **common)
    data = ModalData.boom(BOOM, (2, 2))
    tip = (Frame(name="end", body="b", node="tip"),)
    modal = FlexibleTree.serial([TreeBody(name="b", joint=joint, modal=data)], frames=tip, tip="end", **common)
    order = [0, 3, 4, 1, 2]  # data have bending in x-z first
    at = np.zeros(10)
    np.testing.assert_allclose(modal.mass_matrix(at), beam.mass_matrix(at)[np.ix_(order, order)], rtol=0, atol=1e-12)
    A, B = beam.jacobians(at, [0.0])[0], modal.jacobians(at, [0.0])[0]
    both = [*order, *(5 + k for k in order)]
    np.testing.assert_allclose(B, A[np.ix_(both, both)], rtol=0, atol=1e-9 * np.abs(A).max())


def test_a_section_of_modal_data():
    """Shift and turn at a node from the shapes and turns there, less the shortening; rates by differentiation."""
    rng = np.random.default_rng(3)
    g = rng.normal(size=(2, 2, 3))
    node = ModalNode(
        "n", rng.normal(size=3), rng.normal(size=(2, 3)), rng.normal(size=(2, 3)), g + g.transpose(1, 0, 2)
    )
    body = ModalBody(dataclasses.replace(PANEL, nodes=(node,)), True)
    eta, rate = ca.SX.sym("eta", 2), ca.SX.sym("rate", 2)
    at = body.section("n", eta, rate)
    differentiated = ca.jtimes(at.shift, eta, rate)
    found = ca.Function(
        "f", [eta, rate],
        [at.shift, at.turn, at.shift_rate - differentiated, at.shift_bias - ca.jtimes(differentiated, eta, rate),
         at.T[:3, :] - ca.jacobian(at.shift, eta)],
    )  # fmt: skip
    values = np.array([0.2, -0.3])
    shift, turn, *gaps = (np.array(v) for v in found(values, [0.5, 0.7]))
    wanted = node.position + values @ node.shapes - np.einsum("klc,k,l->c", node.shortening, values, values) / 2
    np.testing.assert_allclose(shift.ravel(), wanted, rtol=1e-14)
    np.testing.assert_allclose(turn.ravel(), values @ node.turns, rtol=1e-14)
    for gap in gaps:
        np.testing.assert_allclose(gap, 0.0, atol=1e-14)


@pytest.mark.parametrize("kinematics", ["linear", "stiffened"])
@pytest.mark.parametrize("seconds", [1, pytest.param(20, marks=pytest.mark.campaign)])
def test_work_done_equals_energy_gained(kinematics, seconds):
    """A panel on a joint, a boom on its corner, a mass on the boom."""
    joint = {"damping": 0.1, "stiffness": 3.0}
    bodies = (
        TreeBody(name="a", joint=Joint(name="j1", axis=(0, 0.6, 0.8), **joint), modal=PANEL, damping_ratio=0.01),
        TreeBody(name="b", joint=Joint(name="j2", axis=(0, 1, 0), node="tip", **joint), modal=ModalData.boom(BOOM)),
    )
    tip = (Frame(name="end", body="b", node="tip"),)
    tree = FlexibleTree.serial(
        bodies, kinematics=kinematics, frames=tip, tip="end", gravity=(0.1, -0.2, -0.3), payload=Payload(mass=0.05)
    )
    t = np.linspace(0, seconds, 4 * seconds + 1)
    motion = tree.simulate(np.zeros(tree.nx), lambda t: 0.2 * np.sin(2 * t) * np.ones(2), t, rtol=1e-10, audit=True)
    assert motion.stats["energy_balance"] < 1e-9
    assert np.ptp(motion["a_deflection_z"]) > 1e-3


def test_rigid_data_and_fewer_modes():
    body = TreeBody(name="a", joint=Joint(name="j"), modal=PANEL)
    assert body.modal_modes == 2
    tree = FlexibleTree.serial([body], frames=(Frame(name="end", body="a", node="tip"),), tip="end")
    assert [s.name for s in tree.coordinates] == ["j", "a_eta1", "a_eta2"]
    rigid = dataclasses.replace(tree, kinematics="rigid")
    np.testing.assert_allclose(rigid.mass_matrix(np.zeros(2)), [[PANEL.inertia[2, 2]]], rtol=1e-14)
    fewer = dataclasses.replace(tree, bodies=(dataclasses.replace(body, modal_modes=1),))
    assert len(fewer.coordinates) == 2
    assert len(rigid.outputs) == len(tree.outputs)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"modal": "panel"}, "TreeBody.modal = 'panel' must be ModalData or None"),
        ({"modal": PANEL, "beam": BOOM}, "must be None where it has a beam"),
        ({"modal": PANEL, "modal_modes": 3}, "TreeBody.modal_modes = 3"),
    ],
)
def test_refused(change, says):
    with pytest.raises(ValueError, match=says):
        TreeBody(name="a", joint=Joint(name="j"), **change)


def test_unknown_nodes_are_refused():
    def hung(**options):
        bodies = [TreeBody(name="a", joint=Joint(name="j"), modal=PANEL)]
        bodies.append(TreeBody(name="b", joint=Joint(name="k", **options), mass=1.0, inertia=0.1))
        return FlexibleTree.serial(bodies)

    with pytest.raises(ValueError, match=r"Joint 'k' on body 'a': ModalData\.node = 'corner' must be one of 'tip'"):
        hung(node="corner")
    with pytest.raises(ValueError, match="has no turns in the modal data of body 'a'"):
        hung()
    assert hung(turned=False).tree.nodes[1].station == ""
