"""Shape functions and their integrals, against closed forms, quadrature and reference digits."""

import json
import math
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from pliant.plants import beams

REFERENCE = Path(__file__).parents[2] / "reference"
EVERY_KIND = [(kind, n) for kind in beams.BASES for n in (1, 4, 25)]


def build(kind, n):
    return beams.basis(kind, n, tip_mass_ratio=0.8, tip_inertia_ratio=0.05)


def test_reference_modal_digits():
    basis = beams.basis("clamped-free", 4)
    for k, row in enumerate(json.loads((REFERENCE / "two_link.json").read_text())["modal"]):
        want = {name: float(digits) for name, digits in row.items()}
        assert basis.phi.roots[k] == pytest.approx(want["betaL"], rel=1e-14, abs=0)
        assert basis.tip[k] == pytest.approx(want["phiE"], rel=1e-13)
        assert basis.tip_slope[k] == pytest.approx(want["dphiE"], rel=1e-13)
        assert 0.864 * basis.moment[k] == pytest.approx(want["nw"], rel=1e-12)
        assert 0.864 * basis.first[k] == pytest.approx(want["nq"], rel=1e-12)
        assert 119.46666666666668 * basis.stiffness[k, k] == pytest.approx(want["k"], rel=1e-12)


def test_clamped_free_integrals_have_their_closed_forms_up_to_mode_200():
    basis = beams.basis("clamped-free", 200)
    beta = basis.phi.roots
    sigma = (1 - 2 * np.sin(beta) * np.exp(-beta) - np.exp(-2 * beta)) / (
        1 + 2 * np.cos(beta) * np.exp(-beta) + np.exp(-2 * beta)
    )
    np.testing.assert_allclose(basis.first, 2 * sigma / beta, atol=2e-15)
    np.testing.assert_allclose(basis.moment, 2 / beta**2, atol=2e-15)
    np.testing.assert_allclose(np.diag(basis.shortening), sigma * beta * (2 + sigma * beta), rtol=1e-12)
    np.testing.assert_allclose(np.abs(basis.tip), 2.0, rtol=1e-12)


@pytest.mark.parametrize("kind", ["clamped-free", "payload", "polynomial"])
def test_weighted_shortening_against_adaptive_quadrature(kind):
    basis = build(kind, 3)
    for i, j in ((0, 0), (0, 1), (1, 2), (2, 2)):
        slopes = lambda s: float(np.prod(basis.phi(float(s), 1)[[i, j]]))  # noqa: E731, B023
        want = [
            mp.quad(lambda s: weight(s) * slopes(s), [0, 0.5, 1])  # noqa: B023
            for weight in (lambda s: 1, lambda s: 1 - s, lambda s: (1 - s * s) / 2)
        ]
        have = [basis.shortening[i, j], basis.shortening_mean[i, j], basis.shortening_moment[i, j]]
        np.testing.assert_allclose(have, np.array(want, dtype=float), rtol=1e-12, atol=1e-12)


def test_two_polynomials_by_hand():
    basis = beams.basis("polynomial", 2)  # sqrt(5) xi^2 and sqrt(7) (5 xi^2 - 6 xi^3)
    np.testing.assert_allclose(basis.tip, [math.sqrt(5), -math.sqrt(7)], rtol=1e-14)
    np.testing.assert_allclose(basis.tip_slope, [2 * math.sqrt(5), -8 * math.sqrt(7)], rtol=1e-14)
    coupled = -16 * math.sqrt(35)
    np.testing.assert_allclose(basis.stiffness, [[20, coupled], [coupled, 1204]], rtol=1e-13)
    np.testing.assert_allclose(basis.moment, [math.sqrt(5) / 4, math.sqrt(7) * (5 / 4 - 6 / 5)], rtol=1e-13)


@pytest.mark.parametrize("kind, n", EVERY_KIND)
def test_every_basis_meets_its_ends_and_its_integrals(kind, n):
    basis = build(kind, n)
    assert basis.n == n and basis.kind == kind
    zero, one = basis.phi(np.array([0.0, 1.0])), basis.phi(np.array([0.0, 1.0]), 1)
    size = np.abs(basis.tip_slope).max() + np.abs(one[0]).max() + 10
    np.testing.assert_allclose(zero[0], 0, atol=1e-12)
    left, _, right = kind.partition("-")
    if left != "pinned":
        np.testing.assert_allclose(one[0], 0, atol=1e-13 * size)
        root = basis.phi(0.0, 2)
        assert np.all(basis.tip_slope > 0 if left == "hinged" else root > 0)
        assert (np.abs(root) < 1e-13 * n**6).all() == (left == "hinged")
    else:
        assert np.all(one[0] > 0)
    if right in ("pinned", "clamped"):
        np.testing.assert_allclose(zero[1], 0, atol=1e-12)
    if right == "clamped":
        np.testing.assert_allclose(one[1], 0, atol=1e-13 * size)

    x, w = np.polynomial.legendre.leggauss(120)  # one panel: not the rule under test
    xi, w = (1 + x) / 2, w[:, None] / 2
    value, curvature = basis.phi(xi), basis.phi(xi, 2)
    np.testing.assert_allclose(basis.mass, value.T @ (w * value), atol=1e-12)
    np.testing.assert_allclose(basis.stiffness, curvature.T @ (w * curvature), atol=1e-12 * basis.stiffness.max())
    np.testing.assert_allclose(np.diag(basis.mass), 1, atol=1e-13)
    for M in (basis.mass, basis.stiffness, basis.shortening, basis.shortening_mean, basis.shortening_moment):
        np.testing.assert_array_equal(M, M.T)
    assert np.linalg.eigvalsh(basis.stiffness)[0] > 0
    if kind in beams.BOUNDARIES:
        np.testing.assert_allclose(
            curvature.T @ (w * curvature), np.diag(basis.phi.roots**4), atol=1e-11 * basis.stiffness.max()
        )
    if kind == "payload" and n <= 4:
        assert np.linalg.eigvalsh(basis.mass)[0] > 0


@pytest.mark.parametrize("kind", ["payload", "polynomial"])
def test_polynomials_and_loaded_modes_give_the_loaded_frequencies(kind):
    basis = build(kind, 10)
    mass = basis.mass + 0.8 * np.outer(basis.tip, basis.tip) + 0.05 * np.outer(basis.tip_slope, basis.tip_slope)
    beta = np.sort(np.linalg.eigvals(np.linalg.solve(mass, basis.stiffness)).real) ** 0.25
    np.testing.assert_allclose(beta[:3], beams.loaded_roots(3, 0.8, 0.05), rtol=1e-9)


@pytest.mark.parametrize("derivative", range(5))
def test_polynomial_derivatives_against_exact_rationals(derivative):
    k, xi = 29, mp.mpf("0.3")
    with mp.workdps(60):
        shape = lambda s: -mp.sqrt(2 * k + 5) * s**2 * mp.jacobi(k, 0, 4, 2 * s - 1)  # noqa: E731
        exact = float(mp.diff(shape, xi, derivative))
    have = beams.Polynomials(30)(0.3, derivative)[k]
    assert have == pytest.approx(exact, rel=1e-11, abs=1e-11 * 30.0 ** (2 * derivative))


@pytest.mark.parametrize("kind", beams.BASES)
def test_no_shape_functions_at_all(kind):
    basis = beams.basis(kind, 0)
    assert basis.n == 0 and basis.mass.shape == (0, 0) and basis.tip.shape == basis.first.shape == (0,)
    assert basis.phi(np.linspace(0, 1, 6).reshape(2, 3), 1).shape == (2, 3, 0)


def test_basis_is_cached_and_cannot_be_changed():
    assert beams.basis("clamped-free", 3) is beams.basis("clamped-free", 3, tip_mass_ratio=5.0)
    with pytest.raises(ValueError, match="read-only"):
        beams.basis("clamped-free", 3).tip[0] = 1.0
