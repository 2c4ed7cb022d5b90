"""What environments are handed: one gate for the single, the vector and the SB3 environment, with the same words."""

import re

import gymnasium
import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes
from pliant.envs.environments import arguments
from pliant.envs.environments.vector_env import PlantVectorEnv

SCENE = scenes.get("two-link-reach")
BAD = {  # an action of one lane, and what is said
    "complex": (np.zeros(2, complex), "complex128, must be real numbers"),
    "strings": (np.array(["a", "b"]), "must be real numbers"),
    "objects": (np.array([None, 0.0]), "object, must be real numbers"),
    "flags": (np.array([True, False]), "bool, must be real numbers"),
    "nan": ([np.nan, 0.0], "must be finite numbers"),
    "infinite": ([0.0, -np.inf], "must be finite numbers"),
    "huge": ([1e39, 0.0], "must be finite numbers"),
    "cancelling": ([1e200, -1e200], "must be finite numbers"),
    "long": (np.zeros(3), r"shape \(.*3,?\), must be"),
}
GOOD = {
    "float32": np.full(2, 0.25, np.float32),
    "integers": np.array([1, -1]),
    "list": [0.5, -0.5],
    "beyond, clipped": [3e38, -3e38],
    "read-only": np.broadcast_to(0.25, (2,)),
}


@pytest.fixture(scope="module", params=["float64", "float32"])
def pair(request):
    made = PlantEnv(SCENE, dtype=request.param), PlantVectorEnv(SCENE, 3, dtype=request.param)
    for env in made:
        env.reset(seed=0)
    return made


@pytest.mark.parametrize("kind", BAD)
def test_a_bad_action_is_refused_alike_and_changes_nothing(pair, kind) -> None:
    single, vector = pair
    bad, says = BAD[kind]
    before = single.state, vector.states
    with pytest.raises(ValueError, match=says) as one:
        single.step(bad)
    with pytest.raises(ValueError, match=says) as many:
        vector.step(np.stack([np.zeros_like(bad), bad, np.zeros_like(bad)]))
    assert re.sub(r".*?: actions?", "", str(one.value)).split()[-4:] == str(many.value).split()[-4:] or kind == "long"
    np.testing.assert_equal((single.state, vector.states), before)


@pytest.mark.parametrize("kind", GOOD)
def test_a_good_action_is_taken_alike(pair, kind) -> None:
    single, vector = pair
    single.reset(seed=0)
    vector.reset(seed=0)
    obs = single.step(GOOD[kind])[0]
    assert np.array_equal(vector.step([GOOD[kind]] * 3)[0], [obs] * 3)


def test_ragged_actions_are_refused_in_words(pair) -> None:
    with pytest.raises(ValueError, match=r"PlantVectorEnv.step: actions must be an array \(3, 2\) of real numbers"):
        pair[1].step([[0.0, 0.0], [0.0], [0.0, 0.0]])


def test_before_the_first_reset_nothing_is_stepped_shown_or_drawn() -> None:
    single, vector = PlantEnv(SCENE, render_mode="rgb_array"), PlantVectorEnv(SCENE, 2)
    for call in (
        lambda: single.step(np.zeros(2)),
        lambda: single.state,
        lambda: single.time,
        single.render,
        lambda: vector.step(np.zeros((2, 2))),
        lambda: vector.states,
        lambda: vector.times,
        lambda: vector.reset(options={"reset_mask": np.array([True, False])}),
    ):
        with pytest.raises(gymnasium.error.ResetNeeded, match="call reset first"):
            call()


def test_seeds_are_those_of_gymnasium(pair) -> None:
    single, vector = pair
    for seed in (0, 7, np.int64(7), np.uint8(3), np.array(4), None, 2**80):
        single.reset(seed=seed)
        vector.reset(seed=seed)
    for seeds in ([1, 2, 3], (None, 5, np.int32(6)), np.arange(3), range(3)):
        vector.reset(seed=seeds)
    for seed in (-1, 1.0, "7", True, [1, 2], [1, 2, -3], [1, 2, "3"], np.zeros((3, 2), int)):
        with pytest.raises(ValueError, match=r"seed"):
            vector.reset(seed=seed)
        with pytest.raises(ValueError, match=r"(?s)PlantEnv.reset: seed = .* must be an integer >= 0 or None"):
            single.reset(seed=seed)


def test_masks_and_options(pair) -> None:
    vector = pair[1]
    for mask, says in (
        (np.ones(2, bool), r"reset_mask of bool\(2,\) must be \(3,\) bool"),
        (np.ones(3), "reset_mask of float64"),
        (np.zeros(3, bool), "must name at least one"),
    ):
        with pytest.raises(ValueError, match=says):
            vector.reset(options={"reset_mask": mask})
    for options, says in (
        ({"nonsense": 1}, "'nonsense' must be one of"),
        (["state"], "must be a dictionary or None"),
        ({"state": np.zeros(3)}, "shape"),
        ({"state": np.full(12, 1e13)}, "below 1e"),
        ({"parameters": {"payload.weight": 1.0}}, "payload.weight"),
        ({"parameters": {"payload.mass": -1.0}}, "mass"),
        ({"parameters": 3.0}, "must be a dictionary of numbers by name"),
    ):
        for env in pair:
            with pytest.raises(ValueError, match=says):
                env.reset(options=options)


def test_what_makes_an_environment_is_checked() -> None:
    for make in (PlantEnv, lambda scene, **options: PlantVectorEnv(scene, 2, **options)):
        for scene, options, says in (
            (5, {}, "scene = 5 must be a Scene or the name of one"),
            (SCENE, {"randomise": "yes"}, "randomise = 'yes' must be True or False"),
            (SCENE, {"dtype": "nonsense"}, "dtype = 'nonsense' must be one of"),
            (SCENE, {"dtype": "int32"}, "'int32' must be one of"),
            (SCENE, {"render_mode": "ansi"}, "render_mode = 'ansi'"),
        ):
            with pytest.raises(ValueError, match=says):
                make(scene, **options)
    for options in ({"threads": 0}, {"threads": 1.5}, {"autoreset_mode": "sometimes"}, {"max_episode_steps": 0}):
        with pytest.raises(ValueError, match=next(iter(options))):
            PlantVectorEnv(SCENE, 2, **options)


def test_lengths_of_episodes() -> None:
    assert arguments.require_length("x", SCENE, None) == SCENE.steps
    assert arguments.require_length("x", SCENE, np.int64(3)) == 3
    for most in (SCENE.steps + 1, 0, -1, 2.0, True, "3"):
        with pytest.raises(ValueError, match=f"from 1 to {SCENE.steps}, the periods of scene 'two-link-reach'"):
            arguments.require_length("x", SCENE, most)


def test_rows_of_unequal_length_are_refused_by_name(pair) -> None:
    """NumPy's own words name neither the environment nor the option."""
    _, vector = pair
    nx = vector.scene.plant.nx
    for name, value in (
        ("reset_mask", [True, [False]]),
        ("state", [[0.0] * nx, [0.0]]),
        ("parameters", {"payload.mass": [1.0, [1.0, 2.0]]}),
    ):
        with pytest.raises(ValueError, match=f"PlantVectorEnv.reset.*{name}"):
            vector.reset(options={name: value})


def test_no_type_is_no_type_of_numbers() -> None:
    for make in (PlantEnv, PlantVectorEnv):
        with pytest.raises(ValueError, match="dtype = None"):
            make("single-link-slew", dtype=None)


def test_a_step_that_charges_nothing_has_the_reward_0_of_either_kind() -> None:
    """Not -0, which single ones of Gymnasium's vector environments do not give where an episode begins."""
    scene = scenes.get("single-link-slew")
    vector = PlantVectorEnv(scene, 2, max_episode_steps=1)
    vector.reset(seed=0)
    vector.step(np.zeros((2, 1), dtype=np.float32))
    rewards = vector.step(np.zeros((2, 1), dtype=np.float32))[1]
    assert not rewards.any() and not np.signbit(rewards).any()


def test_infinity_in_half_precision_is_no_action():
    """float16 holds no bound of single precision: compared in it, infinity is not beyond the bound."""
    with pytest.raises(ValueError, match=r"action = \[inf\] must be finite"):
        arguments.require_actions("step", "action", np.array([np.inf], np.float16), (1,))


def test_numbers_of_another_order_of_bytes_are_no_type_of_an_environment():
    """The physics runs on the machine's own: such a type was taken, and failed without words."""
    for dtype in (">f8", "<f8" if np.dtype("f8").str[0] == ">" else ">f4"):
        for make in (PlantEnv, PlantVectorEnv):
            with pytest.raises(ValueError, match=f"dtype = '{dtype}' must be one of 'float64', 'float32'"):
                make("single-link-slew", dtype=dtype)


def test_what_all_lanes_share_is_looked_at_once(monkeypatch):
    """It is a plant of its own that tells whether a parameter may be so: one for all lanes, not one for each."""
    vector, looked = PlantVectorEnv(SCENE, 3), []
    monkeypatch.setattr(arguments.parameters, "put", lambda *given: looked.append(given))
    masses = np.array([0.5, 0.6, 0.7])
    vector.reset(options={"parameters": {"payload.mass": 0.5}})
    assert len(looked) == 1
    vector.reset(options={"parameters": {"payload.mass": masses}, "state": np.zeros(SCENE.plant.nx)})
    assert len(looked) == 4 and np.array_equal(vector.parameters_of(np.arange(3))[:, 0], masses)
    assert not vector.states.any()
