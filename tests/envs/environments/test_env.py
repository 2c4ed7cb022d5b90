"""Every registered environment: Gymnasium's and SB3's checkers, reproducibility, ends, rewards, drawing."""

import dataclasses
import itertools
import pickle
import random
import warnings

import gymnasium
import numpy as np
import pytest
from env_cases import IDS, SAMPLE, SAMPLED, play
from gymnasium.utils.env_checker import check_env

from pliant.envs import PlantEnv, scenes
from pliant.envs.scenes.scene import Scene
from pliant.plants import PliantError, StabilityLimitError
from pliant.plants.core import parameters


def gentle(scene: Scene, seed: int = 0, size: float = 0.05) -> np.ndarray:
    """Small random actions (steps, nu) that no bound minds."""
    return np.random.default_rng(seed).uniform(-size, size, (scene.steps, scene.plant.nu)).astype(np.float32)


def test_ids() -> None:
    assert {"pliant/SingleLinkSlew-v0", "pliant/TwoLinkReach-v0"} <= set(IDS)
    for env_id in IDS:
        assert gymnasium.spec(env_id).vector_entry_point == "pliant.envs.environments.vector_env:PlantVectorEnv"
    assert gymnasium.make("pliant.envs:pliant/TwoLinkReach-v0").unwrapped.scene.name == "two-link-reach"


@pytest.mark.every(2)
@pytest.mark.parametrize(
    ("env_id", "randomise"),
    [*((env_id, True) for env_id in IDS), *(pytest.param(i, False, marks=pytest.mark.campaign) for i in SAMPLE)],
)
def test_gymnasium_checker(env_id: str, randomise: bool) -> None:
    env = gymnasium.make(env_id, randomise=randomise)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*Box observation space m.* value is")  # signals have no range
        warnings.filterwarnings("ignore", message=".*non-interactive")  # human mode without a screen
        warnings.filterwarnings("ignore", message=".*different from the unwrapped version")
        check_env(env.unwrapped)


@pytest.mark.parametrize("env_id", SAMPLED)
@pytest.mark.parametrize("dtype", ["float32", pytest.param("float64", marks=pytest.mark.campaign)])
def test_stable_baselines_checker(env_id: str, dtype: str) -> None:
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        checker.check_env(gymnasium.make(env_id, randomise=True, dtype=dtype).unwrapped)


@pytest.mark.every(3)
@pytest.mark.parametrize("env_id", IDS)
def test_same_seed_same_bits_and_no_global_randomness(env_id: str) -> None:
    random.seed(5)
    np.random.seed(5)  # noqa: NPY002
    before = random.getstate(), np.random.get_state()  # noqa: NPY002
    rolls = []
    for seed in (7, 7, 8):
        env = gymnasium.make(env_id, randomise=True)
        obs, info = env.reset(seed=seed)
        steps = play(env, gentle(env.unwrapped.scene))
        again, after = env.reset()  # a second episode draws on
        assert after["parameters"] != info["parameters"]
        spread = env.unwrapped.scene.start_spread > 0
        assert (again != obs).any() or not spread
        drawn = (obs, again) if spread else ()
        rolls.append((*drawn, info["parameters"], np.array([s[0] for s in steps]), [s[1] for s in steps]))
    for a, b, c in zip(*rolls):
        np.testing.assert_equal(a, b)
        assert not np.array_equal(a, c) if isinstance(a, np.ndarray) else a != c
    assert random.getstate() == before[0]
    np.testing.assert_equal(np.random.get_state(), before[1])  # noqa: NPY002


@pytest.mark.parametrize("env_id", SAMPLED)
def test_return_is_minus_the_scenes_cost_of_the_same_motion(env_id: str) -> None:
    env = gymnasium.make(env_id)
    scene = env.unwrapped.scene
    obs, _ = env.reset(seed=0)
    x0, actions = env.unwrapped.state, gentle(scene, size=0.1)
    steps = play(env, actions)
    assert len(steps) == scene.steps and steps[-1][3] and not steps[-1][2]

    u = np.vstack([actions, actions[-1:]]).astype(float) * scene.limits
    motion = scene.plant.simulate(x0, u, scene.times, method="rk4", step=scene.dt / scene.substeps)
    np.testing.assert_allclose(env.unwrapped.state, motion.x[-1], rtol=1e-10, atol=1e-12)
    assert -sum(s[1] for s in steps) == pytest.approx(scene.cost(motion), rel=1e-10)
    shown = np.array([obs, *(s[0] for s in steps)])
    goals = scene.goal_values(scene.observe) + np.outer(motion.t, scene.goal_drift(scene.observe))
    wanted = np.column_stack([motion[name] for name in scene.observe]) - goals
    np.testing.assert_allclose(shown, wanted, rtol=1e-9, atol=1e-11)
    assert all(s[4]["cost"] == -s[1] and s[4]["early_end_cost"] == 0.0 for s in steps)


@pytest.mark.every(2)
@pytest.mark.parametrize("env_id", SAMPLED)
def test_drawn_parameters_are_those_simulated(env_id: str) -> None:
    """The plant with the drawn numbers written into it moves as the environment does."""
    scene = gymnasium.make(env_id).unwrapped.scene
    if getattr(scene.plant, "basis", "") == "payload":  # then the drawn payload would change the shape functions
        scene = scene.with_plant(dataclasses.replace(scene.plant, basis="clamped-free"))
    env = PlantEnv(scene, randomise=True)
    _, info = env.reset(seed=3)
    plant, x0, actions = scene.plant, env.state, gentle(scene)[:20]
    for path, low, high in scene.randomise:
        own, value = parameters.get(plant, path), info["parameters"][path]
        assert low * own <= value <= high * own and value != own
        plant = parameters.put(plant, path, value)
    held = {name: x0[scene.positions([name])[0]] for name, _ in scene.start}
    assert all((held[name] != own) == (size > 0) for (name, own), size in zip(scene.start, scene.spread))
    given = dataclasses.replace(scene, start=tuple(held.items()))
    wanted = plant.equilibrium(held)[0] if scene.start_at_rest else given.initial[0]
    np.testing.assert_allclose(x0, wanted, atol=1e-10)

    play(env, actions)
    u = np.vstack([actions, actions[-1:]]).astype(float) * scene.limits
    motion = plant.simulate(x0, u, scene.times[:21], method="rk4", step=scene.dt / scene.substeps)
    np.testing.assert_allclose(env.state, motion.x[-1], rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("env_id", IDS)
def test_actions_scale_and_clip(env_id: str) -> None:
    env = gymnasium.make(env_id).unwrapped
    scene = env.scene
    after = {}
    for size in (1.0, 3.0, -1.0, -50.0):
        env.reset()
        after[size] = env.step(np.full(scene.plant.nu, size))
    np.testing.assert_array_equal(after[1.0][0], after[3.0][0])
    np.testing.assert_array_equal(after[-1.0][0], after[-50.0][0])
    assert after[1.0][1] == after[3.0][1]
    x0, u = scene.initial[0], np.array(scene.limits)
    y = scene.plant.measure(x0, u)
    assert after[1.0][1] == pytest.approx(-scene.dt * scene.stage_cost(x0, u, y), rel=1e-12)


@pytest.mark.every(3)
@pytest.mark.parametrize("env_id", IDS)
def test_time_limit_truncates_once(env_id: str) -> None:
    name = gymnasium.spec(env_id).kwargs["scene"]
    short = 5 * scenes.get(name).dt
    env = gymnasium.make(env_id, scene=scenes.get(name, duration=short))
    assert env.spec.max_episode_steps == 5 and "TimeLimit" not in str(env)
    assert gymnasium.make(env_id).spec.max_episode_steps == scenes.get(name).steps
    env.reset(seed=0)
    steps = play(env, np.zeros((20, env.unwrapped.scene.plant.nu), np.float32))
    assert [s[2] for s in steps] == [False] * 5 and [s[3] for s in steps] == [False] * 4 + [True]
    assert env.unwrapped.time == pytest.approx(short)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(env.action_space.sample())


def within_reach(scene: Scene) -> Scene:
    """The scene with every bound at most nine tenths of what some constant full input reaches."""
    reached = np.zeros(len(scene.bounds))
    levels = list(itertools.product((-1.0, 1.0), repeat=scene.plant.nu))
    for level in levels[:: max(1, len(levels) // 8)]:
        u = np.tile(np.multiply(level, scene.limits), (scene.steps + 1, 1))
        try:
            motion = scene.plant.simulate(
                scene.initial[0], u, scene.times, method="rk4", step=scene.dt / scene.substeps
            )
        except PliantError:  # this far that the model itself ends
            return scene
        reached = np.maximum(reached, [np.abs(motion[name]).max() for name, _ in scene.bounds])
    bounds = tuple((name, min(bound, 0.9 * most)) for (name, bound), most in zip(scene.bounds, reached))
    return dataclasses.replace(scene, bounds=bounds)


@pytest.mark.every(2)
@pytest.mark.parametrize("env_id", SAMPLED)
def test_leaving_the_bounds_ends_the_episode_and_does_not_pay(env_id: str) -> None:
    env = PlantEnv(within_reach(gymnasium.make(env_id).unwrapped.scene))
    scene = env.scene
    env.reset()
    idle = sum(s[1] for s in play(env, np.zeros((scene.steps, scene.plant.nu))))
    ended = 0
    for seed in range(12):
        level = np.random.default_rng(seed).choice([-1.0, 1.0], scene.plant.nu)
        env.reset()
        steps = play(env, np.tile(level, (scene.steps, 1)))
        if not steps[-1][2] or steps[-1][4]["diverged"]:  # three links may lose their mass matrix first
            continue
        ended += 1
        left = scene.steps - len(steps)
        motion = env.scene.plant.measure(env.state)
        signals = dict(zip((s.name for s in scene.signals), np.concatenate([env.state, motion])))
        assert any(abs(signals[name]) > bound for name, bound in scene.bounds)
        assert not steps[-1][3] and not steps[-1][4]["diverged"]
        early, cost = steps[-1][4]["early_end_cost"], steps[-1][4]["cost"]
        assert early == pytest.approx(left * (scene.dt * scene.early_end_rate + cost - early), rel=1e-9)
        assert sum(s[1] for s in steps) < idle
    assert ended


def test_divergence_ends_the_episode_without_a_nan() -> None:
    env = PlantEnv(scenes.get("single-link-slew", bounds=()))
    state = np.zeros(env.scene.plant.nx)
    state[env.scene.plant.nx // 2 + 1] = 1e11  # a mode's rate
    first, _ = env.reset(options={"state": state})
    obs, reward, terminated, truncated, info = env.step(np.zeros(1))
    while not terminated:
        first = obs
        obs, reward, terminated, truncated, info = env.step(np.zeros(1))
    assert info["diverged"] and not truncated
    np.testing.assert_array_equal(obs, first)
    assert np.isfinite(obs).all() and np.isfinite(env.state).all() and np.isfinite(reward)
    assert reward < 0 and info["early_end_cost"] > 0


def test_options_set_state_and_parameters() -> None:
    env = PlantEnv("two-link-reach", randomise=True)
    state = np.linspace(-0.1, 0.1, 12)
    _, info = env.reset(seed=0, options={"state": state, "parameters": {"payload.mass": 0.7}})
    np.testing.assert_array_equal(env.state, state)
    assert info["parameters"] == {"payload.mass": 0.7}
    env.state[0] = 9.0
    assert env.state[0] == -0.1
    for options, says in (
        ({"stat": state}, "stat"),
        ({"state": state[:3]}, "shape"),
        ({"state": np.full(12, np.nan)}, "finite"),
        ({"parameters": {"payload.weight": 1.0}}, "payload.weight"),
        ({"parameters": {"payload.mass": -1.0}}, "mass"),
    ):
        with pytest.raises(ValueError, match=says):
            env.reset(options=options)


def test_bad_input_is_named() -> None:
    for options, says in (
        ({"scene": "moon-shot"}, "moon-shot"),
        ({"scene": "two-link-reach", "dtype": "int32"}, "int32"),
        ({"scene": "two-link-reach", "render_mode": "ascii"}, "ascii"),
        ({"scene": scenes.get("two-link-reach", observe=())}, "observe"),
    ):
        with pytest.raises(ValueError, match=says):
            PlantEnv(**options)
    env = PlantEnv("two-link-reach")
    env.reset()
    for action in (np.zeros(3), 0.0, [np.nan, 0.0], [np.inf, 0.0]):
        with pytest.raises(ValueError, match="action"):
            env.step(action)
    with pytest.raises(StabilityLimitError):
        PlantEnv(scenes.get("two-link-reach", substeps=1))


def test_environment_travels_between_processes() -> None:
    env = PlantEnv("single-link-slew", randomise=True)
    env.reset(seed=1)
    other = pickle.loads(pickle.dumps(env))
    for _ in range(3):
        np.testing.assert_array_equal(env.step(np.ones(1))[0], other.step(np.ones(1))[0])


def test_reward_by_hand() -> None:
    """The documented table's weights at a supplied state and a quarter of the torque limit."""
    env = PlantEnv("single-link-slew")
    x = np.zeros(6)
    x[0], x[3] = 0.7, -0.2
    env.reset(options={"state": x})
    reward = env.step(np.array([0.25]))[1]
    assert reward == pytest.approx(-0.02 * (10 * 0.3**2 + 0.1 * 0.2**2 + 2e-3 * 10.0**2), rel=1e-12)
