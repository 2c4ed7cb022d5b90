"""What every picture in space shows beside its machine: a bar an input, time and cost, the path so far."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.rendering import renderer
from pliant.envs.rendering.space_picture import TRAIL


@pytest.mark.parametrize("name", ["three-link-flexible", "spacecraft-slew"])
def test_bars_words_and_the_path(name: str) -> None:
    scene = scenes.get(name)
    drawn, nu = renderer(scene), scene.plant.nu
    action = np.linspace(-1.5, 0.75, nu)  # the first beyond its limit
    drawn.draw(scene.initial[0], action, 1.25, 3.5)
    assert [round(bar.get_width() / 0.2, 6) for bar in drawn._bars] == [*np.clip(action, -1.0, 1.0)[::-1].round(6)]
    words = [text.get_text() for text in drawn.axes.texts]
    assert words[0].startswith(f"{scene.name}\n{scene.plant.label}") and "1.25 s\ncost 3.50" in words
    assert set(words) >= {s.name for s in scene.plant.inputs}
    begin = np.array(drawn._behind.get_data_3d())
    for k in range(TRAIL + 5):
        drawn._go_on(np.array([k, 2.0 * k, 0.0]))
    path = np.array(drawn._behind.get_data_3d())
    assert begin.shape == (3, 1) and path.shape == (3, TRAIL) and path[1, -1] == 2 * (TRAIL + 4)
    drawn.clear()
    drawn._go_on(np.zeros(3))
    assert np.shape(drawn._behind.get_data_3d()) == (3, 1)
