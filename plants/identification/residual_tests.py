"""Are residuals what the noise was said to be? Tests that come before any interval is believed.

White       Ljung and Box 1978, "On a measure of lack of fit in time series models": Q = n (n + 2) sum rho_k^2/(n - k)
            over LAGS lags has a chi-squared distribution of LAGS degrees of freedom where they are independent
As large    the sum of squares in given standard deviations has a chi-squared distribution
Each at a level of LEVEL, so that sound data are doubted once in ten thousand times.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from .experiment import Checked

Array = np.ndarray
LAGS, LEVEL = 20, 1e-4


def autocorrelation(r: Array) -> tuple[Array, Array]:
    """(rho (LAGS,), pairs (LAGS,)) of residuals (nt,), NaN where missing: lags 1, 2, .. and how many pairs each has."""
    known = ~np.isnan(r)
    centred = np.where(known, r, 0.0)
    variance = np.sum(centred**2) / max(1, known.sum())
    lags = range(1, LAGS + 1)
    pairs = np.array([np.sum(known[k:] & known[:-k]) for k in lags])
    sums = np.array([centred[k:] @ centred[:-k] for k in lags])
    return sums / np.maximum(1, pairs) / (variance or 1.0), pairs


def coloured(r: Array) -> float | None:
    """The correlation of neighbours where residuals (nt,) are not white, None where nothing speaks against it."""
    from scipy.stats import chi2

    rho, pairs = autocorrelation(r)
    enough = pairs > 2 * LAGS
    if not enough.any():
        return None
    q = float(np.sum(pairs[enough] * rho[enough] ** 2))
    return float(rho[0]) if chi2.sf(q, int(enough.sum())) < LEVEL else None


def too_large(squares: float, freedom: float) -> bool:
    """Whether a sum of squares, in given standard deviations, is larger than chance explains."""
    from scipy.stats import chi2

    return freedom > 0 and bool(chi2.sf(squares, freedom) < LEVEL)


def doubts(
    experiments: Sequence[Checked],
    residuals: Sequence[Array],
    squares: Mapping[str, tuple[float, int]],
    sigma: Mapping[str, float],
    given: Mapping[str, float],
    floor: Mapping[str, float],
) -> Iterator[str]:
    """What residuals [(nt, ny) ..] and their `squares` {signal: (sum, samples)} say against their noise sigma, as
    sentences. Estimated noise at its `floor` is no noise: such residuals are rounding, and are not looked at.
    """
    for one, values in zip(experiments, residuals):
        for name, r in zip(one.signals, values.T):
            near = coloured(r) if name in given or sigma[name] > floor[name] else None
            if near is not None:
                yield (
                    f"the residuals of {name} in {one.name} are not white noise (neighbours correlate by {near:.2g}): "
                    "a false minimum, physics that lack, or disturbances; try bounds with tries, or a finer plant"
                )
    for name, level in given.items():
        total, count = squares[name]
        if too_large(total / level**2, count):
            times = np.sqrt(total / count) / level
            yield f"the residuals of {name} are {times:.3g} times the noise that was given"
