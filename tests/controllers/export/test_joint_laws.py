"""PD and computed torque in C: closed loops beside `act`, and each profile of a motion beside its closed form."""

import dataclasses

import numpy as np
import pytest
from exported import answers_over_time, compiled, needs_compiler, run, same_loop

from pliant.controllers import PD, ComputedTorque, Shaper
from pliant.controllers.base.joint_reference import Follow, RestToRest, driven
from pliant.controllers.export import export_c
from pliant.plants.integration.minimum_jerk import PROFILES

pytestmark = needs_compiler


def test_a_shaped_pd_with_feedforward(tmp_path, reach, near_double) -> None:
    same_loop(tmp_path, reach, PD.for_scene(reach, shape="zvd"), near_double)


def test_computed_torque_along_samples(tmp_path, reach) -> None:
    """Near the motion, within the limits; it ends while it still moves, and goes on at that rate."""
    law = ComputedTorque.for_scene(reach)
    samples = [law.reference(0.02 * k) for k in range(30)]
    law = dataclasses.replace(law, reference=Follow(0.02, *(np.array(part) for part in zip(*samples))))
    times = np.array([-0.01, *(0.02 * np.arange(34) + 0.007)])
    near = np.random.default_rng(0).standard_normal((len(times), 4)) * 0.01
    readings = np.array([np.concatenate(law.reference(t)[:2]) for t in times]) + near
    wanted = np.array([law.act(t, y) for t, y in zip(times, readings)])
    assert (np.abs(wanted) < 0.99 * law.limits[1]).all()
    files = [export_c(law, tmp_path / "law.c")[0], answers_over_time(tmp_path, law, times, readings, 2)]
    assert np.abs(run(compiled(files, tmp_path / "answers")) - wanted).max() < 1e-12 * np.abs(wanted).max()


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_profiles(tmp_path, reach, profile) -> None:
    """u is the reference's place for one joint and its rate for the other, before, within and after the motion."""
    shaper = Shaper(np.array([0.0, 0.11]), np.array([0.6, 0.4]))
    shaped = RestToRest([0.5, 0.0], [2.0, 1.0], 0.8, shaper, profile)
    law = PD(
        Kp=np.diag([1.0, 0.0]), Kd=np.diag([0.0, 1.0]), joints=driven(reach.plant), reference=shaped, u0=[0.0, 0.0]
    )
    times = np.linspace(-0.1, 1.1, 49)
    files = [export_c(law, tmp_path / "law.c")[0], answers_over_time(tmp_path, law, times, np.zeros((49, 4)), 2)]
    found = run(compiled(files, tmp_path / "answers"))
    motion = PROFILES[profile]
    parts = [0.6 * np.array(motion(float(t / 0.8))) + 0.4 * np.array(motion(float((t - 0.11) / 0.8))) for t in times]
    way, rate = np.array(parts)[:, 0], np.array(parts)[:, 1] / 0.8
    assert np.abs(found - np.stack([0.5 + 1.5 * way, rate], axis=1)).max() < 1e-13
