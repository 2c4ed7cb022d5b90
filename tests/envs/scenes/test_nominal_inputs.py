"""Nominal inputs: the torques of a rigid body along a minimum-jerk motion."""

import dataclasses
import re

import numpy as np
import pytest
from users_plants import LIFT, Crane

from pliant.envs import scenes
from pliant.envs.scenes.nominal_inputs import far_from_goal, told
from pliant.plants import NominalWarning, Trajectory

ALONG, ACROSS = 228.0, 12.0  # [kg m^2] of a panel


def rigid(name, **changes):
    """The scene with its rigid plant."""
    scene = scenes.get(name, **changes)
    return scene.with_plant(scene.plant.ladder()[0])


def test_slew_takes_the_torque_of_a_rigid_body():
    """J d2(angle)/dt2 about z, J = 180 + 2 * 228, along the quintic of minimum jerk (Flash and Hogan, 1985)."""
    scene, t = scenes.get("spacecraft-slew"), np.linspace(0.0, 60.0, 61)
    s = t / 60.0
    wanted = (180.0 + 2 * ALONG) * (np.pi / 3) / 60.0**2 * (60 * s - 180 * s**2 + 120 * s**3)
    torque = np.array([scene.nominal_input(time) for time in t])
    np.testing.assert_allclose(torque[:, 2], wanted, atol=1e-12)
    np.testing.assert_allclose(torque[:, :2], 0.0, atol=1e-12)
    assert np.abs(torque).max() < 0.6 * min(scene.limits)

    motion = rigid("spacecraft-slew").open_loop(rtol=1e-10, atol=1e-12)
    s = np.minimum(motion.t / 60.0, 1.0)
    angle = np.pi / 3 * (10 * s**3 - 15 * s**4 + 6 * s**5 - 1)
    np.testing.assert_allclose(motion["attitude_z"], 2 * np.sin(angle / 2), atol=1e-8)
    np.testing.assert_allclose(motion["attitude_x"], 0.0, atol=1e-12)


def test_slew_of_a_turn_about_any_axis_ends_at_rest_at_the_goal():
    """Of a rigid spacecraft with three different moments of inertia, which precesses unless it is held on its axis."""
    quaternion = np.array([0.8, -0.3, 0.4, np.sqrt(1 - 0.64 - 0.25)])
    start = tuple((f"quaternion_{k}", float(v)) for k, v in enumerate(quaternion))
    motion = rigid("spacecraft-slew", start=start).open_loop(rtol=1e-10, atol=1e-12)
    left = np.array([motion[f"attitude_{c}"][-1] for c in "xyz"] + [motion[f"body_rate_{c}"][-1] for c in "xyz"])
    assert np.abs(motion["body_rate_x"]).max() > 0.01 and np.abs(left).max() < 1e-7


def test_a_scene_with_loads_needs_its_own_drive():
    orbit = scenes.get("spacecraft-orbit")
    with pytest.raises(ValueError, match="'spacecraft-orbit': drive = None needs a spacecraft without loads"):
        _ = dataclasses.replace(orbit, drive=None).nominal_input
    with pytest.raises(ValueError, match=r"spacecraft-spin\.axis = 'q' must be one of 'x', 'y', 'z'"):
        scenes.get("spacecraft-spin", axis="q")


def test_inputs_beyond_the_limits_are_told_by_name_value_and_limit():
    """J s'' / time^2 of a rigid body, 10 / sqrt(3) the largest s'' of the quintic, at (1 -+ 1/sqrt(3)) / 2 of it."""
    scene = scenes.get("spacecraft-slew")
    largest = (180.0 + 2 * ALONG) * (np.pi / 3) / 60.0**2 * 10 / np.sqrt(3)
    low = dataclasses.replace(scene, limits=(9.0, 9.0, largest / 2))
    with pytest.warns(NominalWarning, match=r"'spacecraft-slew' are beyond its limits: torque_z = ") as found:
        _ = low.nominal_input
    words = str(found[0].message)
    value, at, limit = (
        float(n) for n in re.search(r"= ([-\d.]+) N m at ([\d.]+) s \(limit ([\d.]+)\)", words).groups()
    )
    assert abs(value) == pytest.approx(largest, rel=1e-3) and limit == pytest.approx(largest / 2, rel=1e-5)
    assert min(abs(at - 60 * (0.5 + k / np.sqrt(12))) for k in (-1, 1)) < 0.3
    assert found[0].filename == __file__ and "torque_x" not in words


def test_a_motion_that_does_not_arrive_is_told(recwarn):
    """Half of a motion that arrives does not."""
    scene = LIFT.with_plant(Crane())
    whole = LIFT.open_loop(rtol=1e-6)
    slow = Trajectory.from_arrays(whole.t, 0.5 * whole.x, whole.u, plant=scene.plant)
    assert re.fullmatch(r"place ends at 0\.\d+ m, not at 1", far_from_goal(scene, slow))
    assert far_from_goal(scene, whole) == "" and not recwarn.list
    with pytest.warns(NominalWarning, match="the open-loop motion of scene 'crane' does not arrive: place ends"):
        assert told(scene, slow) is slow


@pytest.mark.parametrize("name", [name for name in scenes.SCENES if not name.startswith("spacecraft")])
def test_shipped_scenes_keep_their_limits(name, recwarn):
    assert scenes.get(name).nominal_input is not None
    assert not [w for w in recwarn.list if w.category is NominalWarning]
