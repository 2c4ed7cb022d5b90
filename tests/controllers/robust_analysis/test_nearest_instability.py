"""The first instability in growing boxes."""

import numpy as np
import pytest

from pliant.controllers.robust_analysis.nearest_instability import growth, nearest


def test_the_satellite_ends_at_opposite_gains():
    a, J = 10.0, np.array([[0.0, 1.0], [-1.0, 0.0]])
    found = nearest(lambda d: a * J - np.diag(1 + d) @ (np.eye(2) + a * J), 2, None, 0.5)
    assert found is not None
    assert found[0] == pytest.approx(1 / np.sqrt(1 + a**2), rel=1e-6)
    assert found[1][0] == pytest.approx(-found[1][1], rel=1e-3)


def test_a_sampled_one_and_one_that_stands():
    found = nearest(lambda d: np.array([[0.5 + d[0]]]), 1, 0.1, 2.0)
    assert found is not None and found[0] == pytest.approx(0.5, rel=1e-9)
    assert nearest(lambda d: np.array([[-3.0 + d[0]]]), 1, None, 2.0) is None
    assert growth(np.array([[np.exp(-0.2)]]), 0.1) == pytest.approx(-2.0)
