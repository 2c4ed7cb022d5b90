"""Starts of lanes of a mixture: the same coordinates and parameters as without, at rest each in its own model."""

import numpy as np

from pliant.envs import scenes
from pliant.envs.environments.vector_env import PlantVectorEnv

REACH = scenes.get("two-link-reach")
WORDS = ("rigid", "linear", "own")


def test_starts_are_those_without_a_mixture_but_for_the_models_own_rest() -> None:
    plain, mixed = (
        PlantVectorEnv(REACH, 12, randomise=True),
        PlantVectorEnv(REACH, 12, randomise=True, fidelities=WORDS),
    )
    for seed in (0, 5):
        a, told = plain.reset(seed=seed)
        b, info = mixed.reset(seed=seed)
        np.testing.assert_array_equal(info["parameters"]["payload.mass"], told["parameters"]["payload.mass"])
        np.testing.assert_allclose(b[:, :2], a[:, :2], atol=1e-12)  # joint angles
        own = info["fidelity"] == REACH.plant.label
        assert 0 < own.sum() < 12 and np.array_equal(a[own], b[own])


def test_every_model_starts_at_its_own_rest_and_is_seen_from_the_scenes_goal() -> None:
    """Against the equilibrium of the plant itself, by its own solver; the goal's sag is the scene's plant's."""
    env = PlantVectorEnv(REACH, 3, fidelities=WORDS)
    obs, info = env.reset(options={"fidelity": WORDS})
    goal = REACH.goal_values(REACH.observe)
    for lane, word in enumerate(WORDS):
        scene = env._mixture.scenes[lane]
        x, u = scene.plant.equilibrium(dict(REACH.start))
        assert info["fidelity"][lane] == scene.plant.label and (word == "own" or scene.plant.label.startswith(word))
        np.testing.assert_allclose(env.get_attr("state")[lane], x, atol=1e-9)
        y = scene.plant.measure(x, 0 * u)
        np.testing.assert_allclose(obs[lane] + goal, scene.signal_values(x, y, REACH.observe), atol=1e-9)
    assert np.isnan(env.states[0, 4:]).all() and not np.isnan(env.states[2]).any()
