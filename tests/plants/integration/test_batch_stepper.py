"""Steps of many lanes against closed forms."""

from math import cos, factorial, sin

import numpy as np
import pytest

from pliant.plants.integration.batch_stepper import rate_function, step_reference

RK4 = [1 / factorial(k) for k in range(5)]


def taylor(h):
    """The step of rk4 for x'' = -9 x is its stability polynomial of [[0, 1], [-9, 0]] h."""
    A = h * np.array([[0.0, 1.0], [-9.0, 0.0]])
    return sum(c * np.linalg.matrix_power(A, k) for k, c in enumerate(RK4))


@pytest.mark.parametrize("batch", [1, 3, 8])
def test_rk4_is_the_taylor_polynomial_of_degree_four(vibration, batch):
    x = np.random.default_rng(0).normal(size=(batch, 2))
    after = vibration.stepper(0.1, batch=batch)(x)
    np.testing.assert_allclose(after, x @ taylor(0.1).T, atol=1e-13)


def test_substeps_divide_the_step(vibration):
    x = np.array([[1.0, 0.0]])
    twice = vibration.stepper(0.2, substeps=2)(x)
    np.testing.assert_allclose(twice[0], np.linalg.matrix_power(taylor(0.1), 2) @ x[0], atol=1e-13)


@pytest.mark.parametrize(("method", "error"), [("rk8", 1e-11), ("rosenbrock", 1e-4), ("midpoint", 1e-3)])
def test_other_methods_follow_the_cosine(vibration, method, error):
    x = np.array([[1.0, 0.0]])
    found = vibration.stepper(0.1, method=method, substeps=10)(x)[0]
    np.testing.assert_allclose(found, [cos(0.3), -3 * sin(0.3)], atol=error)


def test_input_and_disturbance_by_lane(vibration):
    """u + w = 9 x holds a lane still."""
    x = np.array([[1.0, 0.0], [2.0, 0.0]])
    step = vibration.stepper(0.1, batch=2)
    np.testing.assert_allclose(step(x, np.array([[4.0], [13.0]]), w=[5.0]), x, atol=1e-14)


def test_the_virtual_machine_says_the_same(vibration):
    x = np.random.default_rng(1).normal(size=(4, 2))
    rest = [np.zeros((4, n)) for n in (1, 1, 0)]
    found = step_reference(vibration)(np.zeros((4, 1)), x, *rest, [0.1], 3)[0]
    np.testing.assert_allclose(found, x @ np.linalg.matrix_power(taylor(0.1), 3).T, atol=1e-13)


def test_rate_is_dense_and_in_order(vibration):
    rate = rate_function(vibration)
    assert np.array(rate(0.0, [2.0, 5.0], [1.0], [3.0], [])).ravel().tolist() == [5.0, 1.0 + 3.0 - 18.0]


def test_bad_input_is_named(vibration):
    step = vibration.stepper(0.1, batch=2)
    with pytest.raises(ValueError, match=r"stepper.x has shape \(3, 2\), must be \(2, 2\)"):
        step(np.zeros((3, 2)))
    with pytest.raises(ValueError, match=r"stepper.u has shape \(3,\), must be \(1,\) or \(2, 1\)"):
        step(np.zeros((2, 2)), np.zeros(3))
