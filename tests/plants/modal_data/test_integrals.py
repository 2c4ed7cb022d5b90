"""Integrals of a body's points against sums taken one point at a time."""

import numpy as np
import pytest

from pliant.plants.modal_data.integrals import axial, integrals


def test_integrals_follow_their_definitions():
    """Sums over points, one point at a time."""
    rng = np.random.default_rng(5)
    r, dm, phi = rng.normal(size=(8, 3)), rng.uniform(0.5, 2, 8), rng.normal(size=(3, 8, 3))
    g = rng.normal(size=(3, 3, 8, 3))
    found = integrals(r, dm, phi, g)
    assert found["mass"] == pytest.approx(sum(dm), rel=1e-14)
    np.testing.assert_allclose(found["first"], sum(m * a for m, a in zip(dm, r)), atol=1e-12)
    np.testing.assert_allclose(found["second"], sum(m * np.outer(a, a) for m, a in zip(dm, r)), atol=1e-12)
    for k in range(3):
        np.testing.assert_allclose(found["R"][k], sum(m * b for m, b in zip(dm, phi[k])), atol=1e-12)
        moment = sum(m * np.outer(a, b) for m, a, b in zip(dm, r, phi[k]))
        np.testing.assert_allclose(found["moments"][k], moment, atol=1e-12)
        for l in range(3):
            overlap = sum(m * np.outer(a, b) for m, a, b in zip(dm, phi[k], phi[l]))
            np.testing.assert_allclose(found["overlaps"][k, l], overlap, atol=1e-12)
            short = sum(m * b for m, b in zip(dm, g[k, l]))
            np.testing.assert_allclose(found["shortening"][k, l], short, atol=1e-12)
            moment = sum(m * np.outer(a, b) for m, a, b in zip(dm, r, g[k, l]))
            np.testing.assert_allclose(found["shortening_moments"][k, l], moment, atol=1e-12)
            mixed = sum(m * np.outer(a, b) for m, a, b in zip(dm, phi[2], g[k, l]))
            np.testing.assert_allclose(found["shortening_overlaps"][2, k, l], mixed, atol=1e-12)
            square = sum(m * np.outer(a, b) for m, a, b in zip(dm, g[k, l], g[0, 1]))
            np.testing.assert_allclose(found["shortening_squares"][k, l, 0, 1], square, atol=1e-12)


def test_axial_is_the_sum_of_cross_products():
    rng = np.random.default_rng(6)
    a, b, dm = rng.normal(size=(7, 3)), rng.normal(size=(7, 3)), rng.uniform(0.5, 2, 7)
    P = np.einsum("p,pi,pj->ij", dm, a, b)
    np.testing.assert_allclose(axial(P), dm @ np.cross(a, b), atol=1e-12)
