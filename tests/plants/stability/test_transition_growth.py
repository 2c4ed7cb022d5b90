"""Growth of deviations against closed forms and independent integration."""

import numpy as np
import pytest

from pliant.plants.linear.magnus import product
from pliant.plants.stability import floquet, frozen_time, growth
from pliant.plants.stability.transition_growth import chain


def test_growth_is_the_singular_value_of_the_true_transition_matrix(random_path, integrated):
    A, model = random_path()
    found = growth(model, 0.6, scale=np.ones(4))
    Phi = integrated(A, (0.0, 3.0), 4)
    assert found.total == pytest.approx(np.linalg.norm(Phi, 2), rel=1e-8)
    assert found.curve[0] == 1.0 and found.window == pytest.approx(0.6)
    np.testing.assert_allclose(np.linalg.norm(Phi @ found.direction), found.total, rtol=1e-7)
    for k in (0, 200, len(found.windows) - 1):
        begin = found.window_start[k]
        assert found.windows[k] == pytest.approx(np.linalg.norm(integrated(A, (begin, begin + 0.6), 4), 2), rel=1e-7)
    assert found.exponents.sum() * 3.0 == pytest.approx(np.log(np.linalg.det(Phi)), abs=1e-7)


def test_exponents_of_a_diagonal_and_of_a_turning_model(model_of):
    t = np.linspace(0.0, 40.0, 2001)
    A = np.zeros((2001, 3, 3))
    A[:, [0, 1, 2], [0, 1, 2]] = np.stack([-0.3 + np.cos(t), 0.1 + np.sin(2 * t), -1.0 + 0 * t], axis=1)
    found = growth(model_of(t, A), scale=np.ones(3))
    exact = np.array([-0.3 + np.sin(40.0) / 40, 0.1 + np.sin(40.0) ** 2 / 40, -1.0])
    np.testing.assert_allclose(found.exponents, np.sort(exact)[::-1], atol=1e-9)
    rate = np.exp(0.1 * t + np.sin(t) ** 2)
    other = np.exp(-0.3 * t + np.sin(t))
    np.testing.assert_allclose(found.curve, np.maximum(rate, np.maximum(other, np.exp(-t))), rtol=1e-8)


def test_fewer_points_give_the_same_total_and_long_times_the_floquet_exponent(model_of):
    t = np.linspace(0.0, 60 * np.pi, 6001)
    A = np.zeros((6001, 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -(1.0 - 0.6 * np.cos(2 * t)), -0.1
    model = model_of(t, A)
    every, few = growth(model), growth(model, points=50)
    assert few.total == pytest.approx(every.total, rel=1e-9) and len(few.t) < 60
    cycle = floquet(model, np.pi)
    assert every.exponents[0] == pytest.approx(cycle.growth, abs=0.02 * abs(cycle.growth) + 0.01)


@pytest.mark.parametrize("window", [0.01, 0.31, 1.0, 1.6, 2.9, 3.0])
def test_windows_of_any_length_are_products_of_their_steps(window, random_path):
    model = random_path()[1]
    found = growth(model, window)
    t, Phi, _ = chain(model)
    count = round(found.window / 3.0 * len(Phi))
    assert len(found.windows) == len(Phi) - count + 1
    for k in sorted({0, len(found.windows) // 3, len(found.windows) // 2, len(found.windows) - 1}):
        assert found.windows[k] == pytest.approx(np.linalg.norm(product(Phi[k : k + count]), 2), rel=1e-9)
        assert found.window_start[k] == t[k]


def test_windows_beyond_the_range_of_numbers(model_of):
    """Each grows by e^900; ten of them fit into a nominal, whose growth is kept as a logarithm."""
    t = np.linspace(0.0, 10.0, 1001)
    A = np.tile(np.diag([900.0, -1.0]), (1001, 1, 1))
    A[:, 0, 0] += 1e-3 * np.sin(t)
    found = growth(model_of(t, A), 0.5)
    assert found.logs[-1] == pytest.approx(9000.0 + 1e-3 * (1 - np.cos(10.0)), rel=1e-9)
    assert found.windows[0] == pytest.approx(np.exp(450.0 + 1e-3 * (1 - np.cos(0.5))), rel=1e-6)


def test_critical_times_of_growth_and_of_the_frozen_roots(model_of):
    t = np.linspace(0.0, 10.0, 501)
    A = np.zeros((501, 1, 1))
    A[:, 0, 0] = np.cos(t)
    model = model_of(t, A)
    np.testing.assert_allclose(frozen_time(model).critical_times, np.pi * np.array([0.5, 1.5, 2.5]), atol=1e-6)
    found = growth(model, 1.0)  # sin(s + 1) - sin(s) changes sign half a window before cos does
    np.testing.assert_allclose(found.critical_times, np.pi * np.array([0.5, 1.5, 2.5]) - 0.5, atol=1e-3)
