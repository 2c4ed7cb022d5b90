"""What few runs say, and how surely: aggregates of scores over runs and tasks with their bootstrap intervals.

Scores       one array (n_m,) of runs for each task m = 1 .. M; higher is better where two are compared
Mean of the  mean of all runs of all tasks without the lowest and the highest quarter of them ("IQM"): as robust as the
middle       median, and it wastes less of the data
Profile      F(tau) = mean over tasks of the share of runs with a score above tau
Improvement  P(X > Y) = mean over tasks of the share of pairs of runs with X above Y, ties counted half
Interval     percentiles of the same number over stratified bootstrap samples: each task's runs are drawn anew with
             replacement, within the task

Source   Agarwal, Schwarzer, Castro, Courville, Bellemare 2021, "Deep reinforcement learning at the edge of the
         statistical precipice", Section 4 and Appendix A.6
A bootstrap of runs that never failed is sure that none will: shares of failures have Clopper and Pearson's interval.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.special import betaincinv

Array = np.ndarray
Strata = Sequence[Array]
SAMPLES = 2000
CONFIDENCE = 0.95
CUT = 0.25  # of the runs at either end


def interquartile_mean(values: Array) -> Array:
    """(..,) of runs (.., n): the mean without floor(n/4) of them at either end. NaN where n = 0.

    Example
    -------
    >>> float(interquartile_mean(np.array([1.0, 2.0, 3.0, 100.0])))
    2.5
    """
    values = np.sort(np.asarray(values, dtype=float), axis=-1)
    n = values.shape[-1]
    if not n:
        return np.full(values.shape[:-1], np.nan)
    cut = int(CUT * n)
    return np.asarray(values[..., cut : n - cut].mean(axis=-1))


def mean_of_middle(tasks: Sequence[Array]) -> Array:
    """The interquartile mean over all runs of all tasks, each (.., n_m)."""
    return interquartile_mean(np.concatenate([np.asarray(t, dtype=float) for t in tasks], axis=-1))


def profile(tasks: Sequence[Array], at: Array) -> Array:
    """F(tau) (.., len(at)) of tasks (.., n_m)."""
    at = np.asarray(at, dtype=float)
    shares = [(np.asarray(t)[..., None, :] > at[:, None]).mean(axis=-1) for t in tasks]
    return np.asarray(np.mean(shares, axis=0))


def improvement(ours: Sequence[Array], theirs: Sequence[Array]) -> Array:
    """P(X > Y) (..,) of the same tasks, (.., n_m) and (.., k_m)."""
    found = []
    for x, y in zip(ours, theirs, strict=True):
        x, y = np.asarray(x)[..., :, None], np.asarray(y)[..., None, :]
        found.append(((x > y) + 0.5 * (x == y)).mean(axis=(-1, -2)))
    return np.asarray(np.mean(found, axis=0))


def interval(
    statistic: Callable[..., Array], *groups: Strata, samples: int = SAMPLES, seed: int = 0
) -> tuple[float, float]:
    """(low, high) of `statistic(*groups)`, each group a list of tasks, by the stratified bootstrap.

    NaN where a task has no run. The draws depend on `seed` and the numbers of runs alone.
    """
    rng = np.random.default_rng([seed, 17])
    if any(not len(task) for group in groups for task in group) or not all(len(group) for group in groups):
        return (float("nan"), float("nan"))
    drawn = [
        [np.asarray(task, dtype=float)[rng.integers(0, len(task), (samples, len(task)))] for task in group]
        for group in groups
    ]
    edge = (1 - CONFIDENCE) / 2
    with np.errstate(invalid="ignore"):
        low, high = np.quantile(statistic(*drawn), [edge, 1 - edge], method="inverted_cdf")
    return float(low), float(high)


def of_runs(statistic: Callable[[Array], Array], values: Array, *, seed: int = 0) -> tuple[float, float]:
    """The interval of a number of one task's runs (n,), `statistic` of (.., n)."""
    return interval(lambda tasks: statistic(tasks[0]), [np.asarray(values, dtype=float)], seed=seed)


def share_interval(count: int, runs: int) -> tuple[float, float]:
    """Clopper and Pearson's interval of the share that `count` of `runs` tells.

    Example
    -------
    >>> [round(float(v), 4) for v in share_interval(0, 64)]  # 1 - 0.025^(1/64)
    [0.0, 0.056]
    """
    edge = (1 - CONFIDENCE) / 2
    low = 0.0 if not count else float(betaincinv(count, runs - count + 1, edge))
    high = 1.0 if count == runs else float(betaincinv(count + 1, runs - count, 1 - edge))
    return low, high
