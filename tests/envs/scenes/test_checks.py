"""What a scene's fields must be."""

import dataclasses
import re
import warnings

import numpy as np
import pytest
from users_plants import LIFT

from pliant.envs import scenes
from pliant.envs.environments.scene_check import check_scene
from pliant.envs.simulation.episode_start import initial_states
from pliant.plants import EquilibriumError
from pliant.plants.core.errors import UnstableRestWarning


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"limits": (40.0,)}, "limits"),
        ({"limits": (0.0, 1.0)}, "limits"),
        ({"substeps": 0}, "substeps"),
        ({"dt": -0.1}, "dt"),
        ({"duration": 0.001}, "duration"),
        ({"bounds": (("theta1_rate", 0.0),)}, "bounds theta1_rate = 0.0"),
        ({"bounds": (("theta9", 1.0),)}, "theta9"),
        ({"weights": (("theta1", -1.0),)}, "weights theta1 = -1.0"),
        ({"start": (("theta1", np.nan),)}, "start theta1 = nan"),
        ({"start": (("tip_x", 1.0),)}, "start 'tip_x' must be one of theta1, theta2, q11"),
        ({"goal": (("tip_x", 1.0),)}, "goal 'tip_x' must be one of theta1"),
        ({"effort": (("tau1", 0.0),)}, "effort tau1"),
        ({"observe": ("tip_z",)}, "tip_z"),
        ({"randomise": (("payload.colour", 0.5, 2.0),)}, "colour"),
        ({"randomise": (("payload.mass", 2.0, 0.5),)}, "payload.mass"),
        ({"start_spread": -0.1}, "start_spread"),
        ({"spreads": (("theta1", -0.1),)}, "spreads theta1 = -0.1"),
        ({"goal_rates": (("tip_x", 0.1),)}, "tip_x"),
        ({"nominal_start": (("theta9", 0.1),)}, "theta9"),
        ({"colour": 3}, "colour"),
    ],
)
def test_bad_fields_are_named(changes: dict, says: str) -> None:
    with pytest.raises(ValueError, match=re.escape(says)):
        scenes.get("two-link-reach", **changes)


def test_every_rung_of_the_ladder_must_have_the_names():
    """The elastic states are on no rigid rung: the nominal motion of a goal that names one would be wrong unseen."""
    scene = scenes.get("single-link-slew")
    assert "eta1" in {s.name for s in scene.plant.states}
    assert dataclasses.replace(scene, observe=("eta1",)).observe == ("eta1",)  # of the own plant alone
    for field in ({"goal": (("eta1", 0.1),)}, {"weights": (("eta1", 1.0),)}):
        with pytest.raises(ValueError, match=r"'eta1' is no signal of 'rigid' on the ladder of SingleLinkArm, must be"):
            dataclasses.replace(scene, **field)


def test_a_rest_that_is_not_there_names_its_field():
    """A load that leans by 0.5 rad hangs still nowhere: one input, and two coordinates that are chosen."""
    leaning = dataclasses.replace(LIFT, goal=(("place", 1.0), ("lean", 0.5)))
    with pytest.raises(
        EquilibriumError, match=r"scene 'crane': \[goal\] names 2 coordinates \(place, lean\), of a plant"
    ) as told:
        _ = leaning.target
    assert (
        "with 1 input: name 1 at most, as place; no equilibrium of crane" in str(told.value) and told.value.residual > 1
    )
    with pytest.raises(EquilibriumError, match=r"\[start\] names 1 coordinate \(lean\).* or say start_at_rest = false"):
        _ = dataclasses.replace(LIFT, start=(("lean", 0.5),)).initial


def test_rates_are_zero_at_rest():
    going = dataclasses.replace(LIFT, start=(("place", 0.0), ("going", 0.2)))
    with pytest.raises(EquilibriumError, match=r"\[start\] has going = 0\.2: rates are zero at rest, or say start"):
        _ = going.initial
    assert dataclasses.replace(going, start_at_rest=False).initial[0].tolist() == [0.0, 0.0, 0.0, 0.2]
    assert dataclasses.replace(LIFT, start=(("going", 0.0),)).initial[0].tolist() == [0.0] * 4


def test_joints_that_are_not_named_are_held_at_zero():
    """Under gravity: m g a of the bodies beyond each joint, by the hands of `equilibrium` with all of them named."""
    scene = scenes.get("six-axis-pick")
    rigid = scene.plant.ladder()[0]
    few = dataclasses.replace(scene, plant=rigid, start=(("lift", -1.0),), goal=())
    x, u = few.initial
    held = {joint.position: 0.0 for joint in rigid.joints} | {"lift": -1.0}
    assert dict(zip((s.name for s in rigid.states), x)) | held == dict(zip((s.name for s in rigid.states), x))
    np.testing.assert_allclose(u, rigid.equilibrium(held)[1], atol=1e-9)
    assert np.abs(u[1]) > 10 and not few.target[0].any() and np.abs(few.target[1]).max() > 10
    starts = initial_states(dataclasses.replace(few, randomise=()), np.array([[-1.0], [-0.9]]), np.zeros((2, 0)))
    np.testing.assert_allclose(starts[:, 1], [-1.0, -0.9])
    assert not starts[:, [0, 2, 3, 4, 5]].any()


def test_rests_of_scenes_are_a_controllers_to_hold():
    """A rod that stands up: of it as a start and goal nothing is warned, on no rung and in no random episode."""
    slew = scenes.get("single-link-slew")
    rod = dataclasses.replace(slew.plant, gravity=9.81)
    up = (("hub_angle", np.pi / 2),)
    with pytest.warns(UnstableRestWarning):
        rod.equilibrium(dict(up))
    with warnings.catch_warnings():
        warnings.simplefilter("error", UnstableRestWarning)
        for rung in rod.ladder()[:2]:
            standing = dataclasses.replace(slew, plant=rung, start=up, goal=up, randomise=(), limits=(500.0,))
            assert standing.initial[0][0] == standing.target[0][0] == np.pi / 2
        several = dataclasses.replace(LIFT, start=(("lean", np.pi), ("place", 0.0)), randomise=())
        initial_states(several, np.array([[np.pi, 0.0], [np.pi, 0.1]]), np.zeros((2, 0)))
    found = dict(check_scene(dataclasses.replace(standing, duration=0.1, move_time=0.05)).found)
    assert re.search(r"unstable: with the inputs held, small deviations grow by exp\([\d.]+ t\)", found["goal"])
