"""TVLQR into a cycle: along the cycle itself it is the periodic regulator, and it hands over to that."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import PeriodicTVLQR
from pliant.plants.core.trajectory import Trajectory
from pliant.studies.closed_loop.rollout import nominal, rollout


@pytest.fixture(scope="module")
def along(scene, cycle):
    """Led along the free cycle over its first 40 periods."""
    t, u = cycle.dt * np.arange(41), np.tile(cycle.u, (41, 1))
    return PeriodicTVLQR.for_scene(scene, nominal=Trajectory.from_arrays(t, cycle.x[:41], u, plant=scene.plant))


def test_along_the_cycle_its_gains_are_those_of_the_periodic_regulator(cycle, law, along):
    """Of deviations by time: K Pi, the cost to go at its end being the periodic one's; within what it is charged for
    being early or late along the nominal."""
    for k in (0, 17, 39):
        flow = cycle.flow[k - 1]
        wanted = np.insert(law.regulator.K[k], cycle.angle, -law.regulator.K[k] @ (flow[1:] / flow[0]), axis=1)
        assert along.led.K[k] == pytest.approx(wanted, rel=2e-3, abs=1e-5 * np.abs(wanted).max())


def test_it_hands_over_at_its_end(cycle, law, along):
    x = cycle.x[45] + np.array([0.0, 0.0, 0.0, 0.1, 0.0, 0.0])
    assert along.ends == pytest.approx(0.2) and along.act(0.225, x) == law.act(0.225, x)
    assert along.act(0.2, x) == law.act(0.2, x) and along.act(0.195, x) == along.led.act(0.195, x)


def test_led_by_the_plan_of_least_cost_it_comes_to_the_cycle(scene):
    slow = dataclasses.replace(scene, start=(("crank_angle_rate", 14.5),), duration=0.15)
    led = PeriodicTVLQR.for_scene(slow)
    run = rollout(slow, led, nominal(slow))
    assert run.failure == "" and run["crank_angle_rate"][-1] == pytest.approx(15.08, abs=0.02)
    free = rollout(slow, led.law, nominal(slow))
    assert run.cost < 1.1 * free.cost
