"""The law that a run begins from, as a policy: it asks what the law asks; a run that finds no better ends with it."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR, rl
from pliant.controllers.analytic_gradients.kept_law import CLOSE, as_policy, words
from pliant.controllers.learning.evaluation import evaluate
from pliant.controllers.learning.policy import Policy
from pliant.controllers.learning.settings import APGSettings
from pliant.envs import scenes

SCENE = scenes.get("flexible-joint-slew")
SHORT = dataclasses.replace(SCENE, duration=0.5, move_time=0.5)
FEW = APGSettings(num_envs=2, width=4)
GRADIENT = 2 * SHORT.steps


@pytest.mark.parametrize("name", ["spin-up", "spacecraft-slew"])
def test_it_asks_what_the_law_asks(name) -> None:
    scene = scenes.get(name)
    law = LQR.for_scene(scene)
    policy = as_policy(law, scene, {})
    y = law.x0 + 0.01 * np.random.default_rng(0).standard_normal((20, len(law.x0)))
    for row in np.vstack([y, law.x0 + 1e3]):  # the last one beyond the limits
        np.testing.assert_allclose(policy.act(0.0, row), law.act(0.0, row), rtol=1e-9, atol=1e-12)


def test_laws_with_memory_are_none() -> None:
    assert as_policy(LQR.for_scene(SCENE, integral={"joint": 1.0}), SCENE, {}) is None
    assert as_policy(None, SCENE, {}) is None


def test_it_costs_what_the_law_costs() -> None:
    """2.705: LQR's on this scene in docs/scoreboard/suite-2, played there by another integrator."""
    assert evaluate(as_policy(LQR.for_scene(SCENE), SCENE, {}), SCENE) == pytest.approx(2.705, rel=1e-3)


def test_a_run_that_finds_no_better_keeps_the_law(tmp_path) -> None:
    """A step so long that it only spoils the network."""
    wild = dataclasses.replace(FEW, learning_rate=10.0, width=1)
    found = rl.train(SHORT, settings=wild, steps=3 * GRADIENT, folder=tmp_path)
    assert found.cost == found.law_cost and found.policy.made["law"] == "lqr" and "kept" in found.words
    assert found.curve[0].cost > CLOSE * found.law_cost
    kept = Policy.load(tmp_path / "policy")
    assert kept.reads == tuple(s.name for s in SHORT.plant.states) and len(kept.weights) == 1
    assert evaluate(kept, SHORT) == found.cost
    again = rl.train(SHORT, settings=wild, steps=4 * GRADIENT, folder=tmp_path, resume=True)
    assert again.cost == found.cost and again.words == found.words


def test_a_run_that_does_keeps_the_network() -> None:
    found = rl.train(SHORT, settings=dataclasses.replace(FEW, width=32), steps=GRADIENT)
    assert found.policy.reads == SHORT.observe and found.cost < CLOSE * found.law_cost and not found.words


def test_what_is_said() -> None:
    assert words(False, 1.0005, 1.0) == "" and words(False, 5.0, None) == ""
    assert "LQR costs less: 1" in words(False, 1.1, 1.0) and "kept" in words(True, 1.0, 1.0)
