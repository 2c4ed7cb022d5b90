"""One setting after another: what is refused, and why."""

import dataclasses

import pytest

from pliant.envs import scenes
from pliant.plants.motions.time_limit import time_limit
from pliant.studies.charts import runner as room
from pliant.studies.charts.plan import simulated
from pliant.studies.charts.runner import Runner
from pliant.studies.common.processor_time import processor_time
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.speed_accuracy import SPENT, Row

MOTIONS = Motions(scenes.get("single-link-slew", duration=0.3))
RIGID, BENT = MOTIONS.ladder[:2]
EXACT = MOTIONS.converged(BENT)


@pytest.fixture
def runner():
    return Runner(MOTIONS, EXACT, True)


def soon(seconds=60.0):
    return processor_time() + seconds


def coarse(plant, method="rk4", **changes):
    return dataclasses.replace(simulated(plant, method, 0, MOTIONS.scene.dt), **changes)


def test_a_setting_is_measured_once_and_a_finer_one_only_where_it_matters(runner):
    row = runner.measure(RIGID, coarse(RIGID), soon())
    assert row.failure is None and row.seconds > 0 and row.step_error < 0.1 * row.error
    assert runner.measure(RIGID, coarse(RIGID), soon()) is None
    assert runner.measure(RIGID, simulated(RIGID, "rk4", 1, MOTIONS.scene.dt), soon()) is None


def test_the_stepper_waits_for_simulate_and_many_lanes_for_one(runner):
    stepped = coarse(RIGID, path="stepper")
    runner.measure(RIGID, coarse(RIGID), soon())
    assert runner.measure(RIGID, dataclasses.replace(stepped, lanes=1024), soon()) is None
    assert runner.measure(RIGID, stepped, soon()).failure is None
    many = runner.measure(RIGID, dataclasses.replace(stepped, lanes=1024), soon())
    assert many.lanes == 1024 and many.error == runner.rows[stepped.key].error
    assert runner.beaten(stepped) >= 0


def test_what_simulate_failed_by_the_stepper_is_not_asked(runner):
    stiff = MOTIONS.ladder[-1]
    assert runner.measure(stiff, coarse(stiff), soon()).failure.startswith("StabilityLimitError")
    assert runner.measure(stiff, coarse(stiff, path="stepper"), soon()) is None


def test_no_time_is_no_result_that_is_remembered(runner):
    assert runner.measure(RIGID, coarse(RIGID), soon(-1.0)).failure == SPENT
    assert runner.measure(RIGID, coarse(RIGID), soon()).failure is None


def test_a_slow_or_dominated_setting_is_not_run(runner):
    runner.take(BENT, coarse(BENT, "midpoint", seconds=10.0, error=1e-3, step_error=1.0, runs=1))
    finer = simulated(BENT, "midpoint", 3, MOTIONS.scene.dt)
    assert runner.measure(BENT, finer, soon()).failure.startswith("too slow: about 30 s a run")
    del runner.rows[finer.key]
    runner.take(BENT, Row(BENT.label, BENT.nx, "dop853", None, 1e-3, seconds=1e-9, error=0.0, step_error=0.0, runs=1))
    why = runner.measure(BENT, finer, soon()).failure
    assert why == f"not run: dominated by {BENT.label}, dop853, rtol 1e-03"


def test_a_setting_that_takes_longer_than_there_is_time_is_given_up(runner, monkeypatch):
    """Here at once: no time is left and a run of no length is slow."""
    deadline, now = soon(), iter([0.0, 0.0, 1e6, 1e6])
    monkeypatch.setattr(room, "SLOW", 0.0)
    monkeypatch.setattr(room, "processor_time", lambda: next(now) + deadline)
    found = runner.measure(BENT, coarse(BENT, "midpoint"), deadline)
    assert found.failure.startswith("too slow: given up after 1e+06 s") and found.reason == "too slow"
    monkeypatch.undo()
    with time_limit(-1.0):  # of what asks for the chart
        assert runner.measure(BENT, coarse(BENT, "dop853"), soon()).failure == SPENT
    assert runner.measure(BENT, coarse(BENT, "dop853"), soon()).failure is None
