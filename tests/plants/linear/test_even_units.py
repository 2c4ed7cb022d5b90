"""Units that follow from the model alone."""

import numpy as np
import pytest
from scipy.linalg import expm

from pliant.plants.linear.even_units import even_expm, even_units, input_units

ZERO = np.zeros(2)


def test_an_oscillator_gets_the_geometric_mean_of_its_units():
    """[[0, 1], [-w^2, 0]] in units d, 1/d: entries 1/d^2 and w^2 d^2 are equal where d^2 = 1/w."""
    w = 2.0**10
    assert even_units(np.array([[0.0, 1.0], [-(w**2), 0.0]]), ZERO, ZERO).tolist() == [2.0**-5, 2.0**5]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("dense", [0.3, 1.0])
def test_scaled_entries_are_the_same_from_any_units(seed, dense):
    rng = np.random.default_rng(seed)
    n = 7
    A = rng.normal(size=(n, n)) * (rng.random((n, n)) < dense) * 10 ** rng.uniform(-3, 3, (n, n))
    A += np.diag(np.ones(n - 1), 1)
    reach, sight, S = np.eye(n)[-1], np.eye(n)[0], 10 ** rng.uniform(-9, 9, n)
    one = even_units(A, reach, sight)
    other = even_units(A * S[:, None] / S, reach * S**2, sight / S**2)
    assert np.abs(np.log2(other / one / S)).max() < 1.01  # both are rounded to powers of two
    scaled = A * one[None, :] / one[:, None]
    assert np.linalg.norm(scaled) <= 2 * np.linalg.norm(A)


def test_an_entry_that_is_rounding_does_not_set_a_unit():
    """Two oscillators of one size that Q sees and an entry of 1e-17 between them: it stays small."""
    A = np.array([[0, 1.0, 0, 0], [-4, 0, 0, 0], [1e-17, 0, 0, 3.0], [0, 0, -2.0, 0]])
    unit = even_units(A, np.array([0, 1.0, 0, 0]), np.ones(4))
    assert 1e-17 * unit[0] / unit[2] < 1e-13
    alone = even_units(A, np.array([0, 1.0, 0, 0]), np.array([1.0, 1.0, 0, 0]))
    assert 1e-17 * alone[0] / alone[2] > 1e-13  # where nothing else says it, the entry does


def test_inputs():
    assert input_units(np.diag([4.0, 1e-18])).tolist() == [0.5, 2.0**30]


def test_exponentials_keep_small_entries():
    """Of states that are 1e-9 to 1e+9 units apart: SciPy's of even ones, scaled afterwards, to the rounding of both."""
    rng = np.random.default_rng(0)
    A, S = rng.normal(size=(6, 6)), 10 ** rng.uniform(-9, 9, 6)
    scaled, right = A * S[:, None] / S, expm(A) * S[:, None] / S
    np.testing.assert_allclose(even_expm(scaled), right, rtol=1e-11)
    np.testing.assert_allclose(even_expm(np.array([A, scaled])), [expm(A), right], rtol=1e-11)
