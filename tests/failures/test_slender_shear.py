"""Shapes of shear alone on a slender beam: frequencies of 1/(shear rotary) beside which the first lose their digits.

Ritz's frequencies are upper bounds, so one below the exact one is rounding, seen. The naive shapes, two of five in
shear alone and nearly dependent, fall far below it; shapes orthogonal in mass and stiffness never do.
"""

import numpy as np
import pytest
import slender
from scipy.linalg import eigh
from timoshenko_exact import exact_square

from pliant.plants.beams import basis
from pliant.plants.beams.legendre_ritz import StrainShapes, matrices
from pliant.plants.linear.second_order import natural_squares

EPS = np.finfo(float).eps


def naive(n, shear):
    """Curvatures of rising degree with the shear that balances them, and two of five in shear alone, as they stand."""
    alone = 2 * (n - 2) // 5
    curved = n - alone
    k = np.arange(curved)
    falling = np.where((k[:, None] < k) & ((k - k[:, None]) % 2 == 1), 1.0, 0.0)  # P_k' = sum (2 j + 1) P_j
    balance = -2 * shear * falling * np.sqrt(np.outer(2 * k + 1, 2 * k + 1))
    return matrices(StrainShapes(np.eye(curved, n), np.hstack([balance, np.eye(curved, alone)])))


def first_as_it_stands(n, shear):
    found = naive(n, shear)
    K, M = found.bending + found.shearing / shear, found.mass + shear / 3 * found.rotary
    return eigh(K, M, eigvals_only=True)[0]


@pytest.mark.parametrize("shear", [1e-8, 1e-10, 1e-14])
def test_slender_beams_keep_their_digits(shear):
    exact = float(exact_square(12.3623634, shear / 3, shear))
    lost = [first_as_it_stands(n, shear) / exact - 1 for n in (12, 20)]
    assert max(np.abs(lost)) > 1e-14 / shear  # eps omega_n^2/omega_1^2 is 0.6 at 1e-8; 1e-3, -5e3, -4e11 seen
    for n in (12, 20, 30):
        shapes = basis("polynomial", n, rotary=shear / 3, shear=shear)
        M, K = shapes.mass + shear / 3 * shapes.rotary, shapes.stiffness + shapes.shear / shear
        squares = natural_squares(K, M)
        assert abs(squares[0] / exact - 1) < 8 * n * EPS
        assert squares[-1] < n**8  # curvatures alone: no frequency of 1/(shear rotary)
    for n in (1, 2, 5):
        shapes = basis("polynomial", n, rotary=shear / 3, shear=shear)
        assert shapes.stiffness[0, 0] / shapes.mass[0, 0] > exact  # an upper bound


def test_plants_at_any_slenderness_as_the_characteristic_equation_says():
    """tests/campaigns/slender.py tries hundreds."""
    for seed in (0, 5):
        row = slender.run(seed)
        assert not row["wrong"], row
