"""Nominal inputs: the torques of a rigid body along a minimum-jerk motion."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes

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
