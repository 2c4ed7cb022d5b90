"""Torsion shapes against the rod with a free end, the exact root with an inertia, and their own boundary condition."""

import mpmath as mp
import numpy as np
import pytest

from pliant.plants.large_deflection.torsion import TorsionShapes

XI, WEIGHT = np.polynomial.legendre.leggauss(60)
XI, WEIGHT = (1 + XI) / 2, WEIGHT / 2


def test_a_free_end_has_sines_of_odd_quarter_waves_one_at_the_tip():
    shapes = TorsionShapes(4)
    np.testing.assert_allclose(shapes.roots, (np.arange(4) + 0.5) * np.pi, rtol=1e-15)
    np.testing.assert_allclose(shapes(np.ones(1))[0], 1.0, rtol=1e-14)
    np.testing.assert_allclose(shapes.stiffness, shapes.roots**2 / 2, rtol=1e-14)


@pytest.mark.parametrize("ratio", [0.0, 0.3, 1.0, 1e3, 1e9])
def test_shapes_are_natural_modes_of_the_loaded_rod(ratio):
    """Orthogonal with the tip's inertia in and in strain; Gamma'(1) = ratio kappa^2 Gamma(1)."""
    shapes = TorsionShapes(5, ratio)
    value, slope, tip = shapes(XI), shapes(XI, 1), shapes(np.ones(1))[0]
    K = slope.T @ (WEIGHT[:, None] * slope)
    M = value.T @ (WEIGHT[:, None] * value) + ratio * np.outer(tip, tip)
    np.testing.assert_allclose(K, np.diag(shapes.stiffness), atol=1e-12 * K.max())
    np.testing.assert_allclose(np.diag(K) / np.diag(M), shapes.roots**2, rtol=1e-7)
    assert np.abs(M - np.diag(np.diag(M))).max() < 1e-6 * np.sqrt(M.diagonal().max() * M.diagonal().min())
    assert np.abs(shapes(np.linspace(0, 1, 201))).max() == pytest.approx(1.0, abs=1e-3) and tip.min() > 0


@pytest.mark.parametrize("ratio", [0.01, 1.0, 40.0])
def test_roots_solve_the_textbook_equation(ratio):
    """cot kappa = ratio kappa at thirty digits."""
    for k, root in enumerate(TorsionShapes(4, ratio).roots):
        exact = mp.findroot(lambda z: mp.cos(z) - ratio * z * mp.sin(z), root)
        assert k * np.pi < root < (k + 0.5) * np.pi and root == pytest.approx(float(exact), rel=1e-14)
