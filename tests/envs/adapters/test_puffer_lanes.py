"""PufferLib's conventions of buffers, without the library: written into in place, episodes start again at once."""

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.adapters.puffer_lanes import BUFFERS, PufferLanes

SLEW = scenes.get("single-link-slew", duration=0.2)
LANES = 3


def ready(seed: int = 0, **options) -> tuple[PufferLanes, dict[str, np.ndarray]]:
    """Lanes in the middle rows of larger arrays, as PufferLib's vectors of environments hand them over."""
    lanes = PufferLanes(SLEW, LANES, seed=seed, **options)
    no, nu = lanes.single_observation_space.shape[0], lanes.single_action_space.shape[0]
    kinds = {"terminals": bool, "truncations": bool, "masks": bool}
    widths = {"observations": (no,), "actions": (nu,)}
    whole = {name: np.zeros((9, *widths.get(name, ())), kinds.get(name, np.float32)) for name in BUFFERS}
    for name, array in whole.items():
        setattr(lanes, name, array[3 : 3 + LANES])
    return lanes, whole


def test_buffers_are_written_into_and_no_others() -> None:
    lanes, whole = ready(randomise=True)
    held = {name: getattr(lanes, name) for name in BUFFERS}
    obs, infos = lanes.reset(seed=1)
    assert obs is held["observations"] and infos == []
    assert lanes.single_observation_space.dtype == np.float32 and held["masks"].all()
    out = lanes.step(np.full((LANES, 1), 0.5, np.float32))
    assert [a is held[name] for a, name in zip(out[:4], BUFFERS)] == [True] * 4 and out[4] == []
    assert (held["actions"] == 0.5).all() and (held["rewards"] < 0).all()
    for name, array in whole.items():
        assert not array[:3].any() and not array[6:].any() and getattr(lanes, name) is held[name]


def test_a_lane_plays_what_the_single_environment_of_its_seed_plays_and_starts_again_at_once() -> None:
    lanes, _ = ready(randomise=True)
    lanes.reset(seed=2)
    alone = [PlantEnv(SLEW, randomise=True, dtype=np.float32) for _ in range(LANES)]
    for lane, env in enumerate(alone):
        assert np.array_equal(env.reset(seed=2 * LANES + lane)[0], lanes.observations[lane])
    paid, told = np.zeros(LANES), []
    for action in np.random.default_rng(0).uniform(-1, 1, (2 * SLEW.steps, LANES, 1)).astype(np.float32):
        *_, infos = lanes.step(action)
        for lane, env in enumerate(alone):
            seen, reward, ended, late, _ = env.step(action[lane])
            paid[lane] += reward
            assert (lanes.terminals[lane], lanes.truncations[lane]) == (ended, late)
            assert lanes.rewards[lane] == np.float32(reward)
            assert np.array_equal(lanes.observations[lane], env.reset()[0] if ended or late else seen)
        told += infos
    assert [info["episode_length"] for info in told] == [SLEW.steps] * 2  # all end together
    assert sum(info["episode_return"] for info in told) == pytest.approx(paid.sum() / LANES, rel=1e-6)
    assert all(isinstance(value, float) for info in told for value in info.values())


def test_environments_of_neighbouring_seeds_share_no_episode() -> None:
    first = {tuple(row) for seed in (0, 1) for row in ready(seed, randomise=True)[0].reset()[0].tolist()}
    assert len(first) == 2 * LANES


def test_bad_input_is_named_and_changes_nothing() -> None:
    lanes, _ = ready()
    lanes.reset(seed=0)
    before = lanes.observations.copy()
    with pytest.raises(ValueError, match="seed = -1 must be an integer"):
        lanes.reset(seed=-1)
    with pytest.raises(ValueError, match=r"actions have shape \(2, 1\), must be \(3, 1\)"):
        lanes.step(np.zeros((2, 1)))
    for name, value in (("dtype", "float64"), ("autoreset_mode", "NextStep")):
        with pytest.raises(ValueError, match=f"PufferLanes: {name} = '{value}' must be left out"):
            PufferLanes(SLEW, LANES, **{name: value})
    assert np.array_equal(lanes.observations, before) and lanes.render() is None
    lanes.notify()
    lanes.close()
