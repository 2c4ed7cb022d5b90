"""A scene is played once before anything long is done with it."""

import dataclasses
import re

import numpy as np
import pytest
from hoist import Hoist
from users_plants import LIFT

from pliant.envs import scenes
from pliant.envs.environments.scene_check import check_scene
from pliant.envs.scenes.scene import Scene
from pliant.plants import NominalWarning
from pliant.plants.contract.check import ContractError
from pliant.plants.native import kernel_loader


def test_a_sound_scene_is_told_what_was_found():
    found = dict(check_scene(LIFT).found)
    assert list(found) == ["start", "goal", "rungs", "nominal", "open loop", "environment"]
    assert found["rungs"] == "start and goal on 1 of 1" and found["environment"] == "3 observations, one step runs"
    assert found["goal"] == "at rest without inputs" and str(check_scene(LIFT)).startswith("scene 'crane'\n  start ")
    held = dict(check_scene(scenes.get("two-link-reach")).found)
    assert held["goal"].startswith("at rest with tau1 = 23.7")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"goal": (("place", 1.0), ("lean", 0.5))}, r"goal: scene 'crane': \[goal\] names 2 coordinates"),
        ({"limits": (1.0,)}, r"nominal: inputs beyond the limits: pull = -?28\.\d+ N at 0\.\d+ s \(limit 1\)"),
        ({"duration": 0.5}, r"open loop: duration = 0\.5 s ends it before it arrives, must be at least move_time"),
        ({"drive": lambda plant, t: [0.0, 0.0]}, "open loop: .*"),
        ({"substeps": 1, "dt": 1.0, "move_time": 0.1}, "nominal: .*|open loop: .*"),
    ],
)
def test_each_fault_is_told_in_words(changes, words):
    with pytest.raises(ContractError, match=words) as told:
        check_scene(dataclasses.replace(LIFT, **changes))
    assert isinstance(told.value, ValueError) and all("\n" not in fault for fault in told.value.faults)


def test_a_rest_that_takes_more_than_the_limits_is_a_fault():
    """The arm's weight at the goal, 23.7 N m."""
    weak = dataclasses.replace(scenes.get("two-link-reach"), limits=(20.0, 50.0))
    with pytest.raises(ContractError, match=r"goal: its rest takes tau1 = 23\.\d+ N m \(limit 20\)"):
        check_scene(weak)


def test_a_motion_that_only_a_feedback_brings_there_is_no_fault():
    """A load that stands on its trolley falls as that goes."""
    over = {"start": (("place", 0.0), ("lean", np.pi)), "goal": (("place", 1.0), ("lean", np.pi))}
    upside = dataclasses.replace(LIFT, **over, duration=4.0, weights=(("lean", 1.0), ("place", 1.0)))
    found = dict(check_scene(upside).found)
    assert re.search(r"does not arrive: .*; its start and goal must be held by a feedback", found["open loop"])
    with pytest.warns(NominalWarning, match="its start and goal must be held by a feedback"):
        upside.open_loop(method="rk4", step=0.01)


def test_a_start_that_moves_is_no_fault():
    """The inputs are made as from rest: what was on its way goes on, without friction by 1.2 m."""
    going = dataclasses.replace(LIFT, start=(("going", 0.6),), start_at_rest=False, duration=2.0)
    words = dict(check_scene(going).found)["open loop"]
    assert re.fullmatch(r"does not arrive: place ends at \d\.\d+ m, not at 1; it does not start at rest", words)


def test_a_scene_without_observations_has_no_environment():
    assert (
        dict(check_scene(dataclasses.replace(LIFT, observe=())).found)["environment"] == "none: observe names nothing"
    )


def test_a_machine_that_is_never_at_zero_plays_its_scene_in_compiled_code():
    """Kernels are compared where it can be; a state that the start leaves open is as at home; no weights are needed."""
    scene = Scene(
        name="hoist",
        about="",
        plant=Hoist(),
        start=(("sway", 0.0),),
        goal=(("sway", 0.0), ("rope", 3.0)),
        duration=1.0,
        limits=(30.0, 5.0),
        observe=("rope", "sway"),
        compare=("load_y",),
    )
    assert scene.initial[0][0] == 4.0
    found = dict(check_scene(scene).found)
    assert found["environment"] == "2 observations, one step runs"
    priced = dataclasses.replace(scene, effort=(("pull", 1.0),))
    for played, cost in ((scene, 0.0), (priced, 0.02 * (30.0 - 9.81) ** 2)):
        env = played.vector_env(2, terms=True)
        assert env.native or not kernel_loader.wanted()
        env.reset(seed=0)
        _, rewards, _, _, infos = env.step(np.array([[-1.0, 0.0]] * 2))  # 30 N where the rest at the goal takes 9.81
        assert rewards == pytest.approx(-cost)
        assert sum(value for name, value in infos["reward_terms"].items() if name[0] != "_") == pytest.approx(-cost)
