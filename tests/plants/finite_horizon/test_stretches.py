"""Integrals over stretches against quadrature of the model's own matrix exponentials."""

import numpy as np
from horizon_models import constant, random_ltv
from scipy.integrate import quad_vec
from scipy.linalg import expm

from pliant.plants.finite_horizon import finite_horizon
from pliant.plants.linear.magnus import product

A, E = np.array([[0.2, 1.0], [-3.0, -0.4]]), np.array([[0.5], [2.0]])
C, F = np.array([[1.0, 0.3], [0.0, 2.0]]), np.array([[0.0], [0.7]])


def stretches(model):
    return finite_horizon(model)._on


def test_what_unit_energy_reaches():
    on = stretches(constant(A, E, C, 80.0, F))  # stretches of 0.2 s
    h = on.h[0]
    wanted = quad_vec(lambda s: expm(A * s) @ E @ E.T @ expm(A * s).T, 0.0, h)[0]
    np.testing.assert_allclose(on.gramians[0], wanted, rtol=1e-12)


def test_the_energy_of_outputs_over_a_stretch():
    on = stretches(constant(A, E, C, 80.0, F))
    whole, out = np.zeros((3, 3)), np.hstack([C, F])
    whole[:2] = np.hstack([A, E])
    wanted = quad_vec(lambda s: expm(whole * s).T @ out.T @ out @ expm(whole * s), 0.0, on.h[0])[0]
    np.testing.assert_allclose(on.costs[0], wanted, rtol=1e-12)


def test_stretches_resolve_the_fastest_mode():
    on = stretches(constant([[0.0, 50.0], [-50.0, 0.0]], [[0.0], [1.0]], [[1.0, 0.0]], 10.0))
    assert 50.0 * on.h.max() <= 0.5 and on.parts * 200 == len(on.h)


def test_halving_the_nodes_intervals_changes_little():
    """Of order four."""
    one, two = (stretches(random_ltv(2, nodes)) for nodes in (481, 961))
    whole = product(two.held[0])
    np.testing.assert_allclose(product(one.held[0]), whole, rtol=0, atol=1e-8 * np.abs(whole).max())
