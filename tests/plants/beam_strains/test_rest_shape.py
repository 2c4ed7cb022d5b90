"""Curvature at rest as a number and as a function."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants.beam_strains.rest_shape import RestShape, is_curved, rest_curvature

XI = np.array([0.0, 0.2, 0.7, 1.0])


def test_angle_is_the_integral_of_the_curvature():
    for given, angle in ((0.4, 0.4 * XI), (lambda xi: 3 * xi**2 - 1, XI**3 - XI), (np.cos, np.sin(XI))):
        shape = RestShape(given, 2.5)
        np.testing.assert_allclose(np.asarray(ca.DM(shape.angle(XI))).ravel(), 2.5 * angle, atol=1e-14)
        slope = given(XI) if callable(given) else np.full(4, given)
        np.testing.assert_allclose(np.asarray(ca.DM(shape.bent(XI))).ravel(), 2.5 * slope, atol=1e-14)


def test_what_is_curved():
    assert not is_curved(0.0)
    assert is_curved(1e-9) and is_curved(np.sin) and is_curved(ca.SX.sym("k"))


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("bent", r"beam.rest_curvature = 'bent' must be a"),
        (float("nan"), r"beam.rest_curvature = nan"),
        (lambda xi: xi[:2], r"must be a number or a function of xi \(k,\)"),
        (lambda xi: xi / 0 * np.inf, r"must be a number or a function of xi \(k,\)"),
        (lambda: 1.0, r"must be a number or a function of xi \(k,\)"),
    ],
)
def test_what_is_no_curvature_is_refused(value, message):
    with np.errstate(all="ignore"), pytest.raises(ValueError, match=message):
        rest_curvature("beam.rest_curvature", value)
