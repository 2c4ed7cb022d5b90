"""Inputs of every form, and when a sampled controller is asked."""

import numpy as np
import pytest
from oscillators import Oscillator

from pliant.plants.motions.held_inputs import HeldInput, sampling_grid

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


def test_held_array_equals_the_function_that_holds_it():
    times = np.linspace(0, 1, 11)
    u = np.random.default_rng(1).normal(size=(11, 1))
    plant = Oscillator(zeta=0.1)
    exact = plant.linearize(np.zeros(2)).discretize(0.1)
    x = np.zeros((11, 2))
    x[0] = [0.1, 0.0]
    for k in range(10):
        x[k + 1] = exact.A @ x[k] + exact.B @ u[k]
    for method, options in (
        ("dop853", {}),
        ("rodas5p", {}),
        ("radau", {}),
        ("cvodes", {}),
        ("rk4", {"step": 1e-3}),
        ("rk8", {"step": 0.02}),
    ):
        motion = plant.simulate(x[0], u, times, method=method, **options)
        np.testing.assert_allclose(motion.x, x, rtol=0, atol=2e-8)
        np.testing.assert_array_equal(motion.u, u)
        np.testing.assert_allclose(motion["sum"], x[:, 0] + u[:, 0], rtol=0, atol=2e-8)
    constant = plant.simulate(x[0], [2.0], times)
    called = plant.simulate(x[0], lambda t: [2.0], times)
    np.testing.assert_allclose(constant.x, called.x, rtol=0, atol=1e-12)
    np.testing.assert_allclose(plant.simulate(x[0], np.full((11, 1), 2.0), times).x, called.x, atol=1e-9)
    assert constant.hold == called.hold == "linear"


class Recorder:
    """A sampled controller that notes when it is asked and what it is shown."""

    def __init__(self, dt=None, reads=()):
        self.dt, self.reads, self.calls, self.resets = dt, reads, [], 0

    def reset(self):
        self.resets += 1

    def act(self, t, y):
        self.calls.append((t, y.copy()))
        return np.array([-y[0]])


@pytest.mark.parametrize(("dt", "interval"), [(0.1, 0.1), (0.1, 0.02), (0.1, 0.25), (0.1, 1.0), (0.03, 0.1)])
def test_a_controller_is_sampled_at_its_own_period(dt, interval):
    watcher = Recorder(dt, reads=("x",))
    times = interval * np.arange(round(1 / interval) + 1)
    motion = Oscillator().simulate([1.0, 0.0], watcher, times)
    asked = np.array([t for t, _ in watcher.calls])
    np.testing.assert_allclose(asked, dt * np.arange(len(asked)), atol=1e-12)
    assert asked[-1] > 1 - dt - 1e-9 and watcher.resets == 1
    # The motion is that of the sampled loop, whatever the times it is reported at.
    loop = Oscillator().linearize(np.zeros(2)).discretize(dt)
    x, closed = np.array([1.0, 0.0]), loop.A - loop.B @ [[1.0, 0.0]]
    for _, y in watcher.calls:
        assert y[0] == pytest.approx(x[0], abs=1e-8)
        x = closed @ x
    np.testing.assert_array_equal(motion.t, times)


def test_a_controller_without_period_acts_at_every_time_and_reads_outputs():
    watcher = Recorder()
    motion = Oscillator().simulate([1.0, 0.0], watcher, np.linspace(0, 1, 8), method="rk4", step=0.01)
    assert [t for t, _ in watcher.calls] == list(motion.t)
    assert motion.u[0, 0] == -1.0 and motion.hold == "zero-order"
    named = Recorder(reads=("x_rate", "sum"))
    Oscillator().simulate([1.0, 5.0], named, [0, 0.1])
    np.testing.assert_allclose(named.calls[0][1], [5.0, 1.0])
