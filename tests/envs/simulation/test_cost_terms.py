"""Terms of the cost add up to what the control kernel charges."""

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.simulation.control_period import reference
from pliant.envs.simulation.cost_terms import cost_terms, term_names


def test_terms_by_hand_and_their_sum() -> None:
    scene = scenes.get("single-link-slew")
    env = PlantEnv(scene, terms=True)
    env.reset(seed=0)
    _, reward, _, _, info = env.step(np.array([0.5]))
    terms = info["reward_terms"]
    assert tuple(terms) == term_names(scene)
    # one radian off at weight 10, and 20 N m at 0.002, for 0.02 s
    assert terms["hub_angle"] == pytest.approx(-0.2) and terms["hub_torque"] == pytest.approx(-0.016)
    assert sum(terms.values()) == pytest.approx(reward)


def test_rows_are_the_scenes_stage_cost() -> None:
    scene, rng = scenes.get("two-link-reach"), np.random.default_rng(0)
    plant = scene.varied_plant
    x, u = 0.1 * rng.standard_normal((5, plant.nx)), rng.standard_normal((5, plant.nu))
    p, w = np.tile(plant.nominal_parameters, (5, 1)), np.zeros((5, plant.nw))
    (found,) = cost_terms(scene)(x, u, np.tile(reference(scene), (5, 1)), w, p)
    want = scene.dt * scene.stage_cost(x, u, scene.plant.measure(x, u))
    np.testing.assert_allclose(found.sum(axis=1), want, rtol=1e-10)
