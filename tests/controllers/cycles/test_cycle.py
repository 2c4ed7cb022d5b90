"""Deviations across a cycle, held against the plant's own steps."""

import numpy as np
import pytest

from pliant.controllers.cycles.cycle import deviations, of_cycle, turning, whole_turns
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.envs import scenes
from pliant.plants import EquilibriumError


def test_the_cycle_closes(scene, cycle):
    turn = np.zeros(scene.plant.nx)
    turn[cycle.angle] = 2 * np.pi * cycle.turns
    assert cycle.x[-1] - cycle.x[0] == pytest.approx(turn, abs=1e-9)
    assert cycle.dt == pytest.approx(scene.dt, rel=1e-9) and cycle.steps == 250


def test_deviations_are_those_at_the_same_angle_to_first_order(scene, cycle):
    """A push across the cycle, a period of the plant, back to the cycle at the angle reached: slope 2 in its size."""
    plant, k, rest = scene.plant, 40, cycle.rest
    d = np.array([1e-7, 1e-9, 0.02, 1e-5, 1e-7])
    held = HeldSteps(plant, cycle.dt, scene.substeps, np.zeros(1), np.zeros(plant.nw), plant.nominal_parameters)
    missed = []
    for size in (1.0, 0.5):
        x = cycle.x[k].copy()
        x[rest] += size * d
        end = held.ends(x[None], cycle.u[None])[0]
        flow = cycle.flow[k]
        late = (end - cycle.x[k + 1])[cycle.angle] / flow[cycle.angle]
        across = (end - cycle.x[k + 1] - late * flow)[rest]
        # the cycle itself at that angle, to second order in the time by which the machine is late
        missed.append(np.abs((across - size * cycle.late(0.0, 0).step[k, :, :5] @ d) / d).max())
    assert missed[0] < 1e-3 and missed[0] / missed[1] == pytest.approx(4, rel=0.3)


@pytest.mark.parametrize("delay", [0.5, 1.0, 1.5])
def test_inputs_that_act_late_are_the_plants(scene, cycle, delay):
    """A pulse asked for at one period, its steps with the inputs on their way, against the plant under what acts."""
    plant, k, rest, past = scene.plant, 10, cycle.rest, int(np.ceil(delay))
    m, part = int(delay), delay - int(delay)
    step, z = cycle.late(delay, past).step, np.zeros(5 + past)
    pulse, x = 1e-3, cycle.x[k].copy()

    def moved(x, u, share):
        n = max(1, round(share * scene.substeps))
        held = HeldSteps(plant, share * cycle.dt, n, np.zeros(1), np.zeros(plant.nw), plant.nominal_parameters)
        return held.ends(x[None], np.array([[u]]))[0]

    for j in range(3):
        z = step[k + j] @ np.append(z, pulse if j == 0 else 0.0)
        for share, age in ((part, m + 1), (1 - part, m)):
            if share:
                x = moved(x, pulse if j - age == 0 else 0.0, share)
    off = x - cycle.x[k + 3]
    off = off - off[cycle.angle] / cycle.flow[k + 2, cycle.angle] * cycle.flow[k + 2]
    assert z[:5] == pytest.approx(off[rest], rel=2e-3, abs=1e-9 * np.abs(off).max())


def test_on_time_it_is_the_problem_without_delay(cycle):
    A, B, Q, R, N = of_cycle(cycle, 1.0).system
    found = cycle.late(0.0, 0)
    assert np.concatenate([A, B], 2) == pytest.approx(found.step, abs=0)
    whole = cycle.late(1.0, 1)
    assert whole.step[:, :5, 5:6] == pytest.approx(B, rel=1e-12) and not whole.step[:, :5, 6].any()
    assert (whole.cost[:, 5, 5], whole.cost[:, :5, 5:6]) == (pytest.approx(R[:, 0, 0]), pytest.approx(N))
    assert pytest.approx(whole.cost[:, :5, :5]) == Q


def test_goals_that_are_no_cycle_are_refused():
    with pytest.raises(EquilibriumError, match="no cycle"):
        deviations(scenes.get("single-link-slew"))
    with pytest.raises(EquilibriumError, match="whole control periods"):
        whole_turns(np.pi, 0.1)
    assert whole_turns(1.0, 0.0625) == (1, 16) and whole_turns(5 / 12, 0.005) == (3, 250)


def test_turning(scene):
    j, rate = turning(scene)
    assert scene.plant.states[j].name == "crank_angle" and rate == pytest.approx(144 * np.pi / 30)
