"""Tests of residuals: known series, how often white noise is doubted, what short data are not asked."""

import numpy as np
import pytest
import residual_doubts as campaign
from scipy.signal import lfilter
from springs import NOISE, TRUE, VARIED

from pliant.plants import identify
from pliant.plants.identification.residual_space import Series
from pliant.plants.identification.residual_tests import (
    FEWEST,
    HIGHEST,
    LAGS,
    LEVEL,
    TELLING,
    autocorrelation,
    beyond_squares,
    coloured,
    lagged,
    level_of,
    pearson,
    skewness,
)


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


def test_products_of_lags_stay_within_a_series():
    e = np.random.default_rng(4).standard_normal(100)
    sums, pairs = lagged(e, [Series("y", 0, 0, 40), Series("y", 1, 40, 100)])
    assert len(pairs) == LAGS and pairs[2] == 37 + 57
    assert sums[2] == pytest.approx(e[3:40] @ e[:37] + e[43:] @ e[40:97])


def test_small_levels_are_what_white_noise_shows():
    """20,000 draws of 200 samples: 20 expected below 1e-3, with a deviation of 4.5 (chi-squared and the normal
    distribution, which large samples tend to, give 67 and 130).
    """
    e = np.random.default_rng(6).standard_normal((20_000, 200))
    sums, pairs = lagged(e, [Series("y", 0, 0, 200)])
    z = sums / (e**2).mean(axis=1)[:, None] / np.sqrt(pairs)
    assert 7 <= (beyond_squares((z**2).sum(axis=1), LAGS, 200) < 1e-3).sum() <= 34
    c = np.arange(LAGS, 0, -1.0) / np.sqrt((np.arange(LAGS, 0, -1.0) ** 2 * pairs).sum())
    seen = pearson(z @ (c * np.sqrt(pairs)), skewness(c, 200))
    assert 7 <= (seen < 1e-3).sum() <= 34


def test_the_skewness_of_a_quadratic_form():
    """8 tr(A^3) of the dense band."""
    c, n = np.array([0.5, 0.2, -0.3]), 400
    A = sum(np.diag(np.full(n - k, v / 2), k) + np.diag(np.full(n - k, v / 2), -k) for k, v in enumerate(c, 1))
    assert skewness(c, n) == pytest.approx(8 * np.trace(A @ A @ A), rel=0.03)  # ends


def test_sound_data_are_doubted_the_less_the_more_samples_there_are():
    assert level_of(10) == HIGHEST and level_of(1000) == 2e-3 and level_of(10**6) == LEVEL


def found(n: int, kind: str, given: bool, seed: int = 3):
    motion = campaign.motion(n, [seed, 0, 0], kind)
    return identify(VARIED, motion, start=campaign.FROM, noise={"place": campaign.SIGMA} if given else None)


def test_few_samples_are_not_tested_and_intervals_say_so():
    few = found(40, "sound", given=True)
    assert not few.doubts and not few.trusted and "fewer than 80" in few.conditional[0]
    assert few.summary().count("if the model holds") == len(TRUE) and "not tested" in repr(few)
    assert few.table()["conditional"] == list(few.conditional) and not few.table()["trusted"]
    many = found(TELLING + 10, "sound", given=True)
    assert many.trusted and not many.conditional and "if the model holds" not in many.summary()
    least = found(FEWEST + 2, "sound", given=False)  # less 3 parameters 11 degrees of freedom
    assert "too few samples of place" in least.doubts[0] and set(least.intervals.values()) == {(-np.inf, np.inf)}


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("offset 3", "a constant is left in the residuals of place"),
        ("drift 3", "the residuals of place drift with time"),
        ("late", "they come late or early"),
        ("AR(0.9)", "not white noise"),
        ("dry friction", "the residuals of place"),
        ("extra mode", "the residuals of place"),
        ("noise x 1.5", "times the noise that was given"),
    ],
)
def test_each_fault_is_named(kind, words):
    doubts = found(200, kind, given=True).doubts
    assert any(words in said for said in doubts)


def test_a_fault_of_one_motion_among_ten_is_seen():
    motions = [campaign.motion(40, [5, 0, k], "offset 3" if k == 4 else "sound") for k in range(10)]
    options = {"start": campaign.FROM, "noise": {"place": NOISE["place"]}}
    assert identify(VARIED, motions[:4] + motions[5:], **options).trusted
    assert identify(VARIED, motions, **options).doubts
