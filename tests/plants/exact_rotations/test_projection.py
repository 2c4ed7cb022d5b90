"""The same bend in other shapes."""

import numpy as np
import pytest

from pliant.plants import beams
from pliant.plants.exact_rotations.projection import projection

XI = np.linspace(0.0, 1.0, 9)


@pytest.mark.parametrize("simpler", [beams.basis("polynomial", 2), beams.basis("clamped-free", 2)])
def test_a_bend_that_the_finer_shapes_hold_is_the_same(simpler):
    """x^2 and x^3 are polynomials of any more; natural modes are analytic, so that twelve polynomials hold them."""
    finer = beams.basis("polynomial", 12)
    P = projection(simpler, finer)
    for derivative in (0, 1, 2):
        np.testing.assert_allclose(finer.phi(XI, derivative) @ P, simpler.phi(XI, derivative), atol=1e-5)


def test_what_the_finer_shapes_cannot_hold_keeps_the_nearest_strain_energy():
    """The projection is of least squares in curvature: what is left over stores no energy with any of the shapes."""
    simpler, finer = beams.basis("clamped-free", 3), beams.basis("polynomial", 2)
    P = projection(simpler, finer)
    xi, weight = np.polynomial.legendre.leggauss(40)
    xi, weight = (1 + xi) / 2, weight / 2
    left = simpler.phi(xi, 2) - finer.phi(xi, 2) @ P
    assert np.abs(left).max() > 0.1
    np.testing.assert_allclose(finer.phi(xi, 2).T @ (weight[:, None] * left), 0.0, atol=1e-9)


def test_of_a_rigid_link_nothing_bends():
    assert projection(beams.basis("polynomial", 0), beams.basis("polynomial", 3)).shape == (3, 0)
