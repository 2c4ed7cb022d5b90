"""Stability limits of explicit steps: of known oscillators, of published tableaux and of the steps themselves."""

import warnings
from math import factorial

import casadi as ca
import numpy as np
import pytest
from oscillators import Oscillator, Scalar

from pliant.plants import SingleLinkArm, StabilityLimitError, TwoLinkArm, step_limit
from pliant.plants.integration import step_maps
from pliant.plants.integration.step_maps import stepper

RK4_REAL = 2.785293563405282  # root of 1 + z/2 + z^2/6 + z^3/24 = 0


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


@pytest.mark.parametrize(("name", "value"), [("u", [[0.0]]), ("p", [1.0]), ("u", "abc")])
def test_a_limit_is_of_one_point(name, value):
    arm = SingleLinkArm.textbook()
    with pytest.raises(ValueError, match=rf"step_limit\.{name} "):
        step_limit(arm, np.zeros(arm.nx), **{name: value})


def test_a_state_too_large_for_the_equations_is_refused_in_words():
    arm = SingleLinkArm.textbook()
    with warnings.catch_warnings(), pytest.raises(ValueError, match=r"step_limit\.x = .* not finite"):
        warnings.simplefilter("ignore")
        step_limit(arm, np.full(arm.nx, 1e140))


class Stiffening(Scalar):
    """x' = -r x, r of 400 1/s at a quarter of a second, else of 1 1/s."""

    def ode(self, t, x, u, w):
        return -(1 + 399 * ca.exp(-(((t - 0.25) / 0.05) ** 2))) * x


@pytest.mark.parametrize("native", ["0", "1"])
def test_a_machine_that_is_stiff_at_one_time_is_looked_at_then(native, monkeypatch):
    """Neither at its start, middle or end."""
    monkeypatch.setenv("PLIANT_NATIVE", native)
    with pytest.raises(StabilityLimitError, match=r"at t = 0\.25 s: .*-400"):
        Stiffening().simulate([1.0], None, np.linspace(0, 1, 65), method="rk4", step=1 / 64)


def test_every_state_of_a_motion_is_doubted_where_its_own_step_is_long():
    """Also where the others' are far within the limit, without compiled code."""
    rows, x, t = 9, np.zeros((9, 1)), np.linspace(0, 1, 9)
    for plant, steps in (
        (Stiffening(), np.full(rows, 1 / 64)),
        (Scalar(rate=-400.0), np.where(t == 0.25, 1 / 64, 1e-4)),
    ):
        found = step_maps.doubtful(plant, x, "rk4", steps, np.zeros((rows, 0)), np.zeros(0), t)
        assert found.tolist() == [2]
