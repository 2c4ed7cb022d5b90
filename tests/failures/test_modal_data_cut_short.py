"""Modal data that hold two bending modes, and a slew that also moves the third: no model made of the data shows it.

The finest models that the data allow agree with each other and are wrong together; a model from data of four modes
tells. What the last mode of the data is worth is of the size of what they leave out, and is told as the uncertainty.
"""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.machines.spacecraft_parts import LINE, WIDTH
from pliant.plants.modal_data.modal_data import ModalData
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics.physics_motion import physics_motion

TOLERANCE = 1e-6


def scene_with(known, kinematics="linear"):
    scene = scenes.get("spacecraft-slew", move_time=6.0, duration=6.0)
    data = ModalData.panel(LINE, WIDTH, (known, 0))
    parts = tuple(dataclasses.replace(a, body=data, modes=None) for a in scene.plant.appendages)
    return dataclasses.replace(
        scene, plant=dataclasses.replace(scene.plant, appendages=parts, kinematics=kinematics), tolerance=TOLERANCE
    )


@pytest.fixture(scope="module")
def motions():
    return {known: Motions(scene_with(known, "stiffened")) for known in (2, 4)}


def tips(motions, plant):
    return motions.outputs(plant, 1e-9)


@pytest.mark.campaign
def test_finest_models_of_the_data_agree_and_are_wrong_and_it_is_told(motions):
    finest = tips(motions[2], motions[2].scene.plant)
    richer = tips(motions[4], motions[4].scene.plant)
    wrong = np.abs(finest - richer).max()
    found = physics_motion(motions[2], TOLERANCE)
    assert np.abs(finest - found.outputs).max() < 0.05 * TOLERANCE  # the naive way: nothing in the data contradicts it
    assert wrong > 10 * TOLERANCE
    assert found.uncertainty > wrong


def test_every_family_of_modes_loses_its_last():
    plant = scene_with(2).plant
    few, all_modes = plant.physics(), plant.physics(1)
    assert [a.data.n for a in few.appendages] == [1, 1] and [a.data.n for a in all_modes.appendages] == [2, 2]
    assert plant.physics(2) == all_modes
    twisting = ModalData.panel(LINE, WIDTH, (3, 2))
    parts = tuple(dataclasses.replace(a, body=twisting) for a in plant.appendages)
    kept = dataclasses.replace(plant, appendages=parts).physics().appendages[0].data
    assert kept.n < twisting.n - 1  # bending and twisting, of which one is not the fastest
