"""Lanes of several models in one step: each as its model alone steps it, whatever stands beside it."""

import copy
import pickle

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.environments.vector_env import PlantVectorEnv
from pliant.envs.mixtures.mixed_step import MixedStep
from pliant.envs.mixtures.mixture import Mixture
from pliant.envs.simulation.control_kernel import ControlStep

SLEW = scenes.get("single-link-slew")
PAIRS = (("rigid", 1.0), ("linear", 1.0), ("own", 1.0))


def ready(lanes: int, dtype: str = "float64", threads: int = 1, seed: int = 0) -> tuple[MixedStep, Mixture]:
    """A step whose lanes stand at random states, under random actions."""
    mixture, rng = Mixture(SLEW, PAIRS, lanes), np.random.default_rng(seed)
    mixture.rung[:] = rng.integers(0, 3, lanes)
    step = MixedStep(mixture, np.dtype(dtype), threads)
    step.x[:] = 0.02 * rng.uniform(-1, 1, step.x.shape)
    step.action[:] = rng.uniform(-1, 1, step.action.shape)
    step.p[:] *= rng.uniform(0.9, 1.1, step.p.shape)
    return step, mixture


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("lanes", [1, 13])
def test_lanes_step_as_their_model_alone(lanes: int, dtype: str) -> None:
    step, mixture = ready(lanes, dtype)
    want = {}
    for lane, g in enumerate(mixture.rung.tolist()):
        alone = ControlStep(mixture.scenes[g], 1, np.dtype(dtype), 1, goal=SLEW)
        for name in ("x", "action", "p"):
            getattr(alone, name)[:] = getattr(step, name)[: len(getattr(alone, name)), lane : lane + 1]
        want[lane] = alone, [alone.run() for _ in range(3)][-1]
    for _ in range(3):
        unsound, outside = step.run()
    for lane, (alone, (fell, left)) in want.items():
        assert np.array_equal(step.x[: len(alone.x), lane], alone.x[:, 0])
        assert np.array_equal(step.obs[:, lane], alone.obs[:, 0])
        assert step.cost[lane] == alone.cost[0] and step.reach[lane] == alone.reach[0]
        assert unsound[lane] == fell[0] and outside[lane] == left[0]


def test_threads_and_the_virtual_machine_give_the_same(monkeypatch) -> None:
    a, _ = ready(90)
    b, _ = ready(90, threads=2)
    for step in (a, b):
        step.run()
    assert np.array_equal(a.x, b.x) and np.array_equal(a.obs, b.obs)
    c, _ = ready(90)
    monkeypatch.setattr(c, "_bound", [None] * 3)
    c.run()
    np.testing.assert_allclose(c.obs, a.obs, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(c.cost, a.cost, rtol=1e-12)


def test_lanes_that_change_their_model_are_seated_anew() -> None:
    step, mixture = ready(9)
    step.run()
    mixture.rung[:] = (mixture.rung + 1) % 3
    step.x[:], x = 0.01, np.full(9, 0.01)
    step.run()
    rigid = np.flatnonzero(mixture.rung == 0)
    alone = ControlStep(mixture.scenes[0], 1, np.dtype(float), 1, goal=SLEW)
    for lane in rigid:
        alone.x[:], alone.action[:], alone.p[:] = x[lane], step.action[:, lane : lane + 1], step.p[:, lane : lane + 1]
        alone.run()
        assert np.array_equal(alone.x[:, 0], step.x[: len(alone.x), lane])


@pytest.mark.parametrize("travel", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_a_copy_plays_on_alike_and_alone(travel) -> None:
    env = PlantVectorEnv(SLEW, 5, randomise=True, fidelities=("rigid", "own"), autoreset_mode="SameStep")
    env.reset(seed=0)
    actions = np.random.default_rng(0).uniform(-1, 1, (40, 5, 1))
    env.step(actions[0])
    twin = travel(env)
    assert twin._starts.mixture is twin._step.mixture is twin._mixture is not env._mixture
    for action in actions[1:]:
        for a, b in zip(env.step(action)[:4], twin.step(action)[:4]):
            assert np.array_equal(a, b)
