"""Environments whose lanes play models of different fidelity, as a user meets them: by scene, by id, by SB3."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from pliant.envs import PlantEnv, Task, scenes
from pliant.envs.environments.vector_env import PlantVectorEnv

SLEW = scenes.get("single-link-slew", duration=0.2)
WORDS = ("rigid", "linear", "own")


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ("rigid", r"must be 1 to 16 labels or plants"),
        ((), r"must be 1 to 16"),
        (("rigid", 3), r"3 must be a label of the plant's ladder, or a plant"),
        ({"rigid": 0.0}, r"Task.fidelities\['rigid'\]"),
        ({"rigid": "much"}, r"Task.fidelities\['rigid'\]"),
    ],
)
def test_what_is_refused(given, says) -> None:
    with pytest.raises(ValueError, match=says):
        Task(fidelities=given)


@pytest.mark.parametrize("mode", list(AutoresetMode))
@pytest.mark.parametrize("task", [{}, {"history": 1, "noise": 0.01, "action_delay": (0, 2), "hold": 3, "terms": True}])
def test_a_lane_plays_what_the_single_environment_of_its_seed_plays(mode, task) -> None:
    lanes = 4
    env = PlantVectorEnv(SLEW, lanes, randomise=True, fidelities=WORDS, autoreset_mode=mode, **task)
    alone = [PlantEnv(SLEW, randomise=True, fidelities=WORDS, **task) for _ in range(lanes)]
    obs, info = env.reset(seed=3)
    for lane, single in enumerate(alone):
        first, told = single.reset(seed=3 + lane)
        assert np.array_equal(first, obs[lane]) and told["fidelity"] == info["fidelity"][lane]
    labels, over = [info["fidelity"].tolist()], np.zeros(lanes, dtype=bool)
    for action in np.random.default_rng(0).uniform(-1, 1, (30, lanes, 1)):
        if mode == AutoresetMode.DISABLED and over.any():
            obs, info = env.reset(options={"reset_mask": over})
            for lane in over.nonzero()[0]:
                first, told = alone[lane].reset()
                assert np.array_equal(first, obs[lane]) and told["fidelity"] == info["fidelity"][lane]
        obs, reward, ended, late, info = env.step(action)
        for lane, single in enumerate(alone):
            if over[lane] and mode == AutoresetMode.NEXT_STEP:
                first, told = single.reset()
                assert np.array_equal(first, obs[lane]) and told["fidelity"] == info["fidelity"][lane]
                continue
            seen, r, t, u, said = single.step(action[lane])
            assert (r, t, u) == (reward[lane], ended[lane], late[lane])
            if "terms" in task:
                terms = {name: info["reward_terms"][name][lane] for name in said["reward_terms"]}
                assert terms == said["reward_terms"]
            if (t or u) and mode == AutoresetMode.SAME_STEP:
                assert info["final_info"]["fidelity"][lane] == said["fidelity"]
                assert np.array_equal(info["final_obs"][lane], seen)
                seen, told = single.reset()
                assert told["fidelity"] == info["fidelity"][lane]
            assert np.array_equal(seen, obs[lane])
        over = ended | late
        labels.append(list(env.get_attr("fidelity")))
    assert len({tuple(row) for row in labels}) > 1  # drawn anew


def test_the_reward_is_the_scenes_own_cost_whatever_is_played() -> None:
    """At rest at the goal's angles, each model pays for what the scene's cost says of its own signals and inputs."""
    env = PlantVectorEnv("two-link-reach", 3, fidelities=WORDS)
    env.reset(options={"fidelity": WORDS})
    assert env.get_attr("fidelity")[0] == "rigid" and env.call("fidelity")[2] == env.scene.plant.label
    action = np.full((3, 2), 0.25)
    states = env.get_attr("state")
    seen, reward, *_ = env.step(action)
    single = PlantEnv("two-link-reach", fidelities=WORDS)  # measured from the same goal
    for lane, word in enumerate(WORDS):
        single.reset(options={"fidelity": word})
        alone, paid, *_ = single.step(action[lane])
        assert np.array_equal(alone, seen[lane]) and paid == reward[lane]
    scene, u = env.scene, 0.25 * np.array(env.scene.limits)
    for lane, x in enumerate(states):
        plant = env._mixture.scenes[lane].plant
        z = env._mixture.scenes[lane].signal_values(x, plant.measure(x, u), scene.weighted)
        off = z - scene.goal_values(scene.weighted), u - scene.target[1]
        rate = sum(c * e**2 for (_, c), e in zip((*scene.weights, *scene.effort), np.concatenate(off)))
        assert -reward[lane] == pytest.approx(scene.dt * rate, rel=1e-9)


def test_by_id_with_gymnasiums_checker_and_by_json() -> None:
    env = gymnasium.make("pliant/SingleLinkSlew-v0", fidelities={"rigid": 1.0, "own": 3.0}, max_episode_steps=10)
    check_env(env.unwrapped, skip_render_check=True)
    again = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    assert again.unwrapped.task == env.unwrapped.task
    venv = gymnasium.make_vec("pliant/SingleLinkSlew-v0", num_envs=8, fidelities=WORDS)
    assert set(venv.reset(seed=0)[1]["fidelity"]) == {"rigid", "linear, payload 2", "stiffened, payload 2"}


@pytest.mark.parametrize("options", [{"state": np.zeros(6)}, {"fidelity": "strain"}, {"fidelity": 1}])
def test_options_that_a_mixture_cannot_take(options) -> None:
    for env in (PlantEnv(SLEW, fidelities=WORDS), PlantVectorEnv(SLEW, 2, fidelities=WORDS)):
        with pytest.raises(ValueError, match="must be one of"):
            env.reset(options=options)


def test_pictures_are_of_the_model_that_is_played() -> None:
    env = PlantVectorEnv(SLEW, 2, fidelities=("rigid", "own"), render_mode="rgb_array")
    env.reset(options={"fidelity": ("rigid", "own")})
    assert len(env.render()) == 2
    env.reset(options={"fidelity": "own"})
    first, second = env.render()
    assert np.array_equal(first, second)
    single = PlantEnv(SLEW, fidelities=("rigid", "own"), render_mode="rgb_array")
    for word in ("rigid", "own"):
        single.reset(options={"fidelity": word})
        assert single.render().shape[2] == 3


def test_sb3_tells_the_fidelity_of_what_ended() -> None:
    pytest.importorskip("stable_baselines3")
    venv = SLEW.sb3_env(4, randomise=True, fidelities=WORDS)
    venv.seed(0)
    venv.reset()
    before = [info["fidelity"] for info in venv.reset_infos]
    assert before == [str(label) for label in venv.get_attr("fidelity")]
    for _ in range(SLEW.steps):
        _, _, done, infos = venv.step(np.zeros((4, 1), np.float32))
    assert done.all() and [info["fidelity"] for info in infos] == before
    venv.set_options({"fidelity": "linear"})
    venv.reset()
    assert set(venv.get_attr("fidelity")) == {"linear, payload 2"}
