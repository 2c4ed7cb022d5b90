"""The root's position as one more tangent: kinetic energy and positions against sums over the points of the beam."""

import numpy as np
import pytest

from pliant.plants.exact_rotations.quadrature import points
from pliant.plants.exact_rotations.rooted_points import RootedPoints

NODES, WEIGHTS = np.polynomial.legendre.leggauss(30)
XI, WEIGHTS = (1 + NODES) / 2, WEIGHTS / 2


@pytest.mark.parametrize("panels", [1, 3])
def test_inertia_is_that_of_the_points_of_the_beam(panels):
    """Of velocities r_0' + int t', t' a cubic in each component, which the rule takes exactly."""
    rule = RootedPoints.of(points(5, panels))
    rng = np.random.default_rng(1)
    root, cubic = rng.uniform(-1, 1, 2), [np.polynomial.Polynomial(rng.uniform(-1, 1, 4)) for _ in range(2)]
    rates = np.vstack([root, np.column_stack([p(rule.along.xi) for p in cubic])])
    velocity = np.column_stack([root[k] + cubic[k].integ()(XI) for k in range(2)])
    assert np.sum((rule.root @ rates) ** 2) == pytest.approx(WEIGHTS @ (velocity**2).sum(axis=1), rel=1e-13)
    np.testing.assert_allclose(rule.cumulative(XI) @ rates, velocity, atol=1e-14)
    np.testing.assert_allclose(rule.first_moment @ rates, WEIGHTS @ velocity, atol=1e-14)
    np.testing.assert_allclose(rule.weight @ rates, [root[k] + cubic[k].integ()(1.0) for k in range(2)], atol=1e-14)
