"""Ranges of appendages against the beams that they are made of, and a body of which only nodes are known."""

import dataclasses
import warnings

import numpy as np
import pytest

from pliant.plants import Appendage, FlexibleSpacecraft, Hinge, ModalData, Trajectory, ValidityWarning, beams
from pliant.plants.spacecraft_perturbation.perturbation import RigidNominal, perturbation
from pliant.plants.validity.ranges import values
from pliant.plants.validity.slender import AXIAL, SLOPE

CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")
BOOM = CRAFT.appendages[0].body
AT_CENTRE = dataclasses.replace(CRAFT, appendages=(Appendage(position=(0.0, 0.0, 0.0), body=BOOM, modes=(0, 1)),))


def reached(plant, **named):
    """{quantity: value} at a state."""
    x = plant.state(named)
    motion = Trajectory.from_arrays([0.0, 1.0], [x, x], plant=plant)
    return dict(zip((r.quantity for r in plant.validity), values(plant, motion)[0], strict=True))


def test_spin_about_the_hub_is_told_by_southwells_coefficient() -> None:
    """A boom from the hub's centre that bends out of the plane of rotation, by `rotating_frequencies`."""
    still, spun = (beams.rotating_frequencies(gamma, 1)[0] for gamma in (0.0, 0.1))
    southwell = (spun**2 - still**2) / 0.1**2
    first = AT_CENTRE.appendages[0].data.frequencies[0]
    name = "stiffening of appendage 1 by spin over its modal stiffness"
    assert reached(AT_CENTRE, rate_z=0.1 * first)[name] == pytest.approx(southwell * 0.01, rel=2e-3)
    assert reached(AT_CENTRE, rate_x=0.1 * first)[name] == pytest.approx(0.0, abs=1e-12)  # about the boom itself
    off = dataclasses.replace(
        AT_CENTRE, appendages=(dataclasses.replace(AT_CENTRE.appendages[0], position=(2.0, 0, 0)),)
    )
    still, spun = (beams.rotating_frequencies(gamma, 1, hub_radius=2.0 / BOOM.length)[0] for gamma in (0.0, 0.1))
    wanted = (spun**2 - still**2) / 0.1**2 * 0.01
    assert reached(off, rate_z=0.1 * first)[name] == pytest.approx(wanted, rel=2e-3)


def test_slopes_are_those_of_the_boom_to_what_its_outline_resolves() -> None:
    data = AT_CENTRE.appendages[0].data
    ratio = beams.basis("clamped-free", 1)
    tip = float(ratio.tip_slope[0] / ratio.tip[0]) / BOOM.length * data.tip_shapes[0, 2]
    found = reached(AT_CENTRE, eta1_1=0.4)
    assert found["slope of appendage 1"] == pytest.approx(0.4 * tip, rel=0.02)
    whole = float(ratio.shortening[0, 0] / ratio.tip[0] ** 2) * (0.4 * data.tip_shapes[0, 2] / BOOM.length) ** 2 / 2
    assert found["shortening of appendage 1 over its length"] == pytest.approx(whole, rel=0.02)


def test_hinges_turn_what_the_spin_does() -> None:
    """A boom that a hinge has turned along the axis of the spin feels none; one that turns at the hinge does."""
    turned = Appendage(
        position=(0.0, 0.0, 0.0), body=BOOM, modes=(0, 1), hinge=Hinge(axes=((0.0, 1.0, 0.0),), damping=1.0)
    )
    craft = dataclasses.replace(AT_CENTRE, appendages=(turned,))
    name, first = "stiffening of appendage 1 by spin over its modal stiffness", turned.data.frequencies[0]
    assert reached(craft, rate_z=0.1 * first, hinge1_1=np.pi / 2)[name] < 1e-12
    own = reached(craft, hinge1_1_rate=0.1 * first)[name]
    assert own == pytest.approx(reached(craft, rate_z=0.1 * first)[name], rel=1e-9)


def test_nodes_alone_are_judged_by_the_lines_between_them() -> None:
    """Two nodes at the same place make no line; the third stands a metre from them and moves by 0.31."""
    nodes = np.array([[1.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]])
    shapes = np.array([[[0, 0, 0.0], [0, 0, 0.0], [0, 0, 1.0]]])
    body = ModalData.from_nodes(nodes, [1.0, 1.0, 1.0], shapes, frequencies=[3.0])
    craft = dataclasses.replace(CRAFT, kinematics="stiffened", appendages=(Appendage(position=(1.0, 0, 0), body=body),))
    assert reached(craft, eta1_1=0.31) == pytest.approx({"slope of appendage 1": 0.31})
    with pytest.warns(ValidityWarning, match="slope of appendage 1 0.31 rad"):
        craft.simulate(craft.state(eta1_1=0.31), None, [0.0, 1e-3])
    assert craft.validity[0].limit == SLOPE


def test_the_papers_model_about_a_fast_spin_is_told_of() -> None:
    """The perturbation model of linear kinematics lacks what a spin of a third of the first frequency adds."""
    first = AT_CENTRE.appendages[0].data.frequencies[0]
    t, still = np.linspace(0.0, 1.0, 3), np.zeros((3, 3))
    spin = np.tile([0.0, 0.0, first / 3], (3, 1))
    turned = np.column_stack([np.cos(first / 6 * t), 0 * t, 0 * t, np.sin(first / 6 * t)])
    empty = (np.zeros((3, 0)),)
    nominal = RigidNominal(t, turned, spin, still, still, empty, empty, empty)
    with pytest.warns(ValidityWarning, match="the nominal leaves the range .* spin over its modal stiffness 0.13"):
        perturbation(AT_CENTRE, nominal)
    stiff = dataclasses.replace(AT_CENTRE, kinematics="stiffened")
    with warnings.catch_warnings():
        warnings.simplefilter("error", ValidityWarning)
        perturbation(stiff, nominal)
    assert AXIAL < 0.05
