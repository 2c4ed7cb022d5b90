"""Legendre's shapes of strain."""

import numpy as np

from pliant.plants.beams import legendre_ritz


def test_strain_shapes_are_their_strains():
    """Derivatives by differences; curvature and shear strain orthonormal to rounding at any number."""
    shapes = legendre_ritz.StrainShapes.unit(6, 5)
    xi, h = np.linspace(0.1, 0.9, 5), 1e-5
    for f, df in (
        (shapes, lambda x: shapes(x, 1)),
        (lambda x: shapes(x, 1), lambda x: shapes(x, 2)),
        (shapes.rotation, lambda x: shapes.rotation(x, 1)),
    ):
        np.testing.assert_allclose((f(xi + h) - f(xi - h)) / (2 * h), df(xi), atol=1e-6)
    np.testing.assert_allclose(shapes.shear_strain(xi), shapes(xi, 1) - shapes.rotation(xi), atol=1e-13)
    found = legendre_ritz.matrices(legendre_ritz.StrainShapes.unit(100, 100))
    np.testing.assert_allclose(found.bending, np.diag([1.0] * 100 + [0.0] * 100), atol=1e-12)
    np.testing.assert_allclose(found.shearing, np.diag([0.0] * 100 + [1.0] * 100), atol=1e-12)
