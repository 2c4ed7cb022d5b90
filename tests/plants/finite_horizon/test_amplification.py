"""The largest growth of deviations against a dense search, and its direction."""

import numpy as np
import pytest
from horizon_models import constant
from scipy.linalg import expm

from pliant.plants.finite_horizon import finite_horizon


def test_growth_of_a_stable_system_that_is_not_normal():
    A = np.array([[-1.0, 30.0], [0.0, -1.5]])
    sizes = [np.linalg.norm(expm(A * s), 2) for s in np.linspace(0.0, 3.0, 4001)]
    found = finite_horizon(constant(A, [[1.0], [0.0]], [[1.0, 0.0]], 3.0)).amplification
    assert max(sizes) * (1 - 1e-4) < found.factor <= max(sizes) * (1 + 1e-12)
    grown = expm(A * (found.end - found.start)) @ found.direction
    assert np.linalg.norm(grown) == pytest.approx(found.factor, rel=1e-9)
    assert np.linalg.norm(found.direction) == pytest.approx(1.0, rel=1e-12)
    assert found.whole == pytest.approx(np.linalg.norm(expm(3.0 * A), 2), rel=1e-9)


def test_what_only_decays_does_not_grow():
    found = finite_horizon(constant([[-2.0]], [[1.0]], [[1.0]], 1.0)).amplification
    assert found.factor == 1.0 and found.start == found.end


def test_sizes_of_states_are_those_given():
    A = np.array([[0.0, 1.0], [0.0, 0.0]])
    found = finite_horizon(constant(A, [[0.0], [1.0]], [[1.0, 0.0]], 1.0), scale={"x1": 10.0}).amplification
    assert found.factor == pytest.approx(np.linalg.norm([[1.0, 0.1], [0.0, 1.0]], 2), rel=1e-9)


def test_growth_beyond_the_range_of_numbers_is_refused():
    with pytest.raises(ValueError, match=r"deviations grow by more than e\^300 from 0 to 1 s, beyond the range"):
        finite_horizon(constant([[400.0]], [[1.0]], [[1.0]], 1.0, nodes=2001))
    assert np.log(finite_horizon(constant([[250.0]], [[1.0]], [[1.0]], 1.0, nodes=2001)).amplification.factor) == (
        pytest.approx(250.0, rel=1e-9)
    )
