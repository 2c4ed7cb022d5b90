"""The finer of the models that tell what is true is on no ladder, and richer than physics by itself."""

import pytest

from pliant.studies.effectivity.finer_models import SIZES, finer_models
from pliant.studies.effectivity.random_scenes import KINDS, random_scene


@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_on_no_ladder_and_with_more_shapes_than_physics(seed):
    drawn = random_scene(seed)
    plant = drawn.scene.plant
    models = finer_models(drawn)
    assert all(models[1] != rung for rung in (*plant.ladder(), plant.physics()))
    assert models[0].nx < models[1].nx and models[1].nx > plant.physics().nx
    assert plant.physics().inputs == models[1].inputs


def test_a_size_for_every_kind():
    assert {random_scene(seed).kind for seed in range(len(KINDS))} == set(SIZES)
