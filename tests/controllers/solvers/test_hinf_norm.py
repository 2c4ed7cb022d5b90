"""Largest gains in closed form: of an oscillator 1/(2 zeta sqrt(1 - zeta^2)) at w sqrt(1 - 2 zeta^2) (any textbook)."""

import numpy as np
import pytest

from pliant.controllers.solvers.hinf_norm import continuous, peak
from pliant.plants import PliantError

ONE = np.ones((1, 1))


@pytest.mark.parametrize("zeta", [0.01, 0.3])
def test_oscillator(zeta):
    w = 7.0
    A, B, C = np.array([[0.0, 1.0], [-(w**2), -2 * zeta * w]]), np.array([[0.0], [w**2]]), np.array([[1.0, 0.0]])
    found = peak(A, B, C, 0 * ONE)
    assert found[0] == pytest.approx(1 / (2 * zeta * np.sqrt(1 - zeta**2)), rel=1e-6)
    assert found[1] == pytest.approx(w * np.sqrt(1 - 2 * zeta**2), rel=1e-3)
    assert found.hz == pytest.approx(found[1] / (2 * np.pi))


def test_lag_sampled_and_direct():
    """1/(s + 2) is largest at rest, s/(s + 2) at infinity; z^-1/(1 + z^-1/2) at half the sampling frequency."""
    assert peak(-2 * ONE, ONE, ONE, 0 * ONE)[:2] == pytest.approx((0.5, 0.0))
    assert peak(-2 * ONE, ONE, -2 * ONE, ONE)[0] == pytest.approx(1.0)
    found = peak(-0.5 * ONE, ONE, ONE, 0 * ONE, 0.1)
    assert found[0] == pytest.approx(2.0, rel=1e-6) and found.hz == pytest.approx(5.0, rel=1e-3)


def test_bilinear_map_keeps_the_gain():
    A, B, C, D = np.array([[0.3, 0.4], [-0.2, 0.5]]), np.array([[1.0], [0.5]]), np.array([[1.0, -1.0]]), 0.2 * ONE
    z = np.exp(0.7j)
    wide = continuous(A, B, C, D)
    s = 1j * np.tan(0.35)
    sampled = C @ np.linalg.solve(z * np.eye(2) - A, B) + D
    np.testing.assert_allclose(
        wide[2] @ np.linalg.solve(s * np.eye(2) - wide[0], wide[1]) + wide[3], sampled, rtol=1e-12
    )


def test_what_does_not_decay_is_refused():
    with pytest.raises(PliantError, match="does not decay"):
        peak(0 * ONE, ONE, ONE, ONE)
