"""A pinned rod's energies against quadrature over its points, and its shapes against their definitions."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Beam
from pliant.plants.beams.pinned_rod import AxialModes, HatShapes, HermiteShapes, PinnedRod, rod_shapes

ROD = Beam(length=0.7, area=3e-4, I_y=2e-8, I_z=5e-9, J=1e-8, density=2000.0, E=3e9, G=1e9)


def fine(cells):
    x, w = np.polynomial.legendre.leggauss(8)
    return ((np.arange(cells)[:, None] + (1 + x) / 2) / cells).ravel(), np.tile(w / (2 * cells), cells)


@pytest.mark.parametrize(("kind", "n", "axial"), [("pinned-pinned", 3, 2), ("frame-elements", 3, 3)])
def test_energies_are_those_of_the_rods_points(kind, n, axial):
    """Without shortening nothing is left out of T, however large the extension."""
    shapes = rod_shapes(kind, n, axial, 1.5)
    rod, rng = PinnedRod(ROD, shapes, stiffened=False), np.random.default_rng(1)
    e, de = rng.normal(size=(2, len(shapes.bending.tip)))
    b, db = rng.normal(size=(2, len(shapes.tip)))
    (R0, R1), omega = rng.normal(size=2), 1.7
    xi, w = fine(60)
    phi, psi = shapes.bending.phi, shapes.psi
    x, y = ROD.length * xi + psi(xi) @ b, phi(xi) @ e
    dx, dy = R0 + psi(xi) @ db - omega * y, R1 + phi(xi) @ de + omega * x
    T = ROD.mass * w @ (dx**2 + dy**2) / 2
    assert float(rod.kinetic_energy((R0, R1), omega, *map(ca.DM, (e, b, de, db)))) == pytest.approx(T, rel=1e-12)
    V = ROD.EI / ROD.length**3 * w @ (phi(xi, 2) @ e) ** 2 / 2
    V += ROD.E * ROD.area / ROD.length * w @ (psi(xi, 1) @ b) ** 2 / 2
    assert float(rod.strain_energy(ca.DM(e), ca.DM(b))) == pytest.approx(V, rel=1e-12)
    centre = [float(c) for c in rod.centre(ca.DM(e), ca.DM(b))]
    np.testing.assert_allclose(centre, [ROD.mass * w @ x, ROD.mass * w @ y], rtol=1e-11)


@pytest.mark.parametrize(("kind", "n"), [("pinned-pinned", 4), ("frame-elements", 3)])
def test_shortening_is_half_the_slope_squared(kind, n):
    shapes = rod_shapes(kind, n, 3)
    rod, rng = PinnedRod(ROD, shapes, stiffened=True), np.random.default_rng(2)
    e, none = 0.01 * rng.normal(size=len(shapes.bending.tip)), np.zeros(len(shapes.tip))
    xi, w = fine(60)
    slope = shapes.bending.phi(xi, 1) @ e / ROD.length
    lost = ROD.length * w @ slope**2 / 2
    assert ROD.length - float(rod.chord(ca.DM(e), ca.DM(none))) == pytest.approx(lost, rel=1e-11)
    along, across = (float(v) for v in rod.middle(ca.DM(e), ca.DM(none)))
    half = xi < 0.5
    assert along == pytest.approx(-ROD.length * w[half] @ slope[half] ** 2 / 2, rel=1e-11)
    assert across == pytest.approx(float(shapes.bending.phi(0.5) @ e), rel=1e-12)


@pytest.mark.parametrize("shapes", [HermiteShapes(3), HatShapes(4), AxialModes(3, 0.8)])
def test_derivatives_of_shapes(shapes):
    xi, h = np.array([0.07, 0.31, 0.44, 0.9]), 1e-6
    np.testing.assert_allclose(shapes(xi, 1), (shapes(xi + h) - shapes(xi - h)) / (2 * h), atol=1e-7)
    if isinstance(shapes, HermiteShapes):
        np.testing.assert_allclose(shapes(xi, 2), (shapes(xi + h, 1) - shapes(xi - h, 1)) / (2 * h), atol=1e-6)
        assert not shapes(np.array([0.0, 1.0])).any()  # the pins


def test_hermite_elements_hold_every_cubic_between_the_pins():
    """Nodal values of xi (1 - xi) and of xi^2 (1 - xi) give these polynomials back."""
    n, xi = 3, np.linspace(0, 1, 13)
    node = np.arange(n + 1) / n
    for value, slope in (
        (lambda s: s * (1 - s), lambda s: 1 - 2 * s),
        (lambda s: s**2 * (1 - s), lambda s: 2 * s - 3 * s**2),
    ):
        e = np.delete(np.column_stack([value(node), slope(node)]).ravel(), [0, 2 * n])
        np.testing.assert_allclose(HermiteShapes(n)(xi) @ e, value(xi), atol=1e-15)
