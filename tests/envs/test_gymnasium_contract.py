"""What Gymnasium 1.4's own tests ask of environments (tests/envs) and of vector environments (tests/vector), of ours.

Written anew after what those tests ask; each test here names what it stands for. Not ours, and why:

- rules of its own classes: the import of pygame, physics and maps of its games, the registry's parsing of names,
  `action_space` that are no Box (discrete, dictionary, tuple, graph, text), functional and JAX environments;
- AsyncVectorEnv's processes: time-outs, shared memory, calls out of order, errors in a worker, `copy=False`,
  `observation_mode`, custom spaces: one kernel steps all lanes, there is no process nor a list of environments;
- `AsyncVectorEnv.close(timeout=, terminate=)`: nothing runs that could be waited for;
- lanes of different sizes, and infos merged from different keys: all lanes are of one scene;
- final_obs as an array of objects, None where no episode ended: here it is one array, whose rows without an end are the
  observations themselves, as `_final_obs` tells; with "SameStep" the costs of an end also stand beside final_info.
"""

import pickle
import warnings
from functools import partial

import gymnasium
import numpy as np
import pytest
from env_cases import IDS, SAMPLE
from gymnasium import wrappers
from gymnasium.utils.env_checker import check_env, data_equivalence
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv

from pliant.envs import PlantEnv, scenes
from pliant.envs.environments.vector_env import PlantVectorEnv

MODES = list(AutoresetMode)
EXPECTED = (  # signals have no range; no screen here; wrappers that make spaces of less precision
    ".*Box observation space m.* value is",
    ".*non-interactive",
    ".*precision lowered by casting",
)
every_id = pytest.mark.parametrize(
    "env_id", [IDS[0], *(pytest.param(env_id, marks=pytest.mark.campaign) for env_id in IDS[1:])]
)
every_mode = pytest.mark.parametrize("mode", MODES, ids=[m.value for m in MODES])


@pytest.fixture(autouse=True)
def strict():
    """Any warning but the expected is a fault."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for message in EXPECTED:
            warnings.filterwarnings("ignore", message=message)
        yield


def short(env_id: str, periods: int = 6):
    scene = gymnasium.spec(env_id).kwargs["scene"]
    return scenes.get(scene, duration=periods * scenes.get(scene).dt)


@every_id
@pytest.mark.parametrize("randomise", [False, True])
def test_the_checker_is_content(env_id, randomise) -> None:
    """test_all_env_api: as made, and bare; test_all_env_passive_env_checker: steps under the passive one."""
    bare = PlantEnv(gymnasium.spec(env_id).kwargs["scene"], randomise=randomise)
    check_env(bare, skip_render_check=True)
    env = gymnasium.make(env_id, randomise=randomise, disable_env_checker=False)
    assert "PassiveEnvChecker" in str(env)
    env.reset(seed=1)
    env.step(env.action_space.sample())
    env.close()


@every_id
def test_two_of_one_seed_are_alike_and_so_are_their_pickles(env_id) -> None:
    """test_env_determinism_rollout, test_pickle_env; and spaces seeded alike sample alike."""
    one, two = (gymnasium.make(env_id, randomise=True, disable_env_checker=True) for _ in range(2))
    assert data_equivalence(one.reset(seed=0), two.reset(seed=0))
    one.action_space.seed(0)
    two.action_space.seed(0)
    third = pickle.loads(pickle.dumps(one))
    for _ in range(20):
        action = one.action_space.sample()
        assert data_equivalence(action, two.action_space.sample())
        found = one.step(action)
        assert data_equivalence(found, two.step(action)) and data_equivalence(found, third.step(action), exact=True)
        assert one.observation_space.contains(found[0]) and isinstance(found[2], bool) and isinstance(found[3], bool)
        if found[2] or found[3]:
            assert data_equivalence(one.reset(), two.reset())
            break


@pytest.mark.campaign
@pytest.mark.parametrize("env_id", IDS)
def test_render_modes(env_id) -> None:
    """test_render_modes: every mode declared is made and drawn; pprint_registry lists the id."""
    spec = gymnasium.spec(env_id)
    assert env_id in gymnasium.pprint_registry(disable_print=True)
    env = gymnasium.make(env_id, render_mode="rgb_array")
    env.reset(seed=0)
    image = env.render()
    assert image.ndim == 3 and image.shape[2] == 3 and image.dtype == np.uint8
    env.step(env.action_space.sample())
    later = env.render()
    assert later is not image and later.shape == image.shape
    env.close()
    env.close()
    with pytest.raises(ValueError, match="render_mode"):
        PlantEnv(spec.kwargs["scene"], render_mode="ansi")
    listed = gymnasium.make(env_id, render_mode="rgb_array_list")
    listed.reset(seed=0)
    assert len(listed.render()) == 1
    listed.close()


@every_id
def test_specifications_make_the_same_environment(env_id) -> None:
    """test_env_spec: to JSON and back, made of a spec, with wrappers; the registered one is left as it was."""
    registered = gymnasium.spec(env_id).to_json()
    env = wrappers.NormalizeObservation(gymnasium.make(env_id))
    again = gymnasium.make(env.spec)
    assert again.spec == env.spec and "NormalizeObservation" in str(again)
    assert gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json())).spec == env.spec
    assert gymnasium.spec(env_id).to_json() == registered
    assert env.spec.pprint(disable_print=True)


@every_id
@every_mode
@pytest.mark.parametrize("randomise", [False, True])
def test_lanes_equal_environments_one_after_the_other(env_id, mode, randomise) -> None:
    """test_vector_env_equal, determinism, final_obs, info: bit for bit what SyncVectorEnv of single ones returns."""
    scene, lanes = short(env_id), 3
    ours = PlantVectorEnv(scene, lanes, randomise=randomise, autoreset_mode=mode)
    sync = SyncVectorEnv([partial(PlantEnv, scene, randomise=randomise)] * lanes, autoreset_mode=mode)
    assert (ours.observation_space, ours.action_space) == (sync.observation_space, sync.action_space)
    assert ours.single_observation_space == sync.single_observation_space and ours.metadata["autoreset_mode"] == mode
    rng = np.random.default_rng(1)
    compared(ours.reset(seed=5), sync.reset(seed=5))
    for k in range(20):
        actions = rng.uniform(-1, 1, ours.action_space.shape).astype(np.float32)
        got, wanted = ours.step(actions), sync.step(actions)
        for a, b in zip(got[:4], wanted[:4]):
            assert np.array_equal(a, b) and a.dtype == b.dtype
        over = got[2] | got[3]
        if over.any():
            told, said = (
                found[4]["final_info"] if mode == AutoresetMode.SAME_STEP else found[4] for found in (got, wanted)
            )
            for key in ("cost", "early_end_cost", "diverged"):
                assert np.array_equal(told[key][over], said[key][over]) and told[f"_{key}"].tolist() == over.tolist()
            for name in said["parameters"]:
                assert np.array_equal(told["parameters"][name][over], said["parameters"][name][over])
            if mode == AutoresetMode.SAME_STEP:
                assert np.array_equal(got[4]["final_obs"][over], np.stack(wanted[4]["final_obs"][over]))
                assert got[4]["_final_obs"].tolist() == got[4]["_final_info"].tolist() == over.tolist()
            if mode == AutoresetMode.DISABLED:
                seeds = [None, k, None]
                compared(
                    ours.reset(seed=seeds, options={"reset_mask": over}),
                    sync.reset(seed=seeds, options={"reset_mask": over}),
                )


def compared(got, wanted) -> None:
    """Observations, and the parameters of lanes that start."""
    assert np.array_equal(got[0], wanted[0]) and got[0].dtype == wanted[0].dtype
    for name, values in wanted[1]["parameters"].items():
        mask = wanted[1]["_parameters"]
        assert np.array_equal(got[1]["parameters"][name][mask], values[mask])


@pytest.mark.campaign
@every_mode
@pytest.mark.parametrize("context", ["fork", "spawn"])
def test_single_ones_work_in_processes(mode, context) -> None:
    """test_vector_env_equal: AsyncVectorEnv, in shared memory, against the lanes of one kernel."""
    scene = short(IDS[0])
    ours = PlantVectorEnv(scene, 3, randomise=True, autoreset_mode=mode)
    work = AsyncVectorEnv([partial(PlantEnv, scene, randomise=True)] * 3, context=context, autoreset_mode=mode)
    try:
        compared(ours.reset(seed=5), work.reset(seed=5))
        for _ in range(5):
            actions = ours.action_space.sample()
            for a, b in zip(ours.step(actions)[:4], work.step(actions)[:4]):
                assert np.array_equal(a, b)
    finally:
        work.close()


def test_partial_resets_are_refused_in_words() -> None:
    """test_partial_reset_failure: masks of another kind, shape or without a lane; the caller's options stay."""
    vector = PlantVectorEnv(short(IDS[0]), 3, autoreset_mode="Disabled")
    vector.reset(seed=0)
    options = {"reset_mask": np.array([True, False, True])}
    vector.reset(options=options)
    assert list(options) == ["reset_mask"]
    for mask in (np.ones(2, bool), np.ones((3, 1), bool), np.zeros(3, bool), np.ones(3, int), "all"):
        with pytest.raises(ValueError, match="reset_mask"):
            vector.reset(options={"reset_mask": mask})


def test_random_numbers_are_the_environments_own() -> None:
    """test_random_seeding_basics, test_random_seeds_set_at_retrieval."""
    one, two = (PlantVectorEnv(short(IDS[0]), 3) for _ in range(2))
    one.reset(seed=3)
    two.reset(seed=3)
    assert one.np_random_seed == two.np_random_seed == 3
    assert one.np_random.random() == two.np_random.random()
    fresh = PlantVectorEnv(short(IDS[0]), 3)
    assert fresh.np_random_seed is not None and fresh.np_random is fresh.np_random
    single = PlantEnv(short(IDS[0]))
    single.reset(seed=3)
    assert single.np_random_seed == 3


def test_attributes_and_calls() -> None:
    """test_call_sync_vector_env, test_set_attr_sync_vector_env, test_create, repr, close."""
    vector = gymnasium.make_vec(IDS[0], num_envs=3)
    assert repr(vector) == f"PlantVectorEnv({IDS[0]}, num_envs=3)" and vector.num_envs == 3
    vector.reset(seed=0)
    vector.set_attr("mark", [0, 1, 2])
    assert vector.get_attr("mark") == (0, 1, 2) == vector.call("mark")
    assert len(vector.call("state")) == 3 and vector.call("get_wrapper_attr", "time") == (0.0,) * 3
    assert vector.unwrapped is vector and not vector.closed
    vector.close()
    assert vector.closed
    vector.close()


WRAPPED = {
    "statistics": wrappers.vector.RecordEpisodeStatistics,
    "observations": wrappers.vector.NormalizeObservation,
    "rewards": wrappers.vector.NormalizeReward,
    "actions": wrappers.vector.ClipAction,
    "rescaled": partial(wrappers.vector.RescaleAction, min_action=-2.0, max_action=2.0),
    "clipped": partial(wrappers.vector.ClipReward, min_reward=-1.0, max_reward=0.0),
    "float32": partial(wrappers.vector.DtypeObservation, dtype=np.float32),
    "flat": wrappers.vector.FlattenObservation,
    "transformed": partial(wrappers.vector.TransformReward, func=lambda r: 2 * r),
    "lists": wrappers.vector.DictInfoToList,
}


@pytest.mark.parametrize("name", WRAPPED)
@pytest.mark.parametrize(
    "mode", [AutoresetMode.NEXT_STEP, *(pytest.param(m, marks=pytest.mark.campaign) for m in MODES[1:2])]
)
def test_wrappers_of_vector_environments(name, mode) -> None:
    """tests/wrappers/vector, test_vector_wrapper: what holds around SyncVectorEnv of single ones holds around ours."""
    scene, rng = short(IDS[0]), np.random.default_rng(0)
    if mode == AutoresetMode.SAME_STEP and name in ("observations", "float32", "flat"):
        with pytest.raises(ValueError, match="Expected autoreset_mode"):  # these refuse every environment of this mode
            WRAPPED[name](PlantVectorEnv(scene, 3, autoreset_mode=mode))
        return
    ours = WRAPPED[name](PlantVectorEnv(scene, 3, randomise=True, autoreset_mode=mode))
    sync = WRAPPED[name](SyncVectorEnv([partial(PlantEnv, scene, randomise=True)] * 3, autoreset_mode=mode))
    np.testing.assert_equal(ours.reset(seed=0)[0], sync.reset(seed=0)[0])
    for _ in range(14):
        actions = rng.uniform(-1, 1, ours.action_space.shape).astype(np.float32)
        got, wanted = ours.step(actions), sync.step(actions)
        for a, b in zip(got[:4], wanted[:4]):
            np.testing.assert_array_equal(a, b)
        if "episode" in wanted[4]:
            for key in ("r", "l"):
                np.testing.assert_array_equal(got[4]["episode"][key], wanted[4]["episode"][key])
    assert isinstance(ours.unwrapped, PlantVectorEnv)
    ours.close()


@pytest.mark.campaign
@pytest.mark.parametrize("env_id", SAMPLE)
@pytest.mark.parametrize("mode", ["vector_entry_point", "sync", "async"])
def test_make_vec_in_every_way(env_id, mode) -> None:
    """test_make_vec: the three ways give one environment, and what they made is made again of its spec."""
    made = gymnasium.make_vec(env_id, num_envs=2, vectorization_mode=mode, randomise=True, dtype="float32")
    try:
        assert isinstance(made.unwrapped, PlantVectorEnv) == (mode == "vector_entry_point")
        ours = PlantVectorEnv(gymnasium.spec(env_id).kwargs["scene"], 2, randomise=True, dtype="float32")
        compared(made.reset(seed=9), ours.reset(seed=9))
        action = np.full(made.action_space.shape, 0.1, np.float32)
        for a, b in zip(made.step(action)[:4], ours.step(action)[:4]):
            assert np.array_equal(a, b)
    finally:
        made.close()
    if mode == "vector_entry_point":
        again = gymnasium.make_vec(made.spec)
        assert again.spec == made.spec
