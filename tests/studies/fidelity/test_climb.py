"""Rungs of a scene's ladder against physics."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import IntegrationError
from pliant.studies import choose
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity import climb as module
from pliant.studies.fidelity.climb import Climb
from pliant.studies.physics.known_physics import PhysicsMotion

SHORT = scenes.get("single-link-slew", duration=0.5)


def told(fraction, task):
    pass


def climbed(scene, tolerance, physics):
    """The climb against a physics that is given: its outputs, and what is known of it."""
    motions = Motions(scene)
    motions.truth[tolerance] = physics
    return Climb([motions], tolerance)


def physics_of(plant, uncertainty=0.0, left=()):
    exact = Motions(SHORT).outputs(plant, 1e-9)
    return PhysicsMotion(exact, plant, 0.0, 0.0, uncertainty, "as given", left=left)


def test_of_physics_itself_no_more_is_claimed_than_is_known_of_it():
    plant = dataclasses.replace(SHORT.plant, kinematics="strain", basis="payload", modes=2)
    climb = climbed(SHORT, 2e-6, physics_of(plant, 1.5e-6))
    rungs, chosen = climb.rungs(told)
    own = rungs[[r.variant for r in rungs].index(plant.label)]
    assert rungs[chosen] is own and climb.shown(own)
    assert own.error == own.bound and 1.5e-6 <= own.bound < 1.6e-6


def entry(holds):
    return {
        "quantity": "strain",
        "unit": "1",
        "range": [0.0, 0.01],
        "largest": 0.02,
        "time": 0.1,
        "since": 0.1,
        "keeps": "sections keep their size",
        "holds": holds,
    }


def test_a_range_beyond_which_nothing_here_holds_is_told_and_any_other_is_a_refusal():
    rigid = SHORT.plant.ladder()[0]
    for holds, met in (("no kinematics of this library", True), ('kinematics="strain"', False)):
        climb = climbed(SHORT, 0.1, physics_of(rigid, 0.01, (entry(holds),)))
        rungs, chosen = climb.rungs(told)
        assert climb.shown(rungs[chosen]) is met
        assert bool(climb.beyond) is met and (climb.outside == "") is met
        assert met or climb.missing(met, ())[0].startswith("strain 0.02")


def test_without_physics_no_rung_is_played(monkeypatch):
    def none(*_):
        raise IntegrationError("stands still", 0.0, np.zeros(1), None)

    monkeypatch.setattr(module, "physics_motion", none)
    choice = choose(SHORT, 0.1)
    assert not choice.met and all(r.note.startswith("not tried: physics") for r in choice.rungs)
    assert choice.missing == ("physics cannot be played: stands still",)


def test_every_motion_counts():
    """One that physics leaves by more than the tolerance, behind one that it keeps."""
    rigid = SHORT.plant.ladder()[0]
    near, far = Motions(SHORT), Motions(SHORT)
    exact = near.outputs(rigid, 1e-9)
    near.truth[1e-3] = PhysicsMotion(exact, rigid, 0.0, 0.0, 0.0, "as given")
    far.truth[1e-3] = PhysicsMotion(exact + 5e-3, rigid, 0.0, 0.0, 0.0, "as given")
    assert Climb([near], 1e-3).rungs(told)[0][0].bound <= 1e-3
    assert Climb([near, far], 1e-3).rungs(told)[0][0].bound == pytest.approx(5e-3)


def test_rungs_with_the_shapes_that_a_motion_needs_stand_behind_those_of_fewer_states():
    plant = SHORT.plant
    physics = dataclasses.replace(plant, kinematics="strain", basis="polynomial", modes=6)
    spared = dataclasses.replace(plant, kinematics="stiffened", basis="polynomial", modes=5)
    rungs = module._rungs(plant, physics, [spared, plant.ladder()[1]])
    labels = [p.label for p in rungs]
    assert labels.count(spared.label) == 1 and len(set(labels)) == len(labels) and rungs[-1] == physics
    at = labels.index(spared.label)
    assert all(p.nx <= spared.nx for p in rungs[:at])
    assert labels[:at] + labels[at + 1 :] == [p.label for p in module._rungs(plant, physics)]
