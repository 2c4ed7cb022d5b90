"""The vector environment against the single one, lane by lane, and its own rules: autoreset, seeds, divergence."""

import dataclasses

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import pliant.envs  # noqa: F401  (registers the ids)
from pliant.envs import scenes
from pliant.envs.environments.env import PlantEnv
from pliant.envs.environments.registration import environment_id
from pliant.envs.environments.vector_env import PlantVectorEnv

NAMES = scenes.names()
IDS = [environment_id(name) for name in NAMES]


def actions(scene, steps: int, lanes: int, seed: int = 0, size: float = 0.3) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-size, size, (steps, lanes, scene.plant.nu)).astype(np.float32)


@pytest.mark.parametrize("env_id", IDS)
def test_make_vec_gives_the_native_vector_environment(env_id: str) -> None:
    venv = gymnasium.make_vec(env_id, num_envs=5)
    assert isinstance(venv.unwrapped, PlantVectorEnv)
    obs, _ = venv.reset(seed=1)
    assert venv.observation_space.contains(obs)
    assert venv.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    obs, rewards, terminated, truncated, infos = venv.step(venv.action_space.sample())
    assert venv.observation_space.contains(obs)
    assert rewards.shape == terminated.shape == truncated.shape == (5,)
    assert terminated.dtype == truncated.dtype == bool and infos == {}


@pytest.mark.every(4)
@pytest.mark.parametrize("randomise", [False, True])
@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("name", NAMES)
def test_one_lane_equals_the_single_environment_bit_for_bit(name: str, randomise: bool, dtype: str) -> None:
    scene = scenes.get(name)
    gusts = tuple((s.name, 0.5) for s in scene.plant.disturbances)
    scene = dataclasses.replace(scene, duration=25 * scene.dt, gusts=gusts)
    single = PlantEnv(scene, randomise=randomise, dtype=dtype)
    vector = PlantVectorEnv(scene, 1, randomise=randomise, dtype=dtype)
    a, _ = single.reset(seed=3)
    b, _ = vector.reset(seed=3)
    assert np.array_equal(a, b[0])
    over = False
    for k, action in enumerate(actions(scene, 60, 1, size=1.0)):
        if over:
            a, _ = single.reset()
            reward, terminated, truncated = 0.0, False, False
        else:
            a, reward, terminated, truncated, _ = single.step(action[0])
        b, rewards, t, u, _ = vector.step(action)
        assert np.array_equal(a, b[0]), k
        assert (reward, terminated, truncated) == (rewards[0], t[0], u[0])
        assert np.array_equal(single.state, vector.states[0])
        over = terminated or truncated


@pytest.mark.parametrize("name", NAMES)
def test_a_lanes_result_depends_neither_on_its_place_nor_on_the_batch(name: str) -> None:
    """Lanes with the same action and start move alike, whatever stands beside them."""
    scene = scenes.get(name)
    script = actions(scene, 40, 1)
    paths = []
    for lanes, place in ((1, 0), (13, 12), (640, 301)):
        vector = PlantVectorEnv(scene, lanes)
        vector.reset(seed=0)
        others = actions(scene, 40, lanes, seed=lanes, size=0.2)
        path = []
        for mine, theirs in zip(script, others):
            theirs[place] = mine[0]
            path.append(vector.step(theirs)[0][place])
        paths.append(np.array(path))
    assert np.array_equal(paths[0], paths[1])
    assert np.array_equal(paths[0], paths[2])


@pytest.mark.every(3)
@pytest.mark.parametrize("name", NAMES)
def test_lanes_have_their_own_parameters(name: str) -> None:
    vector = PlantVectorEnv(name, 6, randomise=True)
    vector.reset(seed=5)
    scene, p = vector.scene, vector._step.p.T.copy()
    assert len(np.unique(p[:, 0])) == 6
    x0, script = vector.states, actions(scene, 5, 6)
    for action in script:
        vector.step(action)
    for lane in range(6):
        u = np.vstack([script[:, lane], script[-1:, lane]]).astype(float) * scene.limits
        motion = scene.varied_plant.simulate(
            x0[lane], u, scene.times[:6], p=p[lane], method="rk4", step=scene.dt / scene.substeps
        )
        np.testing.assert_allclose(vector.states[lane], motion.x[-1], rtol=1e-9, atol=1e-11)


@pytest.mark.campaign
def test_gusts_push_the_lanes() -> None:
    scene = scenes.get("two-link-reach", gusts=(("tip_force_y", 2.0),), start_spread=0.0, randomise=())
    vector = PlantVectorEnv(scene, 8, randomise=True)
    vector.reset(seed=0)
    w = vector._step.w.T.copy()
    assert (w[:, 0] == 0).all() and (np.abs(w[:, 1]) <= 2.0).all() and len(np.unique(w[:, 1])) == 8
    x0 = vector.states[2]
    vector.step(np.zeros((8, 2), dtype=np.float32))
    want = scene.plant.simulate(x0, None, scene.times[:2], w=w[2], method="rk4", step=scene.dt / scene.substeps)
    np.testing.assert_allclose(vector.states[2], want.x[-1], rtol=1e-9, atol=1e-12)


@pytest.mark.every(2)
@pytest.mark.parametrize("mode", list(AutoresetMode))
@pytest.mark.parametrize("name", NAMES)
def test_autoreset_modes(name: str, mode: AutoresetMode) -> None:
    scene = scenes.get(name, duration=10 * scenes.get(name).dt)
    vector = PlantVectorEnv(scene, 3, randomise=True, autoreset_mode=mode)
    first, drawn = vector.reset(seed=0)[0], vector._step.p.copy()
    still = np.full((3, scene.plant.nu), 0.1, dtype=np.float32)
    for k in range(scene.steps):
        obs, rewards, terminated, truncated, infos = vector.step(still)
        assert not terminated.any() and (truncated == (k == scene.steps - 1)).all()
    assert (rewards < 0).all() and infos["_diverged"].all() and not infos["diverged"].any()
    if mode == AutoresetMode.SAME_STEP:
        assert infos["_final_obs"].all()
        assert not np.array_equal(infos["final_obs"], obs)
        assert (vector._step.p != drawn).any()  # drawn anew
        assert (obs != first).any() == (scene.start_spread > 0 or bool(scene.spreads))
        assert not vector.step(still)[3].any()
    elif mode == AutoresetMode.NEXT_STEP:
        fresh, rewards, terminated, truncated, _ = vector.step(still)
        assert (rewards == 0).all() and not terminated.any() and not truncated.any()
        assert not np.array_equal(fresh, obs)
        for k in range(scene.steps):
            truncated = vector.step(still)[3]
            assert (truncated == (k == scene.steps - 1)).all()
    else:
        with pytest.raises(gymnasium.error.ResetNeeded, match="lane 0 is over"):
            vector.step(still)
        again, _ = vector.reset(options={"reset_mask": np.array([True, False, True])})
        assert np.array_equal(again[1], obs[1]) and not np.array_equal(again[0], obs[0])
        with pytest.raises(gymnasium.error.ResetNeeded, match="lane 1 is over"):
            vector.step(still)


def test_a_diverged_lane_ends_alone_and_shows_no_nan() -> None:
    scene = scenes.get("single-link-slew", bounds=())
    vector, alone = PlantVectorEnv(scene, 9), PlantVectorEnv(scene, 9)
    vector.reset(seed=0)
    alone.reset(seed=0)
    script = actions(scene, 30, 9)
    vector._step.x[4, 5] = 1e11  # one lane's mode runs away
    ended = 0
    for action in script:
        before = vector._obs.copy()
        obs, rewards, terminated, _, infos = vector.step(action)
        want = alone.step(action)[0]
        assert np.isfinite(obs).all() and np.isfinite(rewards).all()
        others = np.arange(9) != 5
        assert np.array_equal(obs[others], want[others])
        if terminated.any():
            ended += 1
            assert terminated.tolist() == [k == 5 for k in range(9)]
            assert infos["diverged"][5] and np.array_equal(obs[5], before[5])
    assert ended == 1


@pytest.mark.parametrize("name", NAMES)
def test_seeds_reproduce_bit_for_bit(name: str) -> None:
    state = np.random.get_state()  # noqa: NPY002
    rolls = []
    for seed in (4, 4, 5):
        vector = PlantVectorEnv(name, 12, randomise=True)
        obs = [vector.reset(seed=seed)[0]]
        obs += [vector.step(a)[0] for a in actions(vector.scene, 60, 12, size=1.0)]
        rolls.append(np.array(obs))
    assert np.array_equal(rolls[0], rolls[1])
    assert not np.array_equal(rolls[0], rolls[2])
    np.testing.assert_equal(np.random.get_state(), state)  # noqa: NPY002


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda v: v.step(np.zeros((2, 2))), r"actions have shape \(2, 2\), must be \(3, 2\)"),
        (lambda v: v.step(np.array([[0, 0], [0, np.nan], [0, 0]])), r"actions\[1\] = .*nan.* must be finite"),
        (lambda v: v.reset(seed=[1, 2]), "seed of length 2 must be one integer, None, or 3 of them"),
        (lambda v: v.reset(options={"mask": 1}), "'mask' must be one of 'reset_mask'"),
        (lambda v: v.reset(options={"reset_mask": np.ones(2, dtype=bool)}), "reset_mask of bool"),
        (lambda v: PlantVectorEnv("two-link-reach", 0), "num_envs = 0 must be an integer from 1"),
        (lambda v: PlantVectorEnv("two-link-reach", 2, dtype="int8"), "'int8' must be one of"),
    ],
)
def test_bad_input_is_named(call, says: str) -> None:
    vector = PlantVectorEnv("two-link-reach", 3)
    vector.reset(seed=0)
    with pytest.raises(ValueError, match=says):
        call(vector)
