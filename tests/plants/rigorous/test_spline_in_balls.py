import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from pliant.plants.rigorous.balls import ends, flint, matrix, midpoint
from pliant.plants.rigorous.spline_in_balls import cubics


@pytest.mark.parametrize("nodes", [2, 3, 4, 5, 17])
def test_the_same_spline_as_scipy(nodes):
    rng = np.random.default_rng(nodes)
    t, f = np.cumsum(rng.uniform(0.5, 1.5, nodes)), rng.normal(size=(nodes, 2))
    with flint().ctx.workprec(100):
        found = np.array([[midpoint(c)[0] for c in piece] for piece in cubics(t, f)])
    expected = CubicSpline(t, f).c
    np.testing.assert_allclose(found[:, : len(expected)], expected[::-1].transpose(1, 0, 2), atol=1e-12)


def test_a_cubic_is_its_own_spline():
    t = np.array([-1.0, -0.5, 0.25, 0.5, 1.0])
    with flint().ctx.workprec(120):
        for k, (_, c1, c2, c3) in enumerate(cubics(t, (t**3)[:, None])):
            for c, truth in ((c1, 3 * t[k] ** 2), (c2, 3 * t[k]), (c3, 1.0)):
                assert c[0, 0].contains(matrix(np.array([[truth]]))[0, 0])
                assert np.ptp(ends(c[0, 0] - truth)) < 1e-30
