"""The stepper plays the motion that `simulate` plays."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import IntegrationError
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.stepper_runs import motion, repeats, seconds_a_period, stepper

MOTIONS = Motions(scenes.get("single-link-slew", duration=0.4))
SCENE, RIGID = MOTIONS.scene, MOTIONS.ladder[0]
GIVEN = (MOTIONS.start(RIGID), MOTIONS.held, SCENE.times)


@pytest.mark.parametrize(("precision", "within"), (("double", 1e-13), ("single", 3e-6)))
def test_it_is_the_motion_of_simulate(precision, within):
    states, seconds = motion(stepper(RIGID, "rk4", SCENE.dt, SCENE.dt / 2, 1, precision), *GIVEN)
    same = MOTIONS.run(RIGID, method="rk4", step=SCENE.dt / 2).x
    assert states.shape == same.shape and seconds > 0
    assert np.abs(states - same).max() < within * np.abs(same).max()


def test_a_long_motion_is_timed_in_part(monkeypatch):
    """A clock that moves on by 0.03 s with each look: a call takes that long."""
    now = iter(0.03 * k for k in range(100))
    monkeypatch.setattr("pliant.studies.fidelity.stepper_runs.clock.perf_counter", lambda: next(now))
    each, runs = seconds_a_period(stepper(RIGID, "rk4", SCENE.dt, SCENE.dt, 16, "double"), *GIVEN)
    assert runs == 3 and each == pytest.approx(0.03)


def test_what_is_no_number_is_an_error():
    plant = next(p for p in MOTIONS.ladder if p.label.startswith("stiffened"))  # its rates hold speeds squared
    step = stepper(plant, "rk4", SCENE.dt, SCENE.dt / 5, 1, "double")
    held = np.full_like(GIVEN[1], 1e200)
    held[0] = 0.0  # where the step limit is looked at
    with pytest.raises(IntegrationError, match="no longer finite"):
        motion(step, MOTIONS.start(plant), held, SCENE.times)


def test_short_runs_are_timed_more_often():
    assert [repeats(seconds) for seconds in (0.0, 1e-3, 0.006, 1.0)] == [9, 9, 5, 3]
