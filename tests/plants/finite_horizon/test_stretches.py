"""Integrals over stretches against quadrature of the model's own matrix exponentials."""

import numpy as np
from horizon_models import constant, made, random_ltv
from scipy.integrate import quad_vec
from scipy.linalg import expm

from pliant.plants.finite_horizon.stretches import Stretches
from pliant.plants.linear.magnus import product

A, E = np.array([[0.2, 1.0], [-3.0, -0.4]]), np.array([[0.5], [2.0]])
C, F = np.array([[1.0, 0.3], [0.0, 2.0]]), np.array([[0.0], [0.7]])


def stretches(model):
    return Stretches(model, model.E, model.C, model.F)


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
    assert 50.0 * on.h.max() <= 0.5 * (1 + 1e-8) and len(on.h) == 1000


def test_a_mode_that_is_fast_for_a_moment_is_resolved_there():
    """An oscillator at 1500 rad/s about 1.013 s, slow elsewhere; even intervals are cut where it is fast alone."""
    t = np.linspace(0.0, 4.0, 401)
    rate = 2.0 + 1500.0 * np.exp(-(((t - 1.013) / 0.015) ** 2))
    A = np.zeros((401, 2, 2))
    A[:, 0, 1], A[:, 1, 0] = rate, -rate
    one = np.ones((401, 1, 1))
    on = stretches(made(t, A, np.tile([[0.0], [1.0]], (401, 1, 1)), np.tile([[1.0, 0.0]], (401, 1, 1)), 0 * one))
    assert (np.interp(on.t[:-1], t, rate) * on.h).max() < 1.0
    assert on.h[on.t[:-1] > 2].max() > 0.009


def test_halving_the_nodes_intervals_changes_little():
    """Of order four."""
    one, two = (stretches(random_ltv(2, nodes)) for nodes in (481, 961))
    whole = product(two.held[0])
    np.testing.assert_allclose(product(one.held[0]), whole, rtol=0, atol=1e-8 * np.abs(whole).max())
