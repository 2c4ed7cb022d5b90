"""Pictures of trees that move in space: where their tip is drawn, what moves, what bends."""

import pickle

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.rendering import TreeRenderer, renderer
from pliant.envs.rendering.tree_space import bent


@pytest.mark.parametrize("name", ["three-link-flexible", "satellite-arm"])
def test_the_picture_is_the_machine(name: str) -> None:
    """The payload stands where the outputs say that the tip is; a copy draws the same."""
    scene = scenes.get(name)
    drawn, (x, u) = renderer(scene), scene.initial
    assert isinstance(drawn, TreeRenderer)
    first = drawn.draw(x, np.zeros(scene.plant.nu), 0.0, 0.0)
    assert first.shape == (600, 600, 3) and first.dtype == np.uint8
    tip = np.ravel(drawn._payload.get_data_3d())
    np.testing.assert_allclose(tip, scene.signal_values(x, scene.plant.measure(x, u), ("tip_x", "tip_y", "tip_z")))
    second = pickle.loads(pickle.dumps(drawn)).draw(scene.target[0], np.zeros(scene.plant.nu), 0.5, 1.0)
    assert (first != second).any() and len(np.unique(first.reshape(-1, 3), axis=0)) > 50


def test_what_bends_is_told_from_what_does_not() -> None:
    x = np.linspace(0.0, 1.0, 9)
    assert not bent(np.column_stack([x, 2 * x, -x])) and bent(np.column_stack([x, 1e-3 * x**2, 0 * x]))
