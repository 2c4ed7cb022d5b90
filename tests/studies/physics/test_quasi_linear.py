"""The motion of a fine model from that of a simple one."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics import quasi_linear
from pliant.studies.physics.fine_model import compared
from pliant.studies.physics.motion_nodes import MotionNodes
from pliant.studies.physics.quasi_linear import CorrectedMotion, NotSettled

SLEW = scenes.get("single-link-slew", duration=0.3, move_time=0.2)


def corrected(motions, fine, simple, nodes, cheap):
    return CorrectedMotion.from_simple(fine, simple, cheap, nodes, motions.start(fine), compared(motions, fine))


def motion(scene, fine, simple, parts):
    motions = Motions(scene)
    nodes = MotionNodes(scene.times, motions.held, parts)
    cheap = motions.at_nodes(simple, nodes.inputs, nodes.all, rtol=1e-10, atol=1e-12)
    return corrected(motions, fine, simple, nodes, cheap), motions.outputs(fine, 1e-11)


def test_it_converges_to_the_simulated_motion_at_order_four():
    """The simulated motion is dop853's, at rtol 1e-11: another method, on the fine model itself."""
    fine = dataclasses.replace(SLEW.plant, kinematics="strain", basis="payload", modes=2)
    errors = []
    for parts in (4, 8, 16):
        found, exact = motion(SLEW, fine, SLEW.plant.ladder()[0], parts)
        found.settle(1e-9)
        errors.append(np.abs(found.outputs - exact).max())
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (rates > 3.5).all() and errors[-1] < 1e-6


def test_passes_shrink_and_the_last_says_what_is_left():
    fine = dataclasses.replace(SLEW.plant, kinematics="strain", basis="payload", modes=2)
    found, _ = motion(SLEW, fine, SLEW.plant.ladder()[0], 2)
    left = found.settle(1e-5)
    once = found.outputs.copy()
    found.settle(1e-9)
    assert np.abs(found.outputs - once).max() <= max(left, 1e-10) and found.changes == sorted(found.changes)[::-1]


def test_one_pass_is_exact_where_the_fine_model_is_linear():
    """A link that does not turn, let go bent in its first mode: a cosine at its natural frequency."""
    scene = scenes.get("spin-up", time=0.4, duration=0.4)
    motions = Motions(scene, np.zeros((len(scene.times), 1)))
    fine = dataclasses.replace(scene.plant, kinematics="linear", modes=2)
    nodes = MotionNodes(scene.times, motions.held, 8)
    rigid = scene.plant.ladder()[0]
    cheap = motions.at_nodes(rigid, nodes.inputs, nodes.all, rtol=1e-10, atol=1e-12)
    found = corrected(motions, fine, rigid, nodes, cheap)
    bent = np.zeros(fine.nx)
    bent[1] = 1e-3
    found._start = bent
    found.step()
    once = found.outputs.copy()
    found.step()
    np.testing.assert_allclose(found.outputs, once, atol=1e-12)
    tip, frequency = fine.elastic.basis.tip[0] * 1e-3, fine.natural_frequencies()[0]
    np.testing.assert_allclose(found.outputs[:, 0], tip * np.cos(frequency * scene.times), atol=1e-6 * abs(tip))


def bent_far(E):
    """A soft link, from the rigid one, as it is embedded: the inputs that crashed `choose` once."""
    own = SLEW.plant
    soft = dataclasses.replace(own, link=dataclasses.replace(own.link, E=E, length=1.2), hub_inertia=0.04)
    scene = scenes.get("single-link-slew", duration=1.2, move_time=0.5).with_plant(soft)
    motions = Motions(scene)
    nodes, rigid = MotionNodes(scene.times, motions.held, 2), soft.ladder()[0]
    found = corrected(motions, soft.physics(), rigid, nodes, motions.at_nodes(rigid, nodes.inputs, nodes.all))
    return found, motions.outputs(soft.physics(), 1e-8) if E > 1e10 else None


def test_a_motion_that_bends_by_half_its_length_settles():
    found, simulated = bent_far(1.5e10)
    found.settle(1e-6)
    np.testing.assert_allclose(found.outputs, simulated, atol=3e-4)  # [m], of 1.2, by two parts a period


def test_a_motion_too_far_away_is_not_settled():
    found, _ = bent_far(6e9)
    with pytest.raises(NotSettled, match=r"settle|runs away|still changes"):
        found.settle(1e-6)


def test_more_nodes_and_more_shapes_go_on_from_what_there_is():
    """To the same motion as from the rigid one, in fewer passes."""
    few, more = (dataclasses.replace(SLEW.plant, kinematics="strain", basis="polynomial", modes=n) for n in (2, 3))
    rough, _ = motion(SLEW, few, SLEW.plant.ladder()[0], 2)
    rough.settle(1e-7)
    anew, _ = motion(SLEW, more, SLEW.plant.ladder()[0], 4)
    motions, nodes = Motions(SLEW), anew.nodes
    on = rough.refined(more, nodes, motions.start(more), compared(motions, more))
    first = np.abs(on.outputs - anew.outputs).max()
    on.settle(1e-7)
    anew.settle(1e-7)
    np.testing.assert_allclose(on.outputs, anew.outputs, atol=1e-7)
    assert on.passes <= anew.passes and first > 10 * on.changes[-1]


def test_a_linear_model_held_too_long_is_noticed_and_one_for_each_part_settles(monkeypatch):
    """Two links that turn by a radian: with one model for all of the motion passes do not shrink at first; more are
    taken then, and what is found is what a simulation by another method gives.
    """
    scene = scenes.get("two-link-reach")
    fine = dataclasses.replace(scene.plant, kinematics="stiffened", basis="polynomial", modes=(3, 3))
    monkeypatch.setattr(quasi_linear, "BLOCKS", 1)
    found, exact = motion(scene, fine, scene.plant.ladder()[0], 4)
    for _ in range(3):
        found.step(anew=found.passes == 0)  # the naive way
    assert found.changes[2] > found.changes[1]
    found, exact = motion(scene, fine, scene.plant.ladder()[0], 4)
    found.settle(1e-7)
    assert found._blocks > 1 and np.abs(found.outputs - exact).max() < 1e-5


def test_a_motion_of_one_part_is_one_step_of_gauss():
    scene = scenes.get("single-link-slew", duration=0.02, move_time=0.02)
    fine = dataclasses.replace(SLEW.plant, kinematics="linear", modes=1)
    found, exact = motion(scene, fine, SLEW.plant.ladder()[0], 1)
    found.settle(1e-10)
    assert len(found.nodes.h) == 1 and np.abs(found.outputs - exact).max() < 1e-4
