"""Inputs of every form, and when a sampled controller is asked."""

import numpy as np
import pytest

from pliant.plants.integration.held_inputs import HeldInput, sampling_grid

T, W, P = np.array([0.0, 0.4, 1.0]), np.zeros(1), np.zeros(0)


class Together:
    """A function of time with a value for many times at once."""

    def __init__(self, many):
        self.at_times = many

    def __call__(self, t):
        return [t]


class Ramp:
    """Acts with the number of times it has been asked, every `dt` [s]."""

    def __init__(self, dt, reads=()):
        self.dt, self.reads, self.asked, self.read = dt, reads, 0, []

    def reset(self):
        self.asked = 0

    def act(self, t, y):
        self.asked += 1
        self.read.append(y.tolist())
        return [float(self.asked)]


@pytest.mark.parametrize(
    ("u", "smooth", "expected"),
    [(None, True, [0, 0, 0]), ([2.0], True, [2, 2, 2]), ([[1.0], [2.0], [3.0]], False, [1, 2, 3])],
)
def test_none_constant_and_held(vibration, u, smooth, expected):
    drive = HeldInput(vibration, u, T, W, P)
    assert drive.smooth is smooth and drive.samples.ravel().tolist() == expected


def test_a_function_of_time(vibration):
    drive = HeldInput(vibration, lambda t: 3.0 * t, T, W, P)
    assert drive.smooth and drive.samples.ravel() == pytest.approx([0.0, 1.2, 3.0])
    with pytest.raises(ValueError, match=r"u\(0\) = \[1\. 2\.\] must be 1 finite numbers"):
        HeldInput(vibration, lambda t: [1.0, 2.0], T, W, P)


def test_sampling_times_join_the_times_asked_for():
    grid, rows = sampling_grid(T, Ramp(0.25))
    assert grid.tolist() == [0.0, 0.25, 0.4, 0.5, 0.75, 1.0] and rows.tolist() == [0, 2, 5]
    grid, rows = sampling_grid(np.array([0.0, 0.1 + 1e-12, 0.2]), Ramp(0.1))
    assert len(grid) == 3  # times this close are one
    with pytest.raises(ValueError, match=r"controller dt = 0 must be > 0"):
        sampling_grid(T, Ramp(0))


def test_a_controller_is_asked_at_its_own_times_and_reads_by_name(vibration):
    law = Ramp(0.5, reads=("speed", "sum"))
    grid = sampling_grid(T, law)[0]
    drive = HeldInput(vibration, law, grid, W, P)
    for k in range(len(grid)):
        drive.decide(k, np.array([10.0, 20.0]))
    assert grid.tolist() == [0.0, 0.4, 0.5, 1.0]
    assert drive.samples.ravel().tolist() == [1.0, 1.0, 2.0, 3.0]
    assert law.read == [[20.0, 10.0], [20.0, 11.0], [20.0, 12.0]]  # the output is the place plus the input held


def test_many_times_at_once_are_checked_as_one_is(vibration):
    """They are never replaced in silence by what the function says of one time."""
    drive = HeldInput(vibration, Together(lambda t: [[2 * s] for s in t]), T, W, P)
    assert drive.at(T).tolist() == [0.0, 0.8, 2.0]
    for many, why in (
        (lambda t: np.ones((1, len(t))), r"has shape \(1, 3\), must be \(3, 1\)"),
        (lambda t: np.ones((len(t) + 1, 1)), r"has shape \(4, 1\), must be \(3, 1\)"),
        (lambda t: 1.0, r"has shape \(\), must be \(3, 1\)"),
        (lambda t: np.where(t > 0.5, np.nan, t)[:, None], r"\[2, 0\] = nan must be finite"),
    ):
        with pytest.raises(ValueError, match=r"u\.at_times of 3 times ?" + why):
            HeldInput(vibration, Together(many), T, W, P)
    assert HeldInput(vibration, Together(T), T, W, P).samples.ravel().tolist() == T.tolist()  # a name of its own
