import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.scene_files.scene_tables import from_tables, to_tables
from pliant.envs.simulation.control_period import parts
from pliant.plants.files.toml_text import dumps, loads
from pliant.plants.integration.batch_stepper import rate_function


def written_and_read(scene):
    return from_tables(loads(dumps(to_tables(scene))))


@pytest.mark.parametrize("name", list(scenes.SCENES))
def test_a_shipped_scene_comes_back_the_same(name):
    """Equal, of the same hash and the same digits."""
    scene = scenes.get(name)
    found = written_and_read(scene)
    assert found == scene and hash(found) == hash(scene) and repr(found) == repr(scene)


@pytest.mark.parametrize("name", list(scenes.SCENES))
@pytest.mark.every(3)
def test_a_shipped_scene_that_comes_back_has_the_same_kernel(name):
    """What its C source is written from, operation for operation: nothing is shared, as the file is read anew."""

    def functions(scene):
        return [f.serialize() for f in (rate_function(scene.varied_plant), *parts(scene))]

    scene = dataclasses.replace(scenes.get(name))
    assert functions(written_and_read(scene)) == functions(scene)


def test_a_base_is_changed():
    found = from_tables(
        {
            "name": "far-reach",
            "base": "two-link-reach",
            "duration": 4,
            "parameters": {"payload.mass": 0.7, "modes": [1, 1]},
            "goal": {"theta1": -0.5, "theta2": 0.3},
            "limits": {"tau2": 10, "tau1": 30.0},
            "randomise": {"link1.E": [0.9, 1.1]},
        }
    )
    base = scenes.get("two-link-reach")
    arm = dataclasses.replace(base.plant, payload=dataclasses.replace(base.plant.payload, mass=0.7), modes=(1, 1))
    assert found == dataclasses.replace(
        base,
        name="far-reach",
        plant=arm,
        duration=4,
        goal=(("theta1", -0.5), ("theta2", 0.3)),
        limits=(30.0, 10),
        randomise=(("link1.E", 0.9, 1.1),),
    )


def test_a_base_has_its_own_keywords():
    found = from_tables({"name": "slow-spin", "base": {"name": "spin-up", "speed": 4.0}})
    assert dict(found.goal) == {"hub_angle_rate": 4.0} and found.plant == scenes.get("spin-up").plant


def test_samples_are_inputs_on_straight_lines():
    motion = {"type": "samples", "times": [0.0, 1.0, 3.0], "inputs": [[0.0], [2.0], [-2.0]]}
    found = from_tables({"name": "a-slew", "base": "single-link-slew", "motion": motion})
    at = [float(found.nominal_input(t)[0]) for t in (0.0, 0.5, 2.0, 3.0, 9.0)]
    assert np.allclose(at, [0.0, 1.0, 0.0, -2.0, -2.0], rtol=0, atol=1e-15)
    assert written_and_read(found) == found


BASE = {"name": "a-scene", "base": "two-link-reach"}


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({}, "lacks name"),
        ({"name": "../up"}, "name = '../up' must be words of a-z"),
        ({"name": "a-scene"}, "lacks plant, must be a table"),
        ({"name": "a-scene", "plant": {"type": "TwoLinkArm", "make": "textbook"}}, "lacks duration, limits"),
        ({"name": "a-scene", "base": "two"}, "base = 'two' must be one of single-link-slew"),
        (BASE | {"speed": 4}, "speed = 4: a scene has no 'speed', must be one of name"),
        (BASE | {"base": {"name": "spin-up", "sped": 4}}, "base.sped = 4: must be one of speed, time"),
        (BASE | {"base": {"name": "spin-up", "speed": -4}}, "base: scene 'spin-up': speed = -4 must be > 0"),
        (BASE | {"duration": -1.0}, "duration = -1.0 must be > 0"),
        (BASE | {"duration": "long"}, "duration = 'long' must be a number > 0"),
        (BASE | {"goal": {"theta3": 1}}, "goal.theta3 = 1: no such signal, must be one of theta1"),
        (BASE | {"start": {"tip_x": 1}}, "start.tip_x = 1: no such signal, must be one of theta1"),
        (BASE | {"goal": 3}, "goal = 3 must be values by name"),
        (BASE | {"weights": {"theta1": -1}}, "weights.theta1 = -1 must be >= 0"),
        (BASE | {"limits": {"tau1": 1}}, "limits = .* lacks tau2"),
        (BASE | {"limits": [1.0, 2.0, 3.0]}, r"limits = \(1.0, 2.0, 3.0\) must hold 2 numbers > 0"),
        (BASE | {"observe": "theta1"}, "observe = 'theta1' must be a list of names"),
        (BASE | {"observe": ["theta9"]}, r"observe\[0\] = 'theta9': no such signal"),
        (BASE | {"goal_at_rest": 1}, "goal_at_rest = 1 must be true or false"),
        (BASE | {"randomise": {"payload.mass": 0.5}}, "randomise.payload.mass = 0.5 must be"),
        (BASE | {"randomise": {"payload.colour": [1, 2]}}, "randomise.*'payload.colour': Payload has no 'colour'"),
        (
            BASE | {"parameters": {"payload.mas": 1}},
            "parameters.payload.mas = 1 must be a parameter of the plant: .*it has mass",
        ),
        (BASE | {"parameters": {"payload.mass": "heavy"}}, "parameters.payload.mass = 'heavy' must be a"),
        (BASE | {"motion": {"type": "os.system"}}, "motion.type = 'os.system' must be one of 'rest-to-rest'"),
        (BASE | {"motion": {"type": "samples", "times": [0.0]}}, "motion = .* lacks inputs"),
        (BASE | {"motion": {"type": "smooth-spin-up", "speed": 1, "time": 0}}, "motion.time = 0 must be > 0"),
    ],
)
def test_tables_that_make_no_scene_are_refused_by_key_value_and_range(tables, words):
    with pytest.raises(ValueError, match=words):
        from_tables(tables)


def test_a_drive_of_ones_own_is_not_written():
    scene = dataclasses.replace(scenes.get("single-link-slew"), drive=lambda plant, t: np.zeros(1))
    with pytest.raises(ValueError, match=r"Scene.drive = .* cannot be written, must be one of rest-to-rest"):
        to_tables(scene)
