"""Tests of residuals: known series, and how often white noise is doubted."""

import numpy as np
import pytest
from scipy.signal import lfilter

from pliant.plants.identification.residual_tests import LAGS, autocorrelation, coloured, too_large


def test_autocorrelation_of_a_first_order_process():
    """rho_k = a^k (Box, Jenkins and Reinsel, "Time Series Analysis", 3.2.3)."""
    e = np.random.default_rng(0).standard_normal(200_000)
    rho, pairs = autocorrelation(lfilter([1.0], [1.0, -0.6], e))
    assert np.abs(rho - 0.6 ** np.arange(1, LAGS + 1)).max() < 0.02 and pairs[0] == 199_999


def test_missing_samples_take_no_part():
    r = np.random.default_rng(1).standard_normal(400)
    r[::7] = np.nan
    rho, pairs = autocorrelation(r)
    known = ~np.isnan(r)
    both = known[1:] & known[:-1]
    assert pairs[0] == both.sum() and rho[0] == pytest.approx((r[1:] * r[:-1])[both].mean() / np.nanmean(r**2))


def test_white_noise_is_doubted_no_more_often_than_said():
    rng = np.random.default_rng(2)
    assert sum(coloured(rng.standard_normal(300)) is not None for _ in range(1000)) <= 2  # 0.1 expected


def test_colour_is_seen_and_few_samples_say_nothing():
    e = np.random.default_rng(3).standard_normal(1000)
    assert coloured(lfilter([1.0], [1.0, -0.4], e)) == pytest.approx(0.4, abs=0.1)
    assert coloured(np.ones(30)) is None


def test_the_sum_of_squares():
    """95.0 % and 99.99 % of chi-squared with 10 degrees are 18.3 and 35.6 (tables)."""
    assert not too_large(18.3, 10) and not too_large(35.5, 10) and too_large(35.7, 10) and not too_large(1.0, 0)
