"""Which shapes of a tree's beams a motion needs."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import Beam, FlexibleTree, Frame, Joint, TreeBody, beams
from pliant.plants.beams.payload import Payload
from pliant.plants.multibody.sparing import needed

STRIP = Beam.rectangular(1.0, width=0.04, depth=0.01, material=beams.ALUMINIUM)
MASS, ARM, GRAVITY = 0.2, 0.05, 9.81  # [kg], [m] beside the tip, [m/s^2]


def tree(offset=0.0, gravity=(0.0, 0.0, -GRAVITY)):
    """A strip that turns about the vertical, with shapes of all its families."""
    body = TreeBody(name="b", joint=Joint(name="j"), beam=STRIP, modes=(3, 3, 2, 0))
    load = Payload(mass=MASS, offset=(0.0, offset, 0.0))
    return FlexibleTree.serial([body], payload=load, gravity=gravity, kinematics="strain")


def resting(machine):
    x, u = machine.equilibrium(j=0.3)
    return machine.simulate(x, u, np.linspace(0.0, 0.02, 3))


@pytest.mark.parametrize("share", [1.0, 0.01])
def test_a_strip_that_sags_needs_its_upright_plane_alone(share):
    """Sag of the tip under its own weight and the load, w L^4/8 E I + P L^3/3 E I: of a beam in that plane alone."""
    machine = tree()
    weight, L, EI = GRAVITY * STRIP.linear_density, STRIP.length, STRIP.E * STRIP.I_y
    sag = weight * L**4 / (8 * EI) + MASS * GRAVITY * L**3 / (3 * EI)
    found = needed(machine, resting(machine), ("tip_z",), share * sag)
    own = found.bodies[0].modes
    assert own[0] == own[2] == own[3] == 0 and 1 <= own[1] <= 3
    x, _ = found.equilibrium(j=0.3)
    at = [s.name for s in found.outputs].index("tip_z")
    assert found.measure(x)[at] == pytest.approx(-sag, abs=share * sag)


def test_a_point_beside_the_axis_needs_torsion_and_one_on_it_does_not():
    """Of a load beside the axis, which twists the strip by M L / G J."""
    machine = tree(ARM)
    beside = dataclasses.replace(machine, frames=(Frame(name="edge", body="b", position=(0, ARM, 0)),))
    motion = resting(beside)
    twist = MASS * GRAVITY * ARM * STRIP.length / (STRIP.G * STRIP.J)
    down = motion["edge_z"][-1] - motion["tip_z"][-1]
    assert down == pytest.approx(-twist * ARM, rel=0.02)
    on_axis, off_axis = (needed(beside, motion, (name,), twist * ARM).bodies[0].modes for name in ("tip_z", "edge_z"))
    assert on_axis[2] == 0 and off_axis[2] >= 1
    rungs = beside.sparing(motion, ("edge_z",), twist * ARM)
    assert [r.kinematics for r in rungs] == ["linear", "stiffened", "strain"]
    assert {r.bodies[0].modes for r in rungs} == {off_axis}


def test_a_motion_that_bends_nothing_needs_no_rung_that_bends():
    machine = tree(gravity=(0.0, 0.0, 0.0))
    assert machine.sparing(resting(machine), ("tip_x", "tip_z"), 1e-3) == ()
    rigid = dataclasses.replace(machine, kinematics="rigid")
    assert rigid.sparing(resting(rigid), ("tip_x",), 1e-3) == ()
