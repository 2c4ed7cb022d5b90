"""The largest growth of deviations against a dense search, and its direction."""

import numpy as np
import pytest
from horizon_models import constant
from scipy.linalg import expm

from pliant.plants.finite_horizon import finite_horizon


def test_growth_of_a_stable_system_that_is_not_normal():
    A = np.array([[-1.0, 30.0], [0.0, -1.5]])
    sizes = [np.linalg.norm(expm(A * s), 2) for s in np.linspace(0.0, 3.0, 4001)]
    found = finite_horizon(constant(A, [[1.0], [0.0]], [[1.0, 0.0]], 3.0)).growth
    assert max(sizes) * (1 - 1e-4) < found.value <= max(sizes) * (1 + 1e-12)
    grown = expm(A * (found.end - found.start)) @ found.direction
    assert np.linalg.norm(grown) == pytest.approx(found.value, rel=1e-9)
    assert np.linalg.norm(found.direction) == pytest.approx(1.0, rel=1e-12)
    assert found.whole == pytest.approx(np.linalg.norm(expm(3.0 * A), 2), rel=1e-9)


def test_what_only_decays_does_not_grow():
    found = finite_horizon(constant([[-2.0]], [[1.0]], [[1.0]], 1.0)).growth
    assert found.value == 1.0 and found.start == found.end


def test_sizes_of_states_are_those_given():
    A = np.array([[0.0, 1.0], [0.0, 0.0]])
    found = finite_horizon(constant(A, [[0.0], [1.0]], [[1.0, 0.0]], 1.0), scale={"x1": 10.0}).growth
    assert found.value == pytest.approx(np.linalg.norm([[1.0, 0.1], [0.0, 1.0]], 2), rel=1e-9)
