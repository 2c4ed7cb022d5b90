"""One gain for a box: LQR's where the box is one model, stable at its corners, as played as it was designed."""

import copy
import pickle

import numpy as np
import pytest

from pliant.controllers import LQR, MultiModelLQR
from pliant.envs import scenes
from pliant.plants import PliantError
from pliant.studies.closed_loop.contestants import CONTESTANTS, designed, playable
from pliant.studies.closed_loop.rollout import rollout
from pliant.studies.scoreboard.tasks import conditions, played_scene

SLEW = scenes.get("single-link-slew")


@pytest.fixture(scope="module")
def from_states():
    return MultiModelLQR.for_scene(SLEW)


@pytest.fixture(scope="module")
def from_sensors():
    return MultiModelLQR.for_scene(SLEW, reads="sensors")


def test_of_one_model_it_is_lqr_up_to_what_noise_asks_for():
    one, lqr = MultiModelLQR.for_scene(SLEW, ranges={}, delays=(0,)), LQR.for_scene(SLEW)
    away = SLEW.initial[0] - SLEW.target[0]
    assert rollout(SLEW, one).cost == pytest.approx(rollout(SLEW, lqr).cost, rel=2e-3)
    assert one.cost >= float(away @ lqr.P @ away) * (1 - 1e-9)  # of the start alone, without noise


def test_it_is_stable_at_the_corners_late_and_on_time(from_states):
    """The loop is closed here anew: x, and the input before."""
    K, nx = from_states.K, SLEW.plant.nx
    worst = 0.0
    for mass in (0.7, 1.3):
        for E in (0.7, 1.3):
            plant = SLEW.plant.vary("payload.mass", "link.E")
            p = plant.nominal_parameters * [mass, E]
            model = plant.feedback_model(*SLEW.target, p=p).discretize(SLEW.dt)
            on_time = np.block([[model.A - model.B @ K[:, :nx], -model.B @ K[:, nx:]], [-K[:, :nx], -K[:, nx:]]])
            late = np.block([[model.A, model.B], [-K[:, :nx], -K[:, nx:]]])
            worst = max(worst, *(np.abs(np.linalg.eigvals(loop)).max() for loop in (on_time, late)))
    assert worst < 1 and worst <= from_states.radius + 1e-3


def test_acts_are_the_gain_times_what_it_remembers(from_sensors):
    law, (ny, nu) = from_sensors, (len(from_sensors.reads), 1)
    law.reset()
    rng = np.random.default_rng(0)
    ys = [law.y0 + 1e-3 * rng.standard_normal(ny) for _ in range(9)]
    us = []
    for k, y in enumerate(ys):
        inputs = [us[k - i] - law.u0 if k >= i else law.start - law.u0 for i in (1, 2)]
        readings = [ys[max(k - i, 0)] - law.y0 for i in range(1, 5)]
        z = np.concatenate([y - law.y0, *inputs, *readings])
        assert len(z) == law.K.shape[1] == 5 * ny + 2 * nu
        us.append(law.act(0.02 * k, y))
        np.testing.assert_allclose(us[-1], law.u0 - law.K @ z, atol=1e-12)
    again = pickle.loads(pickle.dumps(law))
    again.reset()
    np.testing.assert_array_equal([again.act(0.0, y) for y in ys], us)


def test_limits_hold_and_what_acted_is_remembered(from_states):
    law = copy.deepcopy(from_states)
    law.reset()
    far = law.y0 + 50.0
    assert abs(law.act(0.0, far)[0]) == SLEW.limits[0]
    nothing = law.act(0.02, law.y0)
    assert nothing == pytest.approx(
        law.u0 - law.K[:, -1] * np.sign(-law.K[0] @ np.append(far - law.y0, 0)) * SLEW.limits[0]
    )


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="reads"):
        MultiModelLQR.for_scene(SLEW, reads="minds")
    with pytest.raises(ValueError, match="smallest <= largest"):
        MultiModelLQR.for_scene(SLEW, ranges={"payload.mass": (2.0, 1.0)})
    with pytest.raises(ValueError, match=r"MultiModelLQR.delays = \(\)"):
        MultiModelLQR.for_scene(SLEW, delays=())
    with pytest.raises(PliantError, match="no gain was found"):
        MultiModelLQR.for_scene(SLEW, reads="sensors", delays=(0, 16), iterations=2)


@pytest.mark.campaign
@pytest.mark.parametrize("scene", ["single-link-slew", "two-link-reach"])
@pytest.mark.parametrize("name", ["multi-model LQR", "multi-model, sensors"])
def test_none_of_64_runs_fails_in_any_column(scene, name):
    own = playable((scene,))[0]
    law = designed(own, CONTESTANTS[name])
    for case in ("exact", "finer", "varied", "delayed", "all at once"):
        runs = [rollout(played_scene(own, case)[0], law, given) for given in conditions(own, case, 64, 0)]
        assert not [run.failure for run in runs if run.failure], case
