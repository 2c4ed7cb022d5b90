"""Integration: orders, step limits of known oscillators, agreement of methods, inputs of every form."""

import dataclasses
import warnings
from dataclasses import dataclass
from math import factorial

import casadi as ca
import numpy as np
import pytest
from convergence import slope

from pliant.plants import IntegrationError, Plant, Signal, SingleLinkArm, StabilityLimitError, TwoLinkArm, step_limit
from pliant.plants.integration import step_maps
from pliant.plants.integration.step_maps import stepper

ARM = dataclasses.replace(TwoLinkArm.textbook(), hub_inertia=(0.1, 0.02), modes=(1, 1))
METHODS = {"rk4": 4, "rk8": 8, "midpoint": 2, "rosenbrock": 3}
STEPS = {"rk8": np.array([6, 8, 10, 12])}  # where errors are above rounding
RK4_REAL = 2.785293563405282  # root of 1 + z/2 + z^2/6 + z^3/24 = 0


@dataclass(frozen=True, kw_only=True)
class Oscillator(Plant):
    """x'' + 2 zeta omega x' + omega^2 x = u + w; the output is x + u."""

    omega: float = 10.0
    zeta: float = 0.0

    states = (Signal("x", "m"), Signal("x_rate", "m/s"))
    inputs = (Signal("u", "m/s^2"),)
    disturbances = (Signal("w", "m/s^2"),)
    outputs = (Signal("sum", ""),)
    label = "oscillator"

    def ode(self, t, x, u, w):
        return ca.vertcat(x[1], u + w - self.omega**2 * x[0] - 2 * self.zeta * self.omega * x[1])

    def output(self, t, x, u, w):
        return x[0] + u

    def ladder(self):
        return (self,)


@dataclass(frozen=True, kw_only=True)
class Scalar(Plant):
    """One state: x' = rate x, or a logarithm that ends at x = 1."""

    rate: float = -1.0
    ends: bool = False

    states = (Signal("x", ""),)
    inputs = ()
    disturbances = ()
    outputs = (Signal("y", ""),)
    label = "scalar"

    def ode(self, t, x, u, w):
        return 2 + ca.sqrt(1 - x) if self.ends else self.rate * x + ca.sin(t)

    def output(self, t, x, u, w):
        return x

    def ladder(self):
        return (self,)


@pytest.mark.parametrize("method", list(METHODS))
def test_order_under_an_input_of_time(method):
    """Forced vibration against its closed form: the stages see the input at their own times."""
    plant = Oscillator(omega=5.0, zeta=0.1)
    t = np.linspace(0, 1, 3)
    lam = np.roots([1, 2 * 0.1 * 5, 25]).astype(complex)
    force = 1 / ((3j) ** 2 + 1.0 * 3j + 25)  # response to e^(3 i t)
    particular, rate = np.real(force), np.real(3j * force)
    c = np.linalg.solve(np.array([[1, 1], lam]), [0.2 - particular, -rate])
    exact = np.real(c @ np.exp(lam * 1.0)) + np.real(force * np.exp(3j))
    steps = 0.5 / STEPS.get(method, np.array([16, 32, 64, 128]))
    errors = [
        abs(plant.simulate([0.2, 0.0], lambda t: [np.cos(3 * t)], t, method=method, step=h).x[-1, 0] - exact)
        for h in steps
    ]
    assert slope(steps, errors) == pytest.approx(METHODS[method], rel=0.04, abs=0.2)
    assert errors[-1] < 1e-4


@pytest.mark.parametrize("method", list(METHODS))
def test_order_of_an_explicitly_time_dependent_plant(method):
    t, steps, rate = np.linspace(0, 2, 2), 1 / STEPS.get(method, np.array([16, 32, 64, 128])), -4.0
    exact = (1 + 1 / 17) * np.exp(2 * rate) - (rate * np.sin(2.0) + np.cos(2.0)) / 17  # x(0) = 1
    plant = Scalar(rate=rate)
    errors = [abs(plant.simulate([1.0], None, t, method=method, step=h).x[-1, 0] - exact) for h in steps]
    assert slope(steps, errors) == pytest.approx(METHODS[method], rel=0.04, abs=0.2)


@pytest.mark.parametrize("omega", [0.3, 10.0, 2e4])
def test_rk4_limit_of_an_undamped_vibration_is_two_root_two_over_omega(omega):
    limit = step_limit(Oscillator(omega=omega), np.zeros(2))
    assert limit == pytest.approx(2 * np.sqrt(2) / omega, rel=1e-10)


def test_rk4_limit_of_real_modes():
    limit = step_limit(Scalar(rate=-40.0), np.zeros(1))
    assert limit == pytest.approx(RK4_REAL / 40.0, rel=1e-10)
    fast = 10.0 * (2 + np.sqrt(3.0))  # the faster of two real modes at zeta = 2
    assert step_limit(Oscillator(zeta=2.0), np.zeros(2)) == pytest.approx(RK4_REAL / fast, rel=1e-8)


@pytest.mark.parametrize("zeta", [1e-7, 1e-3, 0.05, 0.5, 0.9])
def test_rk4_limit_of_a_damped_vibration_is_where_the_map_stops_contracting(zeta):
    plant = Oscillator(zeta=zeta)
    limit = step_limit(plant, np.zeros(2))
    z = 10.0 * complex(-zeta, np.sqrt(1 - zeta**2))

    def growth(h):
        return abs(sum((h * z) ** k / [1, 1, 2, 6, 24][k] for k in range(5)))

    assert growth(limit) == pytest.approx(1, abs=1e-9)
    assert all(growth(h) < 1 + 1e-12 for h in np.linspace(0, limit, 50))
    assert growth(limit * 1.001) > 1


@pytest.mark.parametrize("method", ["rk4", "rk8"])
@pytest.mark.parametrize("zeta", [0.0, 1e-7, 1e-3, 0.5, 2.0])
def test_limit_is_where_the_steps_themselves_stop_contracting(method, zeta):
    """Spectral radius of the map of one step, from the steps of the two unit states."""
    plant = Oscillator(zeta=zeta)
    limit = step_limit(plant, np.zeros(2), method)

    def radius(h):
        step = stepper(plant, method)
        us = np.zeros(len(step_maps.METHODS[method].input_times))
        map_ = np.column_stack([step(0.0, x, us, np.zeros(1), np.zeros(0), h)[0] for x in np.eye(2)])
        return np.abs(np.linalg.eigvals(map_)).max()

    assert all(radius(h) < 1 + 1e-11 for h in np.linspace(0, limit * (1 - 1e-9), 60))
    assert radius(1.001 * limit) > 1 + 1e-6


def test_rk8_limits_are_those_of_its_published_tableau():
    """|R| = 1 at 5.96 i and at -6.39, R(z) = sum_k z^k b . A^(k-1) 1; the order is 8: c_k = 1/k! up to there."""
    R = step_maps.METHODS["rk8"].tableau.polynomial
    np.testing.assert_allclose(R[:9], 1 / np.array([factorial(k) for k in range(9)]), rtol=1e-12)
    assert abs(R[9] * factorial(9) - 1) > 0.01
    assert step_limit(Oscillator(), np.zeros(2), "rk8") == pytest.approx(0.5961, rel=1e-3)
    assert step_limit(Scalar(rate=-40.0), np.zeros(1), "rk8") == pytest.approx(6.393 / 40, rel=1e-3)


def test_implicit_methods_have_no_limit_and_growing_modes_are_left_out():
    for method in ("midpoint", "rosenbrock"):
        assert step_limit(Oscillator(), np.zeros(2), method) == np.inf
    assert step_limit(Scalar(rate=5.0), np.zeros(1)) == np.inf  # grows by itself


def test_limit_of_a_moving_arm_counts_its_fastest_mode_even_where_that_grows_a_little(reference):
    """Frozen eigenvalues of an undamped arm in motion have real parts of either sign."""
    arm, found = TwoLinkArm.textbook(), reference("two_link")["states"]["s1"]
    for sign in (1, -1):
        x = np.concatenate([found["q"], sign * np.array(found["qd"])])
        fastest = np.abs(np.linalg.eigvals(arm.jacobians(x)[0])).max()
        assert step_limit(arm, x) == pytest.approx(2 * np.sqrt(2) / fastest, rel=0.02)


def test_stability_limit_error_says_what_to_do():
    plant = Oscillator(omega=100.0)
    with pytest.raises(StabilityLimitError, match=r"step of 0\.03 s .* 15\.92 Hz .* at most 0\.02828 s") as caught:
        plant.simulate([1.0, 0.0], None, np.linspace(0, 3, 11), method="rk4", step=0.03)
    error = caught.value
    assert error.step == pytest.approx(0.03) and error.largest_step == pytest.approx(np.sqrt(8) / 100)
    assert abs(error.mode) == pytest.approx(100.0)
    assert "rosenbrock" in str(error)
    # A step that no interval is long enough for is cut down to the interval.
    plant.simulate([1.0, 0.0], None, np.linspace(0, 0.1, 11), method="rk4", step=0.03)


def test_l_stable_method_takes_a_step_that_explicit_ones_cannot():
    stiff = Scalar(rate=-1e6)
    motion = stiff.simulate([1.0], None, [0, 0.1, 0.2], method="rosenbrock", step=0.01)
    assert motion.x[-1, 0] == pytest.approx(1e-6 * np.sin(0.2), rel=1e-3)


def test_midpoint_that_finds_no_solution_stops():
    arm = TwoLinkArm.textbook()
    x = np.zeros(12)
    x[6:8] = 20.0, -40.0  # far past what linear kinematics can hold
    with pytest.raises(IntegrationError, match="midpoint diverged") as caught:
        arm.simulate(x, None, np.linspace(0, 0.9, 4), method="midpoint", step=0.3)
    assert caught.value.time < 0.9 and caught.value.state.shape == (12,)


@pytest.mark.parametrize("method", ["dop853", "radau", "cvodes"])
def test_a_plant_that_turns_into_nan_stops_with_time_and_state(method):
    with pytest.raises(IntegrationError) as caught:
        Scalar(ends=True).simulate([0.0], None, np.linspace(0, 2, 5), method=method)
    assert 0 <= caught.value.time <= 0.5 and np.all(np.isfinite(caught.value.state))


def test_adaptive_methods_agree():
    times = np.linspace(0, 0.4, 5)
    u = np.tile([1.0, 0.5], (5, 1)) * np.sin(times)[:, None]
    x0, _ = ARM.equilibrium(theta1=-1.2, theta2=0.4)
    exact = ARM.simulate(x0, u, times, rtol=1e-12, atol=1e-14)
    assert np.abs(exact.x - x0).max() > 0.1
    for method, options, close in (
        ("dop853", {}, 1e-8),
        ("radau", {"rtol": 1e-9, "atol": 1e-11}, 1e-6),
        ("cvodes", {}, 1e-6),
        ("rk4", {"step": 5e-4}, 1e-4),
        ("rk8", {"step": 1e-3}, 1e-6),
        ("rosenbrock", {"step": 5e-4}, 1e-2),
        ("midpoint", {"step": 2e-4}, 1e-2),
    ):
        motion = ARM.simulate(x0, u, times, method=method, **options)
        assert np.abs(motion.x - exact.x).max() < close, method
        assert motion.hold == "zero-order" and motion.stats["method"] == method


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


def test_exact_rate_comes_with_the_motion():
    motion = Oscillator().simulate([1.0, 0.0], None, np.linspace(0, 1, 5), w=[3.0])
    t = motion.t
    np.testing.assert_allclose(motion.x[:, 0], 0.03 + 0.97 * np.cos(10 * t), atol=1e-8)
    np.testing.assert_allclose(motion.dx[:, 1], -97 * np.cos(10 * t), atol=1e-6)
    np.testing.assert_array_equal(motion.w, np.full((5, 1), 3.0))


def test_start_at_an_exact_equilibrium_does_not_run_away():
    """Every error estimate is zero there, and a first step as long as the run would overlook what comes."""
    arm = TwoLinkArm.textbook()
    x0, u0 = arm.equilibrium(theta1=-np.pi / 2, theta2=0.0)

    def push(t):
        return u0 + np.array([1.0, 0.0]) if 1.0 <= t < 1.02 else u0

    rtol, atol = 1e-10, 1e-12
    rest = arm.simulate(x0, u0, [0, 2], rtol=rtol, atol=atol)
    # Rounding of the gravity moments (1e-16 N m, not 0) sets the arm in motion, and what it does then is up to the
    # integrator: each step may err by its tolerance (a root mean square: sqrt(nx) in one state), and without damping
    # the steps' errors add up; a rate's are those of its coordinate times the highest angular frequency.
    allowed = rest.stats["steps"] * np.sqrt(arm.nx) * (atol + rtol * np.abs(x0).max())
    assert allowed < 1e-6
    np.testing.assert_allclose(rest.x[-1, :6], x0[:6], rtol=0, atol=allowed)
    fastest = arm.natural_frequencies(x0).max()
    np.testing.assert_allclose(rest.x[-1, 6:], 0, rtol=0, atol=allowed * fastest)
    moved = arm.simulate(x0, push, [0, 2], rtol=rtol, atol=atol)
    assert np.abs(moved.x[-1, :6] - x0[:6]).max() > 1e3 * allowed


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


def test_progress_is_told_of_the_time_reached():
    seen = []
    SingleLinkArm.textbook().simulate(np.zeros(6), [1.0], np.linspace(0, 0.1, 5), progress=seen.append)
    np.testing.assert_allclose(seen, np.linspace(0, 0.1, 5)[1:])


@pytest.mark.parametrize(("name", "value"), [("u", [[0.0]]), ("p", [1.0]), ("u", "abc")])
def test_a_limit_is_of_one_point(name, value):
    arm = SingleLinkArm.textbook()
    with pytest.raises(ValueError, match=rf"step_limit\.{name} "):
        step_limit(arm, np.zeros(arm.nx), **{name: value})


def test_a_state_too_large_for_the_equations_is_refused_in_words():
    arm = SingleLinkArm.textbook()
    with warnings.catch_warnings(), pytest.raises(ValueError, match=r"step_limit\.x = .* not finite"):
        warnings.simplefilter("ignore")
        step_limit(arm, np.full(arm.nx, 1e200))
