"""The fast path's word: a step past the limit is refused as `simulate` refuses it, lanes that run away are told."""

import dataclasses
import warnings

import numpy as np
import pytest

from pliant.plants import LargeDeflectionBeam, SingleLinkArm, SliderCrank, StabilityLimitError, TwoLinkArm
from pliant.plants.core.errors import DivergenceWarning
from pliant.plants.integration.step_guard import EVERY, StepGuard, sound
from pliant.plants.integration.step_maps import step_limit
from pliant.plants.integration.step_sensitivities import StepSensitivities

PLANTS = {
    "one": SingleLinkArm.textbook(),
    "two": TwoLinkArm.textbook(),
    "large": dataclasses.replace(LargeDeflectionBeam.textbook(), modes=2),
    "crank": SliderCrank.textbook(),
}


@pytest.mark.every(2)
@pytest.mark.parametrize("method", ["rk4", "rk8"])
@pytest.mark.parametrize("name", PLANTS)
def test_the_same_steps_are_refused_as_by_simulate(name, method):
    plant = PLANTS[name]
    limit = step_limit(plant, plant.rest_state, method)
    plant.stepper(0.999 * limit, method=method)
    with pytest.raises(StabilityLimitError) as fast:
        plant.stepper(1.001 * limit, method=method)
    with pytest.raises(StabilityLimitError) as slow:
        plant.simulate(None, None, [0.0, 10.01 * limit], method=method, step=1.001 * limit)
    assert fast.value.largest_step == pytest.approx(slow.value.largest_step, rel=1e-9) == limit


def test_lanes_away_from_rest_and_their_parameters_are_looked_at():
    """The link with a ninth of its density vibrates three times as fast."""
    plant = PLANTS["one"].vary("link.density")
    own = plant.nominal_parameters
    limit = step_limit(plant, plant.rest_state, "rk4")
    step = plant.stepper(0.9 * limit, batch=3)
    x = np.zeros((3, plant.nx))
    step(x, np.zeros(1))
    with pytest.raises(StabilityLimitError):
        step(x, np.zeros(1), np.array([own, own / 9, own]))
    opted_out = plant.stepper(0.9 * limit, batch=3, check=False)
    opted_out(x, np.zeros(1), np.array([own, own / 9, own]))


@pytest.mark.campaign
def test_an_implicit_method_has_no_limit():
    plant = PLANTS["one"]
    assert StepGuard(plant, "rosenbrock", 1.0, check=True)._limited is False
    plant.stepper(0.1, method="rosenbrock")


def test_lanes_that_run_away_are_told_once_and_which():
    plant = PLANTS["two"]
    step = plant.stepper(0.003, batch=2, check=False)
    x = np.zeros((2, plant.nx))
    x[:, 0] = -1.5
    x[1, 2] = 1e6  # a link bent by a thousand kilometres
    assert step.sound.all()
    with pytest.warns(DivergenceWarning, match=r"1 of 2 lanes are no longer finite after \d+ calls .* lane 1 first"):
        for _ in range(EVERY):
            x = step(x, np.zeros(2))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        step(x, np.zeros(2))
    assert step.sound.tolist() == [True, False]


def test_sound_is_by_lane():
    assert sound(np.array([[0.0, 1.0], [np.nan, 0.0], [np.inf, 1.0]])).tolist() == [True, False, False]


def test_sensitivities_refuse_the_same_step():
    plant = PLANTS["two"]
    with pytest.raises(StabilityLimitError):
        StepSensitivities(plant, 0.05)


@pytest.mark.parametrize(
    ("dt", "message"),
    [
        (float("nan"), r"stepper\.dt = nan must be > 0 \[s\]"),
        (None, r"stepper\.dt = None must be > 0 \[s\]"),
        (1e-300, r"stepper\.dt = 1e-300 must be from 1e-15 to 1e\+09 \[s\]"),
        (1e300, r"stepper\.dt = 1e\+300 must be from 1e-15"),
        (True, r"stepper\.dt = True must be > 0 \[s\]"),
        ("0.1", r"stepper\.dt = '0\.1' must be > 0 \[s\]"),
    ],
)
def test_no_time_is_taken_that_is_none(dt, message):
    with pytest.raises(ValueError, match=message):
        PLANTS["one"].stepper(dt)
