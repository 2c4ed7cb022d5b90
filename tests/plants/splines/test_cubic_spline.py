"""Piecewise cubics against scipy.interpolate's, another program, digit by digit, and against a cubic itself."""

import numpy as np
import pytest
from scipy import interpolate

from pliant.plants.splines.cubic_spline import CubicHermite, CubicSpline


@pytest.mark.parametrize("nodes", [2, 3, 4, 5, 40])
@pytest.mark.parametrize("shape", [(), (3,), (2, 2)])
def test_equals_scipy_to_the_last_digit(nodes, shape):
    rng = np.random.default_rng(nodes)
    t = np.cumsum(rng.uniform(0.01, 1.0, nodes))
    f, s = rng.normal(size=(2, nodes, *shape)) * 1e5
    at = np.concatenate([t, rng.uniform(t[0] - 0.1, t[-1] + 0.1, 50)])
    pairs = (
        (CubicSpline(t, f), interpolate.CubicSpline(t, f)),
        (CubicHermite(t, f, s), interpolate.CubicHermiteSpline(t, f, s)),
    )
    for own, other in pairs:
        for derivative in (0, 1):
            np.testing.assert_array_equal(own(at, derivative), other(at, derivative))
            np.testing.assert_array_equal(own(float(at[-1]), derivative), other(float(at[-1]), derivative))


def test_more_than_is_found_at_once():
    t, rng = np.linspace(0.0, 1.0, 30), np.random.default_rng(0)
    f, at = rng.normal(size=(30, 700)), rng.uniform(0.0, 1.0, (10, 9))
    np.testing.assert_array_equal(CubicSpline(t, f)(at), interpolate.CubicSpline(t, f)(at))


def test_a_cubic_is_its_own_spline():
    t = np.array([0.0, 0.3, 1.0, 1.1, 2.0])
    spline, at = CubicSpline(t, t**3 - 2 * t), np.linspace(-0.5, 2.5, 7)
    np.testing.assert_allclose(spline(at), at**3 - 2 * at, atol=1e-13)
    np.testing.assert_allclose(spline(at, 1), 3 * at**2 - 2, atol=1e-13)


@pytest.mark.parametrize(
    ("t", "f", "told"),
    [
        ([0.0, 1.0, 2.0], [0.0, np.nan, 1.0], "f has entries that are not finite"),
        ([0.0, 2.0, 1.0], [0.0, 1.0, 2.0], r"t\[1\], \[2\] = 2, 1 must be finite and strictly increasing"),
        ([0.0, 0.0, 1.0], [0.0, 1.0, 2.0], r"t\[0\], \[1\] = 0, 0 must be"),
        ([0.0, np.nan, 1.0], [0.0, 1.0, 2.0], r"t\[0\], \[1\] = 0, nan must be"),
        ([0.0, 1.0, np.inf], [0.0, 1.0, 2.0], r"t\[1\], \[2\] = 1, inf must be"),
        ([0.0], [1.0], r"t has shape \(1,\), must be"),
        ([0.0, 1.0, 2.0, 3.0], [0.0, 1.0], r"f has shape \(2,\), must be \(4,\)"),
    ],
)
def test_what_no_spline_goes_through(t, f, told):
    with pytest.raises(ValueError, match=f"CubicSpline.{told}"):
        CubicSpline(t, f)
    with pytest.raises(ValueError, match=f"CubicHermite.{told}"):
        CubicHermite(t, f, np.zeros(len(f)))


def test_slopes_are_as_many_as_values_and_finite():
    with pytest.raises(ValueError, match=r"CubicHermite.s has shape \(2, 1\), must be \(2, 2\)"):
        CubicHermite([0.0, 1.0], np.zeros((2, 2)), np.zeros((2, 1)))
    with pytest.raises(ValueError, match=r"CubicHermite\.s has entries that are not finite"):
        CubicHermite([0.0, 1.0], [0.0, 1.0], [0.0, np.inf])


@pytest.mark.parametrize("derivative", [2, -1])
def test_no_other_derivative_is_given(derivative):
    with pytest.raises(ValueError, match=f"CubicSpline: derivative = {derivative} must be 0 or 1"):
        CubicSpline([0.0, 1.0, 2.0], [0.0, 1.0, 4.0])(0.5, derivative)
