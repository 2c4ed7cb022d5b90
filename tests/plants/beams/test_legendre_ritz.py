"""Legendre's shapes of strain."""

import numpy as np
import pytest

from pliant.plants.beams import legendre_ritz
from pliant.plants.linear.second_order import natural_squares


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


@pytest.mark.parametrize("shear", [1e-4, 0.05])
@pytest.mark.parametrize("n", [1, 2, 3, 7, 12, 40])
def test_curved_polynomials_carry_the_shear_that_balances_them(n, shear):
    """M' + Q = 0 is shear strain = -shear psi'', for all but the last, which are of shear alone: no two are alike."""
    rotary = 0.05
    shapes, xi = legendre_ritz.balanced(n, rotary, shear), np.linspace(0.0, 1.0, 41)
    curved = n - legendre_ritz.shear_alone(n, rotary, shear)
    h = 1e-4
    bend = (shapes.rotation(np.clip(xi + h, 0, 1), 1) - shapes.rotation(np.clip(xi - h, 0, 1), 1))[1:-1] / (2 * h)
    strain = shapes.shear_strain(xi)[1:-1]
    size = np.abs(bend).max(axis=0) * shear + 1e-9
    assert (np.abs(strain + shear * bend)[:, :curved] < 1e-2 * size[:curved]).all()
    assert np.abs(shapes.rotation(xi)[:, curved:]).max(initial=0.0) == 0.0
    assert np.linalg.matrix_rank(np.vstack([shapes.curvature, shapes.shear])) == n


@pytest.mark.parametrize("n", [1, 3, 8, 20, 40])
@pytest.mark.parametrize("shear", [1e-14, 1e-6, 1e-4, 0.05])
def test_polynomials_are_orthogonal_in_mass_and_in_stiffness(n, shear):
    """Each entry beside its diagonal ones, to rounding of the largest motion that the strains of a shape might bring,
    omega/omega_1 times its own; omega^2 on the diagonal, ascending.
    """
    found = legendre_ritz.matrices(legendre_ritz.polynomial(n, shear / 3, shear))
    M, K = found.mass + shear / 3 * found.rotary, found.bending + found.shearing / shear
    squares = np.diag(K) / np.diag(M)
    grown = np.sqrt(squares / squares[0])
    rounding = 8 * n * np.finfo(float).eps
    for matrix in (K, M):
        size = np.sqrt(np.diag(matrix))
        assert (np.abs(matrix / np.outer(size, size) - np.eye(n)) <= rounding * np.maximum.outer(grown, grown)).all()
    assert (np.diff(squares) > 0).all()
    np.testing.assert_allclose(np.diag(found.mass), 1.0, rtol=1e-12)


def test_shapes_of_shear_alone_only_where_they_bring_something():
    """A steel beam a tenth as deep as long takes them, one of a hundredth none up to twenty shapes."""
    assert [legendre_ritz.shear_alone(n, 8e-4, 3e-3) for n in (2, 5, 12, 40)] == [0, 0, 4, 15]
    assert [legendre_ritz.shear_alone(n, 8e-6, 3e-5) for n in (2, 5, 20)] == [0, 0, 0]
    assert legendre_ritz.shear_alone(40, 0.0, 0.1) == 0  # without rotary inertia balance is exact


@pytest.mark.parametrize("shear", [1e-6, 1e-4, 1e-2])
def test_few_polynomials_with_shear_tend_to_timoshenkos_beam(shear):
    """Clamped-free frequencies against 60 + 60 strain polynomials: from above, to 1e-6 with 20; a slender beam's to 1 %
    with three (with two of curvature and one of shear the second was wrong by 36 %).
    """
    rotary = shear / 3
    squares = _squares(legendre_ritz.StrainShapes.unit(60, 60), rotary, shear)
    rounding = len(squares) * np.finfo(float).eps * squares[:3] / squares[0]
    for n in range(2, 25):
        few = min(n, 3)
        error = np.sqrt(_squares(legendre_ritz.polynomial(n, rotary, shear), rotary, shear)[:few] / squares[:few]) - 1
        assert (error > -rounding[:few]).all()
        assert error[0] < 0.01
        if n >= 3 and shear <= 1e-4:
            assert error[1] < 0.01
        if n >= 20:
            assert (error < 1e-6 + rounding).all()


@pytest.mark.parametrize("n", [0, 1, 2, 5, 20])
@pytest.mark.parametrize("hinged", [False, True])
@pytest.mark.parametrize("turning", [0.0, 0.1])
def test_curvatures_of_a_tip_force_vanish_where_an_end_is_free_to_turn(n, hinged, turning):
    """Orthogonal in stiffness, and in mass with the payload's; one alone is the moment of a tip force, 1 - x."""
    shapes, xi = legendre_ritz.tip_force(n, hinged, 0.3, turning), np.linspace(0.0, 1.0, 41)
    bent, free = shapes(xi, 2), turning == 0 or n == 1
    assert bent.shape == (41, n) and np.linalg.matrix_rank(bent) == n
    size = np.abs(bent).max(axis=0, initial=1e-300)
    assert (np.abs(bent[0]) < 1e-10 * size).all() == (hinged or not n)
    assert (np.abs(bent[-1]) < 1e-10 * size).all() == (free or not n)
    tip, turn, found = shapes(1.0), shapes.rotation(1.0), legendre_ritz.matrices(shapes)
    M = found.mass + 0.3 * np.outer(tip, tip) + turning * np.outer(turn, turn)
    squares = np.diag(found.bending) / np.diag(M)
    assert (np.diff(squares) > 0).all() and ((turn if hinged else bent[0]) > 0).all()
    grown = np.sqrt(squares / squares.min(initial=np.inf))
    for matrix in (M, found.bending):
        size = np.sqrt(np.diag(matrix))
        apart = np.abs(matrix / np.outer(size, size) - np.eye(n))
        assert (apart <= 8 * (n + 1) * np.finfo(float).eps * np.maximum.outer(grown, grown) ** 2).all()
    if n == 1 and not hinged:
        np.testing.assert_allclose(bent[:, 0] / bent[0, 0], 1 - xi, atol=1e-13)


def _squares(shapes, rotary, shear):
    found = legendre_ritz.matrices(shapes)
    stiffness, mass = found.bending + found.shearing / shear, found.mass + rotary * found.rotary
    return natural_squares(stiffness, mass)
