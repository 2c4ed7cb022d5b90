"""Pictures of a scene in its plane."""

import gymnasium
import numpy as np
import pytest

import pliant.envs
from pliant.envs import scenes

IDS = [pliant.envs.environment_id(name) for name in scenes.names()]
LINKS = {"two-link-reach": 2, "slider-crank-run": 2}  # drawn; one in the other scenes


@pytest.mark.every(4)
@pytest.mark.parametrize("env_id", [name for name in IDS if "Spacecraft" not in name])
def test_outline_ends_at_the_tip(env_id: str) -> None:
    """In every fidelity the drawn links start at the hub, hang together, and end where the outputs say."""
    scene = gymnasium.make(env_id).unwrapped.scene
    rng = np.random.default_rng(0)
    for plant in scene.plant.ladder():
        x = 0.05 * rng.standard_normal(plant.nx)
        if scene.name == "slider-crank-run":
            x /= 10  # its rod is a quarter of a metre long
        turning = [
            i for i, s in enumerate(plant.states[: plant.nx // 2]) if s.name.startswith(("theta", "hub", "crank"))
        ]
        x[turning] = rng.uniform(-3, 3, len(turning))
        links = plant.outline(x, 12)
        assert links.shape == (LINKS.get(scene.name, 1), 12, 2)
        np.testing.assert_allclose(links[0, 0], 0.0, atol=1e-15)
        np.testing.assert_allclose(links[1:, 0], links[:-1, -1])
        y = dict(zip((s.name for s in plant.outputs), plant.measure(x)))
        end = [y["slider_x"], 0.0] if "slider_x" in y else [y["tip_x"], y["tip_y"]]
        np.testing.assert_allclose(links[-1, -1], end, rtol=1e-9, atol=1e-9)
