"""Episodes drawn ahead: a lane's own stream gives what a single environment of its seed plays, whoever else asks."""

import numpy as np
import pytest
from gymnasium.utils import seeding

from pliant.envs import scenes
from pliant.envs.simulation.episode_start import begin
from pliant.envs.simulation.episode_supply import DEPTH, EpisodeSupply
from pliant.plants.core.signals import owned

SCENE = scenes.get("spin-up")


def one_by_one(seed: int, count: int) -> list[np.ndarray]:
    """The episodes of one stream, drawn one after the other."""
    rng = seeding.np_random(seed)[0]
    rows = [begin(SCENE, rng, 1) for _ in range(count)]
    return [np.concatenate(column) for column in zip(*rows)]


def unasked() -> np.random.Generator:
    pytest.fail("the shared stream was asked")


def test_lanes_play_their_seeds_episodes_in_their_order() -> None:
    supply, rng = EpisodeSupply(SCENE, 4), np.random.default_rng(0)
    supply.seed(np.arange(4), [10, 11, 12, 13])
    taken: dict[int, list] = {lane: [] for lane in range(4)}
    for _ in range(4 * DEPTH):
        lanes = np.flatnonzero(rng.random(4) < 0.5)
        for lane, *episode in zip(lanes, *supply.take(lanes, unasked)):
            taken[int(lane)].append(episode)
    for lane, episodes in taken.items():
        assert len(episodes) > DEPTH
        for got, wanted in zip(zip(*episodes), one_by_one(10 + lane, len(episodes))):
            assert np.array_equal(got, wanted)


def test_lanes_without_a_seed_share_one_stream() -> None:
    supply, shared = EpisodeSupply(SCENE, 3), np.random.default_rng(3)
    supply.seed(np.array([1]), [7])
    mixed = supply.take(np.arange(3), lambda: shared)
    own, wanted = one_by_one(7, 1), begin(SCENE, np.random.default_rng(3), 3)
    for a, b, c in zip(mixed, own, wanted):
        assert np.array_equal(a[1], b[0]) and np.array_equal(a[[0, 2]], c[:2])
    assert supply.generator(0) is None and isinstance(supply.generator(1), np.random.Generator)


def test_state_that_came_read_only_is_owned() -> None:
    frozen = np.frombuffer(bytes(16))
    found = owned({"a": frozen, "b": [frozen], "c": 1})
    found["a"][0] = found["b"][0][0] = 1.0
    assert found["c"] == 1 and frozen[0] == 0.0
