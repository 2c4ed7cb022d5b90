"""Rodas5P's own steps: closed forms, its order on a plant, dense output, inputs of every form, where it stops."""

import dataclasses

import numpy as np
import pytest
from oscillators import Oscillator, Scalar
from scipy.integrate import solve_ivp

from pliant.plants import IntegrationError, SingleLinkArm
from pliant.plants.motions import adaptive_steps
from pliant.plants.rosenbrock.adaptive import LAW_AT, RosenbrockMotion, input_slope, next_jumps
from pliant.plants.rosenbrock.tableaux import rodas5p

P = np.zeros(0)
TIMES = np.linspace(0.0, 4.0, 9)


@pytest.fixture(autouse=True)
def on_the_virtual_machine(monkeypatch):
    monkeypatch.setenv("PLIANT_NATIVE", "0")


def motion(plant, tolerance=1e-9, law=None, times=TIMES, u=None, ends=None):
    held = np.zeros((len(times), plant.nu)) if u is None else u
    ends = next_jumps(held) if ends is None else ends
    return RosenbrockMotion(plant, times, held, law, np.zeros(plant.nw), P, rtol=tolerance, atol=tolerance, ends=ends)


def run(plant, x0, first=0.01, **options):
    made = motion(plant, **options)
    x = np.zeros((len(made.t), plant.nx))
    x[0] = x0
    made.begin(float(made.t[0]), x[0], first)
    made.march(x, len(made.t) - 1)
    return x, made


def test_a_vibration_is_a_cosine_to_the_tolerance(vibration):
    exact = np.cos(3.0 * TIMES)
    errors = [np.abs(run(vibration, [1.0, 0.0], tolerance=tol)[0][:, 0] - exact).max() for tol in (1e-6, 1e-9)]
    assert 1e-12 < errors[1] < 2e-7 and errors[1] < errors[0] / 100 < 1e-5


def test_the_order_is_five_on_an_arm():
    """Each period one step, for every error is allowed: halved steps err by a 32nd against dop853's at 1e-13."""
    arm = dataclasses.replace(SingleLinkArm.textbook(), kinematics="stiffened", modes=1)
    x0 = np.zeros(arm.nx)
    x0[0], x0[1] = 0.3, 0.02 * arm.link.length
    push = np.array([0.2])
    exact = arm.simulate(x0, push, [0.0, 0.02], rtol=1e-13, atol=1e-15).x[-1]
    errors = []
    for count in (8, 16, 32):
        times = np.linspace(0.0, 0.02, count + 1)
        each = {"times": times, "ends": np.arange(1, count + 1), "u": np.tile(push, (count + 1, 1))}
        x, made = run(arm, x0, first=1.0, tolerance=1e9, **each)
        assert made.steps == count
        errors.append(np.abs((x[-1] - exact) / np.abs(exact).max()).max())
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (slopes > 4.6).all() and (slopes < 6.0).all(), (errors, slopes)


def test_rows_between_steps_are_as_good_as_those_at_their_ends(vibration):
    """A thousand rows take few more steps than none between the ends does, and are a cosine."""
    many = np.linspace(0.0, 4.0, 1001)
    x, dense = run(vibration, [1.0, 0.0], times=many)
    assert dense.steps <= 1.2 * run(vibration, [1.0, 0.0], times=many[[0, -1]])[1].steps < 300
    np.testing.assert_allclose(x[:, 0], np.cos(3 * many), atol=1e-7)


def test_steps_end_where_an_input_jumps():
    """x'' = u from rest: x' = sum u dt, exactly."""
    plant, t = Oscillator(omega=1e-9), np.array([0.0, 0.1, 0.15, 0.4])
    u = np.array([[1.0], [-2.0], [3.0], [9.0]])
    x, _ = run(plant, [0.0, 0.0], first=1.0, times=t, u=u)
    np.testing.assert_allclose(x[:, 1], [0.0, 0.1, 0.0, 0.75], atol=1e-14)


def test_an_input_that_stays_is_no_jump(vibration):
    """Rows 0, 1 | 2, 3, 4 | 5: steps end on rows 2 and 5, and on the last; the last row's own input is never held."""
    u = np.array([[1.0], [1.0], [2.0], [2.0], [2.0], [0.0], [0.0], [3.0]])
    assert next_jumps(u).tolist() == [2, 2, 5, 5, 5, 7, 7]
    assert next_jumps(u[:2]).tolist() == [1] and next_jumps(np.zeros((4, 0))).tolist() == [3, 3, 3]
    held = np.where(np.arange(401) < 200, 1.0, -1.0)[:, None]
    x, made = run(vibration, [0.0, 0.0], times=np.linspace(0.0, 4.0, 401), u=held)
    assert made.steps < 300
    t = made.t[:201]
    np.testing.assert_allclose(x[:201, 0], (1 - np.cos(3 * t)) / 9, atol=1e-8)


def test_an_input_of_time_has_its_slope_from_the_stages(vibration):
    """x'' = -9 x + 8 cos t from (1, 0) is x = cos t; a polynomial of degree four has its slope exactly."""
    x, made = run(vibration, [1.0, 0.0], law=lambda t: 8.0 * np.cos(t))
    np.testing.assert_allclose(x[:, 0], np.cos(TIMES), atol=2e-7)
    assert made.steps < 400
    weights, at = input_slope(rodas5p()), rodas5p().alpha
    for k in range(5):
        assert weights @ at**k == pytest.approx(float(k == 1), abs=1e-10)
    assert np.count_nonzero(weights) == len(LAW_AT)


def test_time_in_the_rates_counts():
    """x' = sin t from t = 1: x = cos 1 - cos t."""
    t = np.linspace(1.0, 2.0, 11)
    x, _ = run(Scalar(rate=0.0), [0.0], times=t)
    np.testing.assert_allclose(x[:, 0], np.cos(1.0) - np.cos(t), atol=1e-8)


def test_what_is_stiff_costs_nothing_once_it_is_at_rest():
    """x' = -1e6 (x - cos t) - sin t (Prothero and Robinson): x = cos t, in steps thousands of times longer than
    the explicit pair's limit of 6e-6 s.
    """

    @dataclasses.dataclass(frozen=True, kw_only=True)
    class Stiff(Scalar):
        def ode(self, t, x, u, w):
            import casadi as ca

            return -1e6 * (x - ca.cos(t)) - ca.sin(t)

    many = np.linspace(0.0, 4.0, 201)
    x, made = run(Stiff(), [1.0], tolerance=1e-7, times=many)
    np.testing.assert_allclose(x[:, 0], np.cos(many), atol=2e-7)  # between the ends of steps too
    assert made.steps < 100


def test_steps_are_as_few_as_radaus_of_the_same_order(vibration):
    _, made = run(vibration, [1.0, 0.0], tolerance=1e-6)
    radau = solve_ivp(lambda t, x: [x[1], -9.0 * x[0]], (0, 4), [1.0, 0.0], "Radau", rtol=1e-6, atol=1e-6)
    assert made.steps < 3 * len(radau.t)


def test_it_stops_where_the_motion_ends_and_after_too_many_steps(blowing, monkeypatch):
    """1 / (1 - t) is infinite at 1 s."""
    with np.errstate(all="ignore"), pytest.raises(IntegrationError, match="rodas5p stopped at t = 1 s") as stopped:
        run(blowing, [1.0], times=np.array([0.0, 0.5, 2.0]))
    assert stopped.value.time == pytest.approx(1.0, abs=1e-6) and stopped.value.state.shape == (1,)
    monkeypatch.setattr(adaptive_steps, "MOST_STEPS", 9)
    with pytest.raises(IntegrationError, match=r"rodas5p stopped at .* after 9 steps, .* larger rtol and atol"):
        run(blowing, [1.0], times=np.array([0.0, 0.5, 2.0]))
