"""The filter's covariance, held against seeded runs of the nonlinear plant and against the sensors' own words."""

import pickle

import numpy as np
import pytest

from pliant.controllers.cycles.periodic_kalman import PeriodicKalman, _pushed
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.plants import UncontrollableError
from pliant.plants.sensing.sensors import sensors_of


@pytest.fixture(scope="module")
def filter_(cycle):
    return PeriodicKalman.about(cycle, None, None, 0.0)


def test_errors_decay(filter_):
    assert filter_.multipliers[0] < 1e-3 and filter_.reads == ("crank_angle", "mid_acceleration")


def test_the_covariance_is_what_seeded_runs_of_the_plant_see(scene, cycle, filter_):
    """64 machines over 20 periods with the noises that the filter was told, each filtered for itself; of all errors
    after half of them, in the filter's own deviations, the mean square is 1."""
    plant, rng, runs = scene.plant, np.random.default_rng(0), 64
    sensors = sensors_of(plant)
    deviation = np.array([s.deviation(scene.dt) for s in sensors])
    held = HeldSteps(
        plant, scene.dt, scene.substeps, np.zeros(runs), np.zeros(plant.nw), plant.nominal_parameters
    )  # all machines in one call
    x = np.tile(cycle.x[0], (runs, 1)) + rng.standard_normal((runs, 6)) * np.sqrt(np.diag(filter_.P[1]))
    own = [pickle.loads(pickle.dumps(filter_)) for _ in range(runs)]
    for one in own:
        one.reset(cycle.x[0])
    given, squares = np.zeros((runs, 1)), []
    for k in range(20):
        told = np.concatenate([x, plant.measure(x, given)], axis=1)[:, own[0]._picks]
        told = told + rng.standard_normal((runs, 2)) * deviation
        for j, one in enumerate(own):
            e = one.step(told[j], np.zeros(1)) - x[j]
            if k >= 10:
                squares.append(e**2 / np.diag(one.covariance))
        given = 0.5 * rng.standard_normal((runs, 1))  # 1 % of the limit: what the scene's noise is
        x = held.ends(x, given)
    assert np.mean(squares, axis=0) == pytest.approx(np.ones(6), rel=0.25)


def test_an_encoder_that_starts_again_at_each_turn_is_understood(cycle, filter_):
    y = np.array([cycle.x[100, 0], 1.0])
    filter_.reset(cycle.x[100])
    wanted = filter_.step(y).copy()
    filter_.reset(cycle.x[100])
    assert filter_.step(y - [2 * np.pi, 0.0]) == pytest.approx(wanted, abs=1e-9)


def test_inputs_that_act_late_move_its_plant_late(scene, cycle):
    """Half a period late: the plant under what acts, in two halves."""
    plant, late = scene.plant, PeriodicKalman.about(cycle, None, None, 0.5)
    late.reset(cycle.x[0])
    late.L[:] = 0.0  # prediction alone
    y = np.zeros(2)
    late.step(y)
    late.step(y, np.array([10.0]))
    found = late.step(y, np.array([-20.0]))
    x, given = cycle.x[0], (np.zeros(plant.nw), plant.nominal_parameters)
    half = HeldSteps(plant, cycle.dt / 2, scene.substeps // 2, np.zeros(1), *given)
    for u in (0.0, 10.0, 10.0, -20.0):
        x = half.ends(x[None], np.array([[u]]))[0]
    assert found == pytest.approx(x, rel=1e-9, abs=1e-12)


def test_a_disturbances_push_is_the_plants(scene, cycle):
    i = [s.name for s in scene.plant.disturbances].index("middle_force")
    plant, w = scene.plant, np.zeros(scene.plant.nw)
    w[i] = 1e-3
    t, u = np.zeros(3), np.zeros((3, 1))
    ends = [
        HeldSteps(plant, cycle.dt, scene.substeps, t, value, plant.nominal_parameters).ends(cycle.x[:3], u)
        for value in (w, 0 * w)
    ]
    assert (ends[0] - ends[1]) / 1e-3 == pytest.approx(_pushed(cycle, i, 1e-2)[:3], rel=1e-4, abs=1e-9)


def test_what_the_sensors_do_not_see_is_refused(scene, cycle):
    angle, acceleration = sensors_of(scene.plant)
    with pytest.raises(ValueError, match="at least one Sensor"):
        PeriodicKalman.about(cycle, (), None, 0.0)
    with pytest.raises(ValueError, match="input or disturbance"):
        PeriodicKalman.about(cycle, None, {"nothing": 1.0}, 0.0)
    try:  # the acceleration alone tells the angle by how the rod is shaken: seen, if at all, badly
        alone = PeriodicKalman.about(cycle, (acceleration,), None, 0.0)
    except UncontrollableError:
        return
    both = PeriodicKalman.about(cycle, (angle, acceleration), None, 0.0)
    assert alone.P[1, 0, 0] > both.P[1, 0, 0]
