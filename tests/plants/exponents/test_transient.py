"""Growth before decay, held against closed forms."""

import numpy as np
import pytest

from pliant.plants.exponents.transient import transient


def test_growth_by_a_million_beside_a_stable_exponent(still):
    """[[-1, k], [0, -2]]: x1 = k (e^-t - e^-2t) x2, at most k/4, at t = ln 2; |Phi| is that to 1e-11."""
    found = transient(still([[-1.0, 4e6], [0.0, -2.0]]))
    assert found.factor == pytest.approx(1e6, rel=1e-3)
    assert found.time == pytest.approx(np.log(2), abs=0.03)
    assert np.abs(found.direction) == pytest.approx([0.0, 1.0], abs=1e-5)


def test_what_only_decays_has_grown_by_nothing(still, along):
    assert transient(still(-np.eye(3))).factor == 1.0
    assert transient(along(np.linspace(0, 5, 101), lambda t: -np.eye(2) * (2 + np.sin(t)))).factor == 1.0


def test_along_a_record(along):
    """Scalar: ln x = sin t, largest at pi/2."""
    t = np.linspace(0, 6, 601)
    found = transient(along(t, lambda t: np.array([[np.cos(t)]])))
    assert found.factor == pytest.approx(np.e, rel=1e-4) and found.time == pytest.approx(np.pi / 2, abs=0.01)
