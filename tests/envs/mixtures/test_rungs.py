"""Models of a scene's machine by words: what they name, and what is refused."""

import dataclasses

import pytest

from pliant.envs import scenes
from pliant.envs.mixtures.rungs import plant_of, scene_on

SLEW, REACH = scenes.get("single-link-slew"), scenes.get("two-link-reach")


@pytest.mark.parametrize("scene", [SLEW, REACH, scenes.get("flexible-joint-slew"), scenes.get("cantilever-drop")])
def test_every_label_of_the_ladder_names_its_model(scene) -> None:
    for plant in scene.plant.ladder():
        assert plant_of(scene, plant.label) == plant
    assert plant_of(scene, "own") is scene.plant


def test_first_words_name_the_model_of_most_nearly_as_many_states() -> None:
    assert plant_of(REACH, "rigid").nx == 4
    assert plant_of(REACH, "linear").label == "linear, clamped-free 2+2" and plant_of(REACH, "linear").nx == 12
    assert plant_of(REACH, "stiffened") is REACH.plant
    assert plant_of(REACH, "strain").label == "strain, polynomial 3+3"  # of 16 and 20 states


@pytest.mark.parametrize("word", ["stiff", "", "rigid, payload 2", "Rigid"])
def test_other_words_are_refused_with_those_that_are_known(word) -> None:
    with pytest.raises(
        ValueError, match=r"must be 'own', or a label of scene 'single-link-slew' .*'linear, payload 1'"
    ):
        plant_of(SLEW, word)


def test_a_stiffer_model_has_as_many_substeps_as_its_step_takes() -> None:
    """Four polynomials a link: RK4 at the scene's own ten steps a period is past its limit."""
    rich = plant_of(REACH, "stiffened, polynomial 4+4")
    found = scene_on(REACH, rich)
    assert found.substeps > REACH.substeps == 10 and found.substeps % 10 == 0
    assert scene_on(REACH, rich) is found and scene_on(REACH, REACH.plant) is REACH
    assert dataclasses.replace(found, substeps=10, plant=REACH.plant) == REACH


def test_a_plant_of_other_inputs_is_refused() -> None:
    with pytest.raises(ValueError, match=r"has the inputs .*must have those of scene 'single-link-slew'"):
        scene_on(SLEW, REACH.plant)


def test_a_plant_with_other_values_of_what_is_drawn_is_refused() -> None:
    """Lanes of all models get the scene's values: they would be played in place of the plant's own."""
    heavy = dataclasses.replace(SLEW.plant, payload=dataclasses.replace(SLEW.plant.payload, mass=2.0))
    with pytest.raises(ValueError, match=r"payload.mass = 2, which scene 'single-link-slew' draws about its own 1"):
        scene_on(SLEW, heavy)
