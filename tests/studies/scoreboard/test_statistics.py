"""Aggregates against the definitions of Agarwal et al. 2021, SciPy's trimmed mean, rank test and bootstrap."""

import numpy as np
import pytest
from scipy import stats

from pliant.studies.scoreboard.statistics import (
    improvement,
    interquartile_mean,
    interval,
    mean_of_middle,
    of_runs,
    profile,
    share_interval,
)

RNG = np.random.default_rng(3)
ONE, OTHER = RNG.normal(1.0, 0.3, 40), RNG.normal(1.2, 0.2, 30)


@pytest.mark.parametrize("n", [1, 3, 4, 16, 41])
def test_interquartile_mean_is_scipys_trimmed_mean(n):
    values = RNG.exponential(size=(3, n))
    assert interquartile_mean(values) == pytest.approx(stats.trim_mean(values, 0.25, axis=-1), rel=1e-14)


def test_over_tasks_the_runs_of_all_are_one_sample():
    assert mean_of_middle([ONE, OTHER]) == pytest.approx(stats.trim_mean(np.append(ONE, OTHER), 0.25))


def test_profile_counts_runs_above_within_each_task():
    assert profile([np.array([0.1, 0.5]), np.array([0.5, 0.6, 0.7, 0.8])], np.array([0.0, 0.5, 0.65])) == pytest.approx(
        [1.0, (0 + 3 / 4) / 2, (0 + 2 / 4) / 2]
    )


def test_improvement_is_the_mann_whitney_statistic_over_all_pairs():
    x, y = np.round(ONE, 1), np.round(OTHER, 1)  # with ties
    own = stats.mannwhitneyu(x, y).statistic / (len(x) * len(y))
    assert improvement([x], [y]) == pytest.approx(own)
    assert improvement([x, y], [y, x]) == pytest.approx(0.5)


def test_interval_is_that_of_scipys_bootstrap():
    """Percentiles of 2000 draws of each: their own spread is about a twentieth of the interval."""
    low, high = of_runs(interquartile_mean, ONE)
    theirs = stats.bootstrap((ONE,), interquartile_mean, n_resamples=9999, method="percentile", rng=1)
    width = theirs.confidence_interval.high - theirs.confidence_interval.low
    assert low == pytest.approx(theirs.confidence_interval.low, abs=0.06 * width)
    assert high == pytest.approx(theirs.confidence_interval.high, abs=0.06 * width)


def test_tasks_are_drawn_within_themselves():
    """Two tasks without spread: strata leave nothing to chance, where drawing from all runs would."""
    assert interval(mean_of_middle, [np.zeros(20), np.ones(20)]) == (0.5, 0.5)
    assert np.isnan(interval(mean_of_middle, [np.zeros(0)])).all()


def test_shares_have_clopper_and_pearsons_interval():
    for count in (0, 3, 64):
        theirs = stats.binomtest(count, 64).proportion_ci(method="exact")
        assert share_interval(count, 64) == pytest.approx((theirs.low, theirs.high), abs=1e-12)
