"""Steps of every method: their orders, where they stop, and that all methods agree."""

import dataclasses

import numpy as np
import pytest
from convergence import slope
from oscillators import Oscillator, Scalar

from pliant.plants import IntegrationError, TwoLinkArm
from pliant.plants.integration.step_maps import at_most

ARM = dataclasses.replace(TwoLinkArm.textbook(), hub_inertia=(0.1, 0.02), modes=(1, 1))
METHODS = {"rk4": 4, "rk8": 8, "midpoint": 2, "rosenbrock": 3}
STEPS = {"rk8": np.array([6, 8, 10, 12])}  # where errors are above rounding


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


@pytest.mark.campaign
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


@pytest.mark.parametrize("m", [1, 2, 3, 8, 15])
def test_no_spectral_radius_is_above_its_bound(m):
    rng = np.random.default_rng(m)
    rows, columns = 10.0 ** rng.uniform(-3, 3, (2, 200, m))
    A = rng.normal(size=(200, m, m)) * rows[:, :, None] * columns[:, None, :]
    A[100:, : m // 2, m // 2 :] = 0.0
    radii = np.abs(np.linalg.eigvals(A)).max(axis=1)
    assert (at_most(A) >= radii * (1 - 1e-12)).all()


def test_the_bound_of_vibrations_is_near_the_fastest_ones_frequency():
    omega, zeta = np.array([3.0, 70.0, 900.0]), np.array([0.0, 0.01, 0.1])
    A = np.block([[np.zeros((3, 3)), np.eye(3)], [-np.diag(omega**2), -np.diag(2 * zeta * omega)]])
    assert 900 <= at_most(A[None])[0] < 1.1 * 900
    assert not at_most(1e200 * A[None])[0] < np.inf  # what numbers do not hold is not bounded
