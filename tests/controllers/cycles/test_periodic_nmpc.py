"""NMPC about a cycle: near it the periodic regulator, far from it the limits."""

import dataclasses
import pickle

import numpy as np
import pytest

from pliant.controllers import NMPC, periodic_nmpc
from pliant.controllers.cycles.periodic_nmpc import CycleEnd
from pliant.studies.closed_loop.rollout import nominal, rollout


@pytest.fixture(scope="module")
def nmpc(scene, cycle, law):
    return NMPC.for_scene(scene, 10, terminal=CycleEnd(cycle, law), substeps=20)


def test_the_end_costs_what_the_regulators_cost_to_go_says(cycle, law):
    """|L (x - reference)|^2 against x'P x + 2 p'x of a deviation, up to a constant, at a node and one turn on."""
    end, made, k = CycleEnd(cycle, law), law.regulator, 37
    d = np.random.default_rng(0).standard_normal((3, 5)) * [1e-6, 1e-9, 0.1, 1e-5, 1e-7]
    found, wanted = [], []
    for e in d:
        x = cycle.x[k] + np.insert(e, cycle.angle, 2 * np.pi)
        reference, L = end.at(x)
        found.append(np.sum((L @ (x - reference)) ** 2))
        wanted.append(e @ made.P[k] @ e + 2 * made.p[k] @ e)
    assert np.diff(found) == pytest.approx(np.diff(wanted), rel=1e-6)
    along = cycle.flow[k - 1] / cycle.flow[k - 1, cycle.angle]
    assert L @ along == pytest.approx(np.zeros(5), abs=1e-9 * np.abs(L).max())  # being further on costs nothing


def test_near_the_cycle_a_change_of_state_changes_the_input_as_the_regulators_gain(cycle, law, nmpc):
    """To second order about the cycle both solve one problem: differences of inputs agree within 2 %."""
    inputs = []
    for rate in (0.0, 0.05):
        x = cycle.x[12] + np.array([0.0, 0.0, 0.0, rate, 0.0, 0.0])
        nmpc.reset()
        nmpc.horizon.t = 0.0
        solved = nmpc.iterate(x)
        inputs.append((solved.u[0, 0], law.unlimited(x)[0][0]))
    own, wanted = np.diff(np.array(inputs), axis=0)[0]
    assert own == pytest.approx(wanted, rel=0.02)


def test_from_far_it_comes_to_the_cycle_within_its_limits(scene, nmpc):
    far = dataclasses.replace(scene, start=(("crank_angle_rate", 12.0),), duration=0.3)
    run = rollout(far, nmpc, nominal(far))
    assert run.failure == "" and np.abs(run.u).max() == pytest.approx(50.0)
    assert run["crank_angle_rate"][-1] == pytest.approx(15.08, abs=0.01)
    assert nmpc.record.failures == 0


def test_a_copy_goes_on_alike(cycle, nmpc):
    nmpc.reset()
    for k in range(2):
        nmpc.act(cycle.dt * k, cycle.x[k])
    again = pickle.loads(pickle.dumps(nmpc))
    assert again.act(2 * cycle.dt, cycle.x[2]) == pytest.approx(nmpc.act(2 * cycle.dt, cycle.x[2]), abs=1e-9)


def test_its_end_is_not_to_be_given(scene):
    with pytest.raises(ValueError, match=r"periodic_nmpc\.terminal = None must be left out"):
        periodic_nmpc(scene, terminal=None)
