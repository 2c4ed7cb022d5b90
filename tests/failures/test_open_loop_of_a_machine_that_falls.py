"""The inputs of a closed loop replayed in open loop on a machine that falls without its law.

An arm of 1 m stands on its head and is turned by 0.2 rad within a second; its PD holds it for four. Replayed without
the law, the smallest difference between two models grows until the arm has fallen: metres are told of models that the
law keeps within micrometres of each other. Source of the true motion: the same law on a model that is on no rung, exact
rotations with five of the loaded link's modes and shear, simulated by CVODES.
"""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import PD
from pliant.envs import scenes
from pliant.studies import choose
from pliant.studies.common.reference_motions import Motions

OWN = scenes.get("single-link-slew")
STANDING = dataclasses.replace(
    OWN.with_plant(dataclasses.replace(OWN.plant, gravity=9.81, hub_friction=0.0)),
    start=(("hub_angle", np.pi / 2 - 0.1),),
    goal=(("hub_angle", np.pi / 2 + 0.1),),
    move_time=1.0,
    duration=4.0,
)
TOLERANCE = 1e-3  # [m]


@pytest.fixture(scope="module")
def law():
    return PD.for_scene(STANDING)


def test_the_naive_replay_tells_of_a_fall(law):
    held = STANDING.plant.simulate(STANDING.initial[0], law, STANDING.times, rtol=1e-8)
    replayed = Motions.with_inputs_of(STANDING, held, "held")
    two = [dataclasses.replace(STANDING.plant, modes=n) for n in (1, 2)]
    apart = np.abs(replayed.outputs(two[0], 1e-8) - replayed.outputs(two[1], 1e-8)).max()
    assert apart > 50 * TOLERANCE


def test_choose_plays_the_law_on_every_model_and_what_it_takes_holds(law):
    found = choose(STANDING, TOLERANCE, motions=[law])
    told = next(rung for rung in found.rungs if rung.chosen)
    assert found.met and found.plant.kinematics != "strain"
    exact = {"kinematics": "strain", "basis": "payload", "theory": "timoshenko", "modes": 5}
    finer = dataclasses.replace(STANDING.plant, **exact)
    own, true = (
        plant.simulate(x0, law, STANDING.times, method="cvodes", rtol=1e-7, atol=1e-9)
        for plant, x0 in ((found.plant, Motions(STANDING).start(found.plant)), (finer, Motions(STANDING).start(finer)))
    )
    error = max(np.abs(own[name] - true[name]).max() for name in STANDING.compare)
    assert error <= told.bound <= TOLERANCE and error == pytest.approx(told.error, rel=0.25)


def test_a_law_that_reads_shapes_is_refused_by_its_signals(law):
    from pliant.controllers import LQR

    with pytest.raises(ValueError, match=r"choose\.motions\[0\] reads eta1"):
        choose(STANDING, TOLERANCE, motions=[LQR.for_scene(STANDING)])
    with pytest.raises(ValueError, match=r"choose\.motions\[0\]\.dt"):
        choose(STANDING, TOLERANCE, motions=[dataclasses.replace(law, dt=0.005)])
