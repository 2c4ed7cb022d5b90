"""Sums along tangents in the turns of nodes are those in the coordinates, whose own code is another."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants.exact_rotations.nodal_turns import NodalField
from pliant.plants.exact_rotations.quadrature import points
from pliant.plants.large_deflection.tangent_field import Rotations, planar_field, rotations


def drawn(n, m):
    """(a nodal field, tangents in q at a random state, q, v, the coordinates' own)."""
    shapes: Rotations = rotations("clamped", "polynomial", n)
    at, rng = points(m), np.random.default_rng(n)
    q, v, a = rng.normal(size=(3, n))
    field, own = NodalField(at, shapes(at.xi)), planar_field(shapes, at)
    return field, field.at(ca.SX(q), ca.SX(v)), own.at(ca.SX(q), ca.SX(v)), a


def number(e):
    return np.array(ca.DM(e))


@pytest.mark.parametrize(("n", "m"), [(1, 4), (3, 3), (3, 7), (6, 13)])
def test_mass_force_and_positions_turn_with_the_coordinates(n, m):
    field, nodal, own, a = drawn(n, m)
    to, weight = field.to_nodes, field.points.first_moment
    M = number(own.mass())
    np.testing.assert_allclose(to.T @ number(nodal.mass()) @ to, M, rtol=0, atol=1e-12 * np.abs(M).max())
    resting = number(own.inertia_force())[:, 0]
    for turned, force in ((ca.SX(n, 1), resting), (ca.SX(a), resting + M @ a)):
        found = to.T @ number(nodal.inertia_force(turned))[:, 0]
        np.testing.assert_allclose(found, force, rtol=0, atol=1e-11 * max(1.0, np.abs(force).max()))
    J = number(own.sum_jacobian(weight))
    np.testing.assert_allclose(number(nodal.sum_jacobian(weight)) @ to, J, rtol=0, atol=1e-12 * np.abs(J).max())


def test_the_turns_at_all_points_follow_from_those_of_the_nodes():
    field, *_ = drawn(5, 11)
    q = np.random.default_rng(0).normal(size=5)
    z, turns = field.to_nodes @ q, field.psi @ q
    assert sorted(field.order) == list(range(11))
    np.testing.assert_allclose(turns[field.order], np.append(z, field.others @ z), rtol=1e-10)
    np.testing.assert_allclose(field.from_nodes @ z, q, rtol=1e-10)


def test_what_follows_from_the_nodes_is_no_larger_than_twice_as_large():
    """Nodes at which the coordinates could not be told would let errors grow."""
    assert np.abs(drawn(6, 13)[0].others).max() < 2.0
