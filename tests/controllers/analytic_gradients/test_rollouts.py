"""Gradients of whole episodes: against central differences, whose own error falls with the step's square."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers.analytic_gradients import rollouts as room
from pliant.controllers.analytic_gradients.rollouts import Episodes, Rollouts
from pliant.controllers.learning.evaluation import evaluate
from pliant.controllers.learning.policy import Policy
from pliant.envs import scenes

LANES = 3


def made(name: str, duration: float, history: int, delays: int) -> tuple[Rollouts, np.ndarray, Episodes]:
    """Rollouts of a scene's beginning, a network that moves it, and varied episodes."""
    scene = dataclasses.replace(scenes.get(name), duration=duration)
    rng = np.random.default_rng(1)
    found = Rollouts(scene, LANES, np.full(len(scene.observe), 0.5), width=12, history=history)
    theta = found.network.start(rng)
    at = found.network.layers(theta)
    at.W3[:] = 0.02 * rng.standard_normal(at.W3.shape)
    at.b3[:] = scene.target[1] / found.limits
    env = scene.vector_env(LANES, randomise=True)
    env.reset(seed=3)
    p = np.tile(scene.varied_plant.nominal_parameters, (LANES, 1)) * rng.uniform(0.9, 1.1, (LANES, 1))
    return found, theta, Episodes(env.states.copy(), p, rng.integers(0, delays + 1, LANES))


@pytest.mark.parametrize(
    ("name", "duration", "history", "delays"),
    [("single-link-slew", 0.4, 0, 0), ("two-link-reach", 0.3, 2, 2), ("spacecraft-slew", 1.0, 1, 1)],
)
def test_gradient_is_that_of_differences(monkeypatch, name, duration, history, delays) -> None:
    monkeypatch.setattr(room, "FAR", 1e9)  # every lane counts as it is
    run, theta, episodes = made(name, duration, history, delays)
    cost, gradient = run(theta, episodes)
    total = lambda theta: float(sum(part.mean() for part in run.cost(theta, episodes)))  # noqa: E731
    assert total(theta) == pytest.approx(cost.mean(), rel=1e-12)  # no bound is near
    rng, h = np.random.default_rng(2), 1e-5
    for _ in range(3):
        way = rng.standard_normal(len(theta))
        way /= np.linalg.norm(way)
        slope = (total(theta + h * way) - total(theta - h * way)) / (2 * h)
        assert gradient @ way == pytest.approx(slope, rel=1e-6, abs=1e-8 * np.linalg.norm(gradient))


def test_a_command_beyond_the_limits_has_no_slope_but_back() -> None:
    run, theta, episodes = made("single-link-slew", 0.1, 0, 0)
    run.network.layers(theta).b3[:] = 3.0  # far beyond; more of it changes nothing
    _, gradient = run(theta, episodes)
    assert run.network.layers(gradient).b3[0] >= 0.0  # downhill is less of it, or nothing


def test_lanes_that_run_away_count_for_nothing() -> None:
    run, theta, episodes = made("single-link-slew", 0.2, 0, 0)
    mad = episodes.x.copy()
    mad[1] = 1e200
    with np.errstate(all="ignore"):
        _, gradient = run(theta, dataclasses.replace(episodes, x=mad))
    assert np.isfinite(gradient).all() and gradient.any()


def test_a_lane_counts_at_most_a_few_medians() -> None:
    run, theta, episodes = made("single-link-slew", 0.2, 0, 0)
    far = episodes.x.copy()
    far[1, 0] += 1e4
    _, gradient = run(theta, dataclasses.replace(episodes, x=far))
    _, plain = run(theta, episodes)
    assert np.linalg.norm(gradient) < 5 * np.linalg.norm(plain)


def test_the_policy_of_the_same_numbers_pays_what_the_rollouts_say() -> None:
    run, theta, _ = made("two-link-reach", 0.3, 2, 0)
    scene, at = run.scene, run.network.layers(theta)
    policy = Policy(
        weights=(at.W1, at.W2, at.W3),
        biases=(at.b1, at.b2, at.b3),
        mean=np.zeros(run.no),
        std=run.std,
        scene=scene.name,
        reads=scene.observe,
        goal=scene.goal_values(scene.observe),
        inputs=tuple(s.name for s in scene.plant.inputs),
        limits=run.limits,
        dt=scene.dt,
        history=2,
    )
    own = Episodes(
        np.tile(scene.initial[0], (LANES, 1)),
        np.tile(scene.varied_plant.nominal_parameters, (LANES, 1)),
        np.zeros(LANES, dtype=int),
    )
    cost, _ = run.cost(theta, own)
    for _ in range(2):  # the second time as the first: `reset` forgets
        assert evaluate(policy, scene) == pytest.approx(cost[0], rel=1e-6)  # actions go through single precision
