"""Sums along tangents that are differentiated as they stand, against sums over pairs of points."""

import casadi as ca
import numpy as np

from pliant.plants.exact_rotations.quadrature import points
from pliant.plants.exact_rotations.tangent_sums import DifferentiatedTangents


def test_mass_forces_and_places_are_those_of_the_pairs_of_points():
    """q turns and stretches: t = q_2 (cos q_1 xi, sin q_1 xi)."""
    at, q, v = points(4), ca.SX.sym("q", 2), ca.SX.sym("v", 2)
    xi = ca.DM(at.xi).T
    t = q[1] * ca.vertcat(ca.cos(q[0] * xi), ca.sin(q[0] * xi))
    own = DifferentiatedTangents(at, t, q, v)
    weight = np.array([0.3, -0.2, 0.5, 1.0])
    built = [
        own.mass(),
        own.kinetic(),
        own.inertia_force(),
        own.sum(weight),
        own.sum_rate(weight),
        own.sum_bias(weight),
    ]
    found = ca.Function("f", [q, v], [*built, own.sum_jacobian(weight)])
    a, s, w, r = 0.7, 1.3, 0.4, -0.6  # angle, stretch, rates
    M, T, force, place, rate, bias, J = (np.asarray(e) for e in found([a, s], [w, r]))
    c, d = np.cos(a * at.xi), np.sin(a * at.xi)
    by_q = np.stack([np.stack([-s * at.xi * d, c], -1), np.stack([s * at.xi * c, d], -1)])  # (2, m, 2)
    W = at.root.T @ at.root
    np.testing.assert_allclose(M, np.einsum("cai,ab,cbj->ij", by_q, W, by_q), rtol=1e-12)
    moving = by_q @ [w, r]
    np.testing.assert_allclose(T, np.einsum("ca,ab,cb->", moving, W, moving) / 2, rtol=1e-12)
    turned = 2 * r * w * at.xi * np.array([-d, c]) - s * (w * at.xi) ** 2 * np.array([c, d])
    np.testing.assert_allclose(force.ravel(), np.einsum("cai,ab,cb->i", by_q, W, turned), rtol=1e-12)
    np.testing.assert_allclose(place.ravel(), s * np.array([c, d]) @ weight, rtol=1e-12)
    np.testing.assert_allclose(rate.ravel(), moving @ weight, rtol=1e-12)
    np.testing.assert_allclose(bias.ravel(), turned @ weight, rtol=1e-12)
    np.testing.assert_allclose(J, np.einsum("cai,a->ci", by_q, weight), rtol=1e-12)
