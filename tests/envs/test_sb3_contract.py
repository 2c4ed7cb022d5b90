"""What Stable-Baselines3 2.9's own tests ask of a VecEnv (vec_envs, normalize, monitor, check_nan, stacked_obs).

Written anew after what those tests ask; each test here names what it stands for. Not ours, and why:

- start methods and pipes of SubprocVecEnv, and the refusal of one environment given twice: there are no processes and
  no list of environments;
- dictionary, tuple, discrete and image spaces, and their stacking: our observations and actions are vectors;
- the running mean, goals (HER) and combined statistics of VecNormalize alone: they ask nothing of an environment;
- "TimeLimit.truncated" in every info: ours are empty but where an episode ends, which its algorithms ask with `get`.
"""

import pickle
import warnings
from functools import partial

import numpy as np
import pytest
from env_cases import SAMPLE

pytest.importorskip("stable_baselines3")

import gymnasium
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import (
    DummyVecEnv,
    VecCheckNan,
    VecEnvWrapper,
    VecFrameStack,
    VecMonitor,
    VecNormalize,
)

from pliant.envs import PlantEnv, scenes
from pliant.envs.environments.sb3_env import PlantVecEnv

SHORT = scenes.get("single-link-slew", duration=0.1)
REACH = scenes.get("two-link-reach")
WRAPPERS = {
    "none": lambda venv: venv,
    "monitor": VecMonitor,
    "nan": partial(VecCheckNan, raise_exception=True),
    "stack": partial(VecFrameStack, n_stack=3),
    "normalize": partial(VecNormalize, gamma=0.9),
    "all": lambda venv: VecFrameStack(VecNormalize(VecCheckNan(VecMonitor(venv)), norm_reward=False), 2),
}


def pair(scene=SHORT, lanes: int = 3, randomise: bool = True):
    """Ours, and SB3's own of single environments."""
    make = partial(PlantEnv, scene, randomise=randomise, dtype=np.float32)
    return PlantVecEnv(scene, lanes, randomise=randomise), DummyVecEnv([make] * lanes)


def alike(ours, theirs, steps: int, seed: int = 0) -> None:
    """Observations, rewards and ends step by step, and what infos say of the ends."""
    rng = np.random.default_rng(seed)
    assert np.array_equal(ours.reset(), theirs.reset())
    for _ in range(steps):
        actions = rng.uniform(-1, 1, (ours.num_envs, *ours.action_space.shape)).astype(np.float32)
        got, wanted = ours.step(actions), theirs.step(actions)
        for a, b in zip(got[:3], wanted[:3]):
            assert np.array_equal(a, b) and a.dtype == b.dtype
        for over, told, said in zip(got[2], got[3], wanted[3]):
            if not over:
                assert set(told) <= {"validity", "episode"}
                continue
            assert np.array_equal(told["terminal_observation"], said["terminal_observation"])
            for key in ("TimeLimit.truncated", "cost", "early_end_cost", "diverged", "parameters"):
                assert told[key] == said[key], key
            if "episode" in said:
                assert told["episode"]["r"] == said["episode"]["r"] and told["episode"]["l"] == said["episode"]["l"]


@pytest.mark.parametrize("name", WRAPPERS)
def test_steps_and_ends_under_every_wrapper(name) -> None:
    """test_vecenv_terminal_obs, test_vec_deterministic, monitor, normalize, nan, stack: as around SB3's own."""
    ours, theirs = (WRAPPERS[name](venv) for venv in pair())
    for venv in (ours, theirs):
        assert venv.seed(4) == [4, 5, 6]
    alike(ours, theirs, 14)
    if name != "none":
        assert ours.unwrapped.vector.scene is SHORT
    if name == "normalize":
        np.testing.assert_array_equal(ours.get_original_obs(), theirs.get_original_obs())
        np.testing.assert_array_equal(ours.obs_rms.mean, theirs.obs_rms.mean)
    ours.close()
    ours.close()


@pytest.mark.campaign
@pytest.mark.parametrize("env_id", SAMPLE)
@pytest.mark.parametrize("name", WRAPPERS)
@pytest.mark.parametrize("randomise", [False, True])
def test_whole_episodes(env_id, name, randomise) -> None:
    scene = scenes.get(gymnasium.spec(env_id).kwargs["scene"])
    ours, theirs = (WRAPPERS[name](venv) for venv in pair(scene, 2, randomise))
    for venv in (ours, theirs):
        venv.seed(1)
    alike(ours, theirs, min(scene.steps + 20, 400))


def test_seeds_and_options_are_the_lanes_and_serve_one_reset() -> None:
    """test_vec_seeding, test_vecenv options: as SB3's own, also in later episodes."""
    ours, theirs = pair(REACH)
    state = np.linspace(-0.1, 0.1, 12)
    for options in (None, {"state": state}, [{"parameters": {"payload.mass": 0.6}}, {}, {"state": state}]):
        for venv in (ours, theirs):
            venv.seed(11)
            venv.set_options(options)
        assert np.array_equal(ours.reset(), theirs.reset())
        assert [i["parameters"] for i in ours.reset_infos] == [i["parameters"] for i in theirs.reset_infos]
        assert np.array_equal(ours.reset(), theirs.reset())  # both are spent
    fresh = pair(REACH)[0]
    fresh.seed()
    assert len(set(fresh._seeds)) == 3
    with pytest.raises(ValueError, match="seed = -1 must be an integer >= 0"):
        fresh.seed(-1)


def test_options_that_are_not_ours_are_refused_at_once() -> None:
    venv = PlantVecEnv(SHORT, 2)
    for options, says in (
        ({"nonsense": 1}, "'nonsense' must be one of 'state', 'parameters'"),
        ([{}], "a list of 2"),
        ([{}, {"state": np.zeros(3)}], "shape"),
        ("state", "must be a dictionary"),
    ):
        with pytest.raises(ValueError, match=says):
            venv.set_options(options)


def test_calls_and_attributes_by_index() -> None:
    """test_vecenv_custom_calls, test_vec_env_is_wrapped: on the lanes named, or refused in words."""
    ours, theirs = pair(REACH)
    for venv in (ours, theirs):
        venv.seed(2)
        venv.reset()
        venv.set_attr("mark", 1)
        venv.set_attr("mark", 2, indices=[0, 2])
        assert venv.get_attr("mark") == [2, 1, 2] and venv.get_attr("mark", indices=1) == [1]
        assert venv.env_method("get_wrapper_attr", "mark", indices=[1, 2]) == [1, 2]
        assert venv.has_attr("mark") and not venv.has_attr("nothing")
        assert venv.env_is_wrapped(gymnasium.wrappers.TimeLimit, indices=[0, 1]) == [False, False]
    (mine,), (other,) = (venv.env_method("reset", seed=8, indices=[1]) for venv in (ours, theirs))
    assert np.array_equal(mine[0], other[0]) and mine[1]["parameters"] == other[1]["parameters"]
    states = zip(ours.get_attr("state"), theirs.get_attr("state"))
    assert all(np.array_equal(a, b) for a, b in states)
    assert ours.get_attr("time", indices=range(2)) == theirs.get_attr("time", indices=range(2))
    for call in (
        lambda: ours.env_method("close", indices=[0]),
        lambda: ours.env_method("step", np.zeros(2), indices=[0]),
        lambda: ours.set_attr("randomise", False, indices=[0]),
        lambda: ours.set_attr("scene", SHORT),
    ):
        with pytest.raises(ValueError, match=r"all lanes|is fixed"):
            call()
    for index in (3, -4, [0, 7]):
        with pytest.raises(IndexError, match="must name lanes from 0 to 2"):
            ours.get_attr("mark", indices=index)
    with pytest.raises(AttributeError):
        ours.env_method("nothing")


def test_before_reset_nothing_is_stepped() -> None:
    venv = PlantVecEnv(SHORT, 2)
    with pytest.raises(gymnasium.error.ResetNeeded, match="call reset"):
        venv.step(np.zeros((2, 1), np.float32))
    with pytest.raises(gymnasium.error.ResetNeeded):
        venv.get_attr("state")
    venv.reset()
    with pytest.raises(gymnasium.error.ResetNeeded, match="no actions wait"):
        venv.step_wait()


def test_infos_and_actions_are_each_sides_own() -> None:
    venv = PlantVecEnv(SHORT, 2)
    venv.reset()
    infos = venv.step(np.zeros((2, 1)))[3]
    infos[0]["mine"] = 1
    assert venv.step(np.zeros((2, 1)))[3] == [{}, {}] and infos[0] == {"mine": 1}
    actions = np.full((2, 1), 0.5, np.float32)
    venv.step_async(actions)
    actions[:] = np.nan  # after they were handed over
    assert np.isfinite(venv.step_wait()[0]).all()
    other = pickle.loads(pickle.dumps(venv))
    assert np.array_equal(other.step(np.ones((2, 1)))[0], venv.step(np.ones((2, 1)))[0])


def test_wrappers_find_what_is_behind_them() -> None:
    """test_vecenv_wrapper_getattr, test_vec_monitor_info_keywords, test_render without images."""

    class Plain(VecEnvWrapper):
        def reset(self):
            return self.venv.reset()

        def step_wait(self):
            return self.venv.step_wait()

    venv = VecMonitor(Plain(PlantVecEnv(SHORT, 2)), info_keywords=("diverged", "cost"))
    assert venv.vector.scene is SHORT
    venv.reset()
    for _ in range(5):
        infos = venv.step(np.zeros((2, 1), np.float32))[3]
    assert infos[0]["episode"]["diverged"] is False and infos[1]["episode"]["cost"] > 0
    with pytest.warns(UserWarning, match="no `render_mode`"):
        assert venv.render() is None
    with pytest.warns(UserWarning, match="render_mode"):
        assert venv.get_images() == [None, None]


@pytest.mark.campaign
@pytest.mark.parametrize("algorithm", ["PPO", "SAC"])
def test_policies_learn_and_are_evaluated(algorithm) -> None:
    """test_vec_monitor_ppo, offpolicy_normalization, evaluate_policy: the same mean of returns as with SB3's own."""
    import stable_baselines3

    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        ours, theirs = (VecMonitor(venv) for venv in pair())
        options = {"n_steps": 8, "batch_size": 24} if algorithm == "PPO" else {"learning_starts": 12}
        model = getattr(stable_baselines3, algorithm)("MlpPolicy", ours, seed=0, device="cpu", **options)
        model.learn(60)
        results = []
        for venv in (ours, theirs):
            venv.seed(3)
            results.append(evaluate_policy(model, venv, n_eval_episodes=6, return_episode_rewards=True))
    assert results[0] == results[1] and len(results[0][0]) == 6


def test_pictures_of_all_lanes() -> None:
    """test_video_recorder, test_render: with render_mode="rgb_array" lanes are drawn, as a single environment is."""
    venv, alone = PlantVecEnv(SHORT, 3, render_mode="rgb_array"), PlantEnv(SHORT, render_mode="rgb_array")
    venv.reset()
    alone.reset()
    venv.step(np.zeros((3, 1), np.float32))
    alone.step(np.zeros(1, np.float32))
    images = venv.get_images()
    assert len(images) == 3 and all(np.array_equal(image, alone.render()) for image in images)
    assert venv.render().shape == (2 * images[0].shape[0], 2 * images[0].shape[1], 3)  # tiled, two by two
