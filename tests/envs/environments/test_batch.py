"""What a batch shows is its own no more once it is shown; copies and read-only memory go on as the original."""

import copy
import pickle

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import RecordVideo

from pliant.envs import PlantEnv, scenes
from pliant.envs.environments.vector_env import PlantVectorEnv

SCENE = scenes.get("single-link-slew", duration=0.1)
ONE_SIGNAL = scenes.get("single-link-slew", duration=0.1, observe=("hub_angle",))


def sent(thing):
    """Through protocol 5 with its buffers as read-only memory, as Ray and joblib hand them over."""
    buffers: list = []
    data = pickle.dumps(thing, protocol=5, buffer_callback=buffers.append)
    return pickle.loads(data, buffers=[bytes(b) for b in buffers])


def leaves(found):
    if isinstance(found, dict):
        return [leaf for value in found.values() for leaf in leaves(value)]
    return [leaf for value in found for leaf in leaves(value)] if isinstance(found, tuple) else [found]


@pytest.mark.parametrize("scene", [SCENE, ONE_SIGNAL], ids=["signals", "one signal"])
@pytest.mark.parametrize("lanes", [1, 3])
@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_nothing_returned_is_changed_later_nor_reaches_inside(scene, lanes, mode) -> None:
    """Two alike: of one, all that was returned is kept, then overwritten; the other goes on undisturbed."""
    kept, calm = (PlantVectorEnv(scene, lanes, randomise=True, autoreset_mode=mode) for _ in range(2))
    held = [kept.reset(seed=1), kept.states]
    calm.reset(seed=1)
    rng = np.random.default_rng(0)
    for _ in range(14):
        action = rng.uniform(-1, 1, (lanes, 1))
        copies = copy.deepcopy(held)
        held.append(kept.step(action))
        for a, b in zip(leaves(tuple(copies)), leaves(tuple(held[:-1]))):
            assert np.array_equal(a, b)
        np.testing.assert_equal(held[-1], calm.step(action))
        over = held[-1][2] | held[-1][3]
        if mode == AutoresetMode.DISABLED and over.any():
            np.testing.assert_equal(
                kept.reset(options={"reset_mask": over.copy()}), calm.reset(options={"reset_mask": over})
            )
        for leaf in leaves(held[-1]):
            if isinstance(leaf, np.ndarray):
                leaf[...] = 1  # a user writes into what is theirs
        if lanes > 1 and len(held) % 3 == 0:  # one lane starts anew, the others' observations come again
            first = np.arange(lanes) == 0
            np.testing.assert_equal(
                kept.reset(options={"reset_mask": first}), calm.reset(options={"reset_mask": first.copy()})
            )
    assert np.array_equal(kept.states, calm.states)


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, sent, lambda e: pickle.loads(pickle.dumps(e))])
@pytest.mark.parametrize(
    "make", [lambda: PlantVectorEnv(SCENE, 3, randomise=True), lambda: PlantEnv(SCENE, randomise=True)]
)
def test_a_copy_goes_on_as_the_original_would_and_shares_nothing(make, way) -> None:
    env = make()
    env.reset(seed=2)
    action = np.full(env.action_space.shape, 0.3)
    env.step(action)
    other, third = way(env), way(env)
    paths = []
    for one in (env, other):
        path = []
        for _ in range(11):
            obs, reward, terminated, truncated, _ = one.step(action)
            path.append((obs, reward))
            if isinstance(one, PlantEnv) and (terminated or truncated):
                path.append((one.reset()[0], 0.0))
        paths.append(path)
    np.testing.assert_equal(*paths)
    np.testing.assert_equal(third.step(action)[:2], paths[0][0])


def test_what_randomise_is_set_to_holds_from_the_next_start() -> None:
    vector = PlantVectorEnv(SCENE, 2, randomise=True)
    first, _ = vector.reset(seed=0)
    vector.randomise = False
    plain, told = vector.reset(seed=0)
    assert np.array_equal(plain, PlantVectorEnv(SCENE, 2).reset()[0]) and not np.array_equal(plain, first)
    assert all(np.ptp(p) == 0 for name, p in told["parameters"].items() if name[0] != "_")
    with pytest.raises(ValueError, match="must be True or False"):
        vector.randomise = "no"


def test_options_of_lanes_are_those_of_the_single_environment() -> None:
    scene = scenes.get("two-link-reach")
    vector, single = PlantVectorEnv(scene, 3, randomise=True), PlantEnv(scene, randomise=True)
    mass, state = np.array([0.4, 0.5, 0.6]), np.linspace(-0.1, 0.1, 36).reshape(3, 12)
    for options in (
        {"parameters": {"payload.mass": mass}},
        {"state": state},
        {"state": state, "parameters": {"payload.mass": mass}},
    ):
        obs, _ = vector.reset(seed=4, options=options)
        for lane in range(3):
            own = {"state": state[lane]} if "state" in options else {}
            if "parameters" in options:
                own["parameters"] = {"payload.mass": mass[lane]}
            wanted, _ = single.reset(seed=4 + lane, options=own)
            assert np.array_equal(obs[lane], wanted) and np.array_equal(vector.states[lane], single.state)


def test_lanes_are_drawn_as_the_single_environment_draws_itself() -> None:
    with pytest.warns(UserWarning, match="rgb_array"):
        assert PlantVectorEnv(SCENE, 2).render() is None
    vector, single = PlantVectorEnv(SCENE, 2, render_mode="rgb_array"), PlantEnv(SCENE, render_mode="rgb_array")
    vector.reset(seed=0)
    single.reset(seed=0)
    for action in (0.3, -0.2):
        vector.step(np.full((2, SCENE.plant.nu), action))
        single.step(np.full(SCENE.plant.nu, action))
        pictures = vector.render()
        assert len(pictures) == 2 and np.array_equal(pictures[1], single.render())
    with pytest.raises(ValueError, match="must be at most 64"):
        many = PlantVectorEnv(SCENE, 65, render_mode="rgb_array")
        many.reset()
        many.render()
    vector.close()
    vector.close()


@pytest.mark.parametrize("lanes", [1, 3])
def test_observations_of_one_signal_are_no_view_of_the_kernels(lanes) -> None:
    """Transposed, one row is contiguous already: the step before, which a diverged lane shows again, would be lost."""
    vector = PlantVectorEnv(ONE_SIGNAL, lanes)
    vector.reset()
    vector.step(np.zeros((lanes, 1)))
    assert not np.shares_memory(vector._obs, vector._step.obs)


def test_videos_are_recorded(tmp_path) -> None:
    pytest.importorskip("moviepy")
    env = gymnasium.make("pliant/SingleLinkSlew-v0", render_mode="rgb_array", max_episode_steps=3)
    one = gymnasium.wrappers.RecordVideo(env, str(tmp_path / "one"))
    one.reset(seed=0)
    for _ in range(3):
        one.step(np.zeros(1))
    one.close()
    venv = gymnasium.make_vec("pliant/SingleLinkSlew-v0", num_envs=2, render_mode="rgb_array", max_episode_steps=3)
    many = RecordVideo(venv, str(tmp_path / "many"), video_aspect_ratio=(1, 1), video_length=2)
    many.reset(seed=0)
    for _ in range(3):
        many.step(np.zeros((2, 1)))
    many.close()
    assert all(list((tmp_path / name).glob("*.mp4")) for name in ("one", "many"))
