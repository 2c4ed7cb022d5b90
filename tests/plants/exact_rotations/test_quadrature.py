"""Quadrature along a beam known by its tangents: exact for polynomials up to its degree."""

import numpy as np
import pytest

from pliant.plants.exact_rotations.quadrature import points


def test_points_integrate_polynomials_and_their_energy_exactly():
    at = points(5, panels=2)
    xi = np.array([0.0, 0.2, 0.5, 0.77, 1.0])
    np.testing.assert_allclose(at.cumulative(xi) @ at.xi**4, xi**5 / 5, atol=1e-15)
    np.testing.assert_allclose(at.first_moment @ at.xi**3, 1 / 4 - 1 / 5, rtol=1e-14)


@pytest.mark.parametrize("panels", [1, 2])
@pytest.mark.parametrize("m", [3, 6])
def test_energy_is_exact_up_to_the_highest_degree_of_a_field(m, panels):
    """int (int_0^xi s^a)(int_0^xi s^b) = 1/((a + 1)(b + 1)(a + b + 3)) for every a, b <= m - 1."""
    at = points(m, panels)
    moved = at.root @ at.xi[:, None] ** np.arange(m)
    a, b = np.meshgrid(np.arange(m), np.arange(m))
    np.testing.assert_allclose(moved.T @ moved, 1 / ((a + 1) * (b + 1) * (a + b + 3)), rtol=1e-12)
