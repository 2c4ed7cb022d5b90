"""Shapes of stretch and twist: orthonormal, held at the root, with their integrals."""

import numpy as np
import pytest

from pliant.plants import beams
from pliant.plants.multibody_parts.rod_shapes import RodIntegrals, RodShapes

X, W = np.polynomial.legendre.leggauss(40)
XI, W = (1 + X) / 2, W / 2


@pytest.mark.parametrize("kind", ["polynomial", "clamped-free"])
def test_orthonormal_and_held(kind):
    a = RodShapes(kind, 5)
    np.testing.assert_allclose(a(XI).T @ (W[:, None] * a(XI)), np.eye(5), atol=1e-12)
    np.testing.assert_allclose(a(0.0), 0.0, atol=1e-14)
    assert (a(0.0, 1) > 0).all()
    np.testing.assert_allclose(a(XI, 1), (a(XI + 1e-6) - a(XI - 1e-6)) / 2e-6, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("kind", ["polynomial", "clamped-free"])
def test_integrals(kind):
    bent = beams.basis(kind, 3)
    found = RodIntegrals.of(kind, 2, bent)
    a = found.shapes
    np.testing.assert_allclose(found.first, W @ a(XI), atol=1e-12)
    np.testing.assert_allclose(found.moment, (W * XI) @ a(XI), atol=1e-12)
    np.testing.assert_allclose(found.stiffness, a(XI, 1).T @ (W[:, None] * a(XI, 1)), atol=1e-10)
    np.testing.assert_allclose(found.bending, a(XI).T @ (W[:, None] * bent.phi(XI)), atol=1e-12)


def test_none():
    assert RodShapes("polynomial", 0)(0.5).shape == (0,)
