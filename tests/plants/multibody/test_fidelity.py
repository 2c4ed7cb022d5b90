"""Ladder, physics and effects of a tree; what it carries."""

import dataclasses

import numpy as np


def test_ladder(space):
    tree = space()
    rungs = tree.ladder()
    assert [r.label for r in rungs][:2] == ["rigid", "linear, polynomial 1+1+1+1, 1+1+1+0"]
    assert all({s.name for s in a.outputs} >= {"tip_x", "j1"} for a in rungs)
    assert tree.physics().label == "stiffened, polynomial 4+4+4+4, 4+4+4+0"
    assert "stretch of the beams" in tree.unmodelled  # the fore beam's
    assert tree.physics(20).flexible[0].modes == (12, 12, 12, 12)
    planar = (dataclasses.replace(tree.bodies[0], modes=(2, 0, 0, 0)),)
    assert dataclasses.replace(tree, bodies=planar, tip="").physics().label == "stiffened, polynomial 4+4+4+0"


def test_effects(space):
    tree = space()
    assert tree.effects == {"bending": True, "shortening of the bent beams": True}
    assert tree.without("bending").label == "rigid"
    assert tree.without("shortening of the bent beams").kinematics == "linear"
    assert space("rigid").effects == {"bending": False, "shortening of the bent beams": False}


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
