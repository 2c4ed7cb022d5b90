"""Ladder, physics and effects of a tree; what it carries."""

import dataclasses

import numpy as np

from pliant.plants import Beam, FlexibleTree, Joint, ModalData, TreeBody, beams
from pliant.plants.multibody.fidelity import EXACT, SHORTENING, STRETCH


def test_ladder(space):
    tree = space()
    rungs = tree.ladder()
    assert [r.label for r in rungs][:2] == ["rigid", "linear, polynomial 1+1+1+1, 1+1+1+0"]
    assert [r.label for r in rungs][-1] == "strain, polynomial 4+4+4+4, 4+4+4+0"
    assert all({s.name for s in a.outputs} >= {"tip_x", "j1"} for a in rungs)
    assert tree.physics().label == "strain, polynomial 4+4+4+4, 4+4+4+0"
    assert "stretch of the beams" in tree.unmodelled  # the fore beam's
    assert tree.physics(20).flexible[0].modes == (12, 12, 12, 12)
    planar = (dataclasses.replace(tree.bodies[0], modes=(2, 0, 0, 0)),)
    assert [dataclasses.replace(tree, bodies=planar, tip="").physics(k).label for k in (-1, 0, 1)] == [
        "strain, polynomial 3+1+1+0",
        "strain, polynomial 4+1+1+0",
        "strain, polynomial 5+2+2+0",
    ]


def test_effects(space):
    tree = space()
    assert tree.effects == {"bending": True, SHORTENING: True, EXACT: False}
    assert tree.without("bending").label == "rigid"
    assert tree.without(SHORTENING).kinematics == "linear"
    assert space("strain").without(EXACT) == tree
    assert space("rigid").effects == {"bending": False, SHORTENING: False, EXACT: False}


def test_a_simpler_motion_is_one_of_the_finer(space):
    """States of one name are the same: shapes of one basis are nested."""
    finer, simpler = space().ladder()[4], space().ladder()[3]
    rng = np.random.default_rng(0)
    x = 0.01 * rng.normal(size=simpler.nx)
    E = finer.embedding(simpler)
    names = [s.name for s in finer.outputs]
    at = [names.index(n) for n in ("tip_x", "tip_y", "tip_z", "upper_deflection_y", "j1")]
    np.testing.assert_allclose(finer.measure(E @ x)[at], simpler.measure(x)[at], atol=1e-13)


def test_sensors_and_deflections(space):
    tree = space()
    devices = [(s.device, s.signal) for s in tree.sensors()]
    assert devices[:4] == [("encoder", f"j{k}") for k in (1, 2, 3, 4)]
    assert ("strain gauge", "upper_curvature_y") in devices
    assert tree.deflections == tuple(f"{b}_deflection_{a}" for b in ("upper", "fore") for a in "yz")
    planar = dataclasses.replace(tree.bodies[0], modes=(1, 0, 0, 0))
    gauges = dataclasses.replace(tree, bodies=(planar, *tree.bodies[1:])).sensors()
    assert "upper_curvature_z" not in [s.signal for s in gauges]


def test_stiff_beams_are_rigid_bodies(space):
    """Rates of change of the joints of the rigid rung: as the limit of a stiff beam under the same torques."""
    tree = space("rigid")
    assert len(tree.coordinates) == 4
    stiff = tuple(
        dataclasses.replace(b, beam=b.beam and dataclasses.replace(b.beam, E=1e22, G=1e22)) for b in space().bodies
    )
    assert dataclasses.replace(space(), bodies=stiff).natural_frequencies().max() > 1e6


def test_bodies_given_by_modes_have_their_rungs():
    """All modes are physics; without `more` but the last of each axis, as of a spacecraft."""
    boom = Beam.rectangular(1.2, 0.03, 0.02, beams.ALUMINIUM)
    data = ModalData.boom(boom, (2, 2))
    tree = FlexibleTree.serial([TreeBody(name="a", joint=Joint(name="j", axis=(0, 1, 0)), modal=data)])
    counts = [rung.bodies[0].modal_modes for rung in tree.ladder()]
    assert counts == [4, 1, 2, 1, 2, 3, 4]
    assert tree.ladder()[-1].kinematics == "stiffened"
    assert [tree.physics(more).bodies[0].modal_modes for more in (0, 1)] == [2, 4]
    assert 0 < tree.left_out < 1
    assert tree.effects == {"bending": True, SHORTENING: True}
    assert "modes that their modal data leave out" in tree.unmodelled
    assert tree.deflections == tuple(f"a_deflection_{axis}" for axis in "xyz")
    assert [s.device for s in tree.sensors()] == ["encoder"]


def test_a_tree_with_rigid_bodies_stands_on_its_own_ladder():
    """Shapes of a body without a beam mean nothing, and stay as they are."""
    beam = Beam.rectangular(1.0, 0.02, 0.01, beams.ALUMINIUM)
    bodies = [TreeBody(name="column", joint=Joint(name="turn"), mass=2.0, inertia=0.01)]
    bodies.append(TreeBody(name="b", joint=Joint(name="j"), beam=beam, modes=(2, 0, 0, 0)))
    tree = FlexibleTree.serial(bodies)
    assert tree.ladder().index(tree) == 4 and tree.ladder()[5].bodies[1].modes == (3, 0, 0, 0)


def test_stretch_is_estimated_by_longer_beams():
    """A spun beam's axial strain at its root, m omega^2 L/2 over E A: by so much it is lengthened, of the same mass."""
    beam = Beam.rectangular(1.0, 0.02, 0.01, beams.ALUMINIUM)
    body = TreeBody(name="b", joint=Joint(name="j"), beam=beam, modes=(1, 1, 0, 0))
    tree = FlexibleTree.serial([body], kinematics="strain", gravity=(0, 0, 0))
    x = np.zeros(tree.nx)
    x[3] = 20.0
    longer = tree.estimates(tree.simulate(x, [0.0], [0.0, 0.01]))[STRETCH][0].bodies[0].beam
    strain = beam.mass * 20.0**2 / 2 / (beam.E * beam.area)
    np.testing.assert_allclose(longer.length - 1.0, strain, rtol=0.02)
    np.testing.assert_allclose(longer.mass, beam.mass, rtol=1e-14)
    stretched = dataclasses.replace(tree, bodies=(dataclasses.replace(body, modes=(1, 1, 0, 1)),))
    assert stretched.estimates(stretched.simulate(np.zeros(stretched.nx), [0.0], [0.0, 0.01])) == {}
