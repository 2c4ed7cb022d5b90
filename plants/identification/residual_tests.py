"""Are residuals what the noise was said to be? Tests that come before any interval is believed.

Of each sensor, its motions together, with r = (I - H) e the residuals and F what is left of its degrees of freedom:

colour   Ljung and Box 1978, "On a measure of lack of fit in time series models": the sum of squared autocorrelations of
         LAGS lags, n/5 where there are fewer samples; and their weighted sum by falling weights (Bartlett's), against
         neighbours that go together: the spectrum near zero is larger than white noise's
faults   the score test of a regressor d that the plant lacks (Breusch and Pagan 1980; with estimated noise the F test
         of an added regressor, F(1, F - 1)): an offset, a drift, readings that come a sample late, offsets by motion
size     where the noise is given, r'r has a chi-squared distribution

All are judged together: the smallest p-value of all tests and sensors has the level `level_of` the samples. Up to FEW
samples its distribution is that of DRAWS of normal errors (a Monte Carlo test: Dwass 1957; smallest p-values: Westfall
and Young 1993), so that it holds for any number of samples, motions and parameters as far as the fit is linear; beyond,
Bonferroni's bound serves. As a motion may be wrong alone, each is tested for colour besides, at LEVEL.
Where FEWEST degrees of freedom are not left, no test can speak of a noise that is estimated from them; below TELLING
tests speak, and miss much: `tests/campaigns/residual_doubts.py` counts how much.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pliant.plants.experiments.experiment import Checked

from .output_error import Played
from .residual_space import ResidualSpace, Series

Array = np.ndarray
LAGS, LEVEL = 20, 1e-4
FEWEST = 12  # degrees of freedom of residuals that tests can speak of
TELLING = 80  # about from where further noise as large as the sensor's own, AR(0.9), is seen in 6 of 7 runs
FEW, DRAWS, HIGHEST = 500, 1999, 0.03
VARIANCE, SKEWNESS = 31.0, 105.0
SILENT = 1e-6  # part of a regressor that the parameters leave, below which it is one of theirs
FAULTS = {
    "offset": "a constant is left in the residuals of {}: an offset of the sensor, or physics that lack",
    "drift": "the residuals of {} drift with time",
    "late": "the residuals of {} go with the change of its readings: they come late or early, or physics lack",
    "motions": "the residuals of {} have means that differ from motion to motion",
}


def level_of(samples: int) -> float:
    """How often sound data may be doubted: less with more samples, which show faults without such a level."""
    return min(HIGHEST, max(LEVEL, 2 / samples))


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
    """The correlation of neighbours where residuals (nt,) of one motion are not white, None where nothing speaks
    against it, or they are too few to be judged alone.
    """
    rho, pairs = autocorrelation(r)
    enough = pairs > 2 * LAGS
    if not enough.any():
        return None
    q = float(np.sum(pairs[enough] * rho[enough] ** 2))
    return float(rho[0]) if beyond_squares(np.asarray(q), int(enough.sum()), len(r)) < LEVEL else None


def pearson(z: Array, skew: float) -> Array:
    """P(Z > z) of a standardised variable of that skewness: Pearson's type III, a chi-squared by its first moments.

    Levels of 1e-4 lie where the normal distribution is wrong by a factor of ten (500 samples).
    """
    from scipy.stats import chi2

    nu = 8 / max(skew, 1e-6) ** 2
    found: Array = chi2.sf(nu + z * np.sqrt(2 * nu), nu)
    return found


def skewness(c: Array, n: float) -> float:
    """Of sum_k c_k sum_i e_i e_(i+k) = e'Ae, which has variance one: 8 tr(A^3), A the band of c/2, ends left out."""
    band = np.concatenate([c[::-1], [0.0], c]) / 2
    return float(8 * n * (band * np.convolve(band, band)[len(c) : -len(c)]).sum())


def beyond_squares(q: Array, m: int, n: float) -> Array:
    """P(Q > q) of Ljung's and Box's sum of m squares of n samples: chi-squared, with its spread and skewness as n white
    samples have them (VARIANCE/n and SKEWNESS/n more, of 200,000 draws of 200 to 1500 samples, m = 20).
    """
    spread, skew = np.sqrt(2 * m * (1 + VARIANCE / n)), np.sqrt(8 / m) * (1 + SKEWNESS / n)
    return pearson((q - m) / spread, float(skew))


def lagged(e: Array, series: Sequence[Series]) -> tuple[Array, Array]:
    """(sums (.., h), pairs (h,)): products of samples that are 1 .. h apart in errors (.., N), of all series together.
    Lags that less than a quarter of the samples have are left out.
    """
    n = sum(one.end - one.first for one in series)
    lags = range(1, max(1, min(LAGS, n // 5)) + 1)
    pairs = np.array([sum(max(0, one.end - one.first - k) for one in series) for k in lags])
    sums = np.zeros((*e.shape[:-1], len(lags)))
    for k in lags:
        for one in series:
            if one.end - one.first > k:
                later, earlier = e[..., one.first + k : one.end], e[..., one.first : one.end - k]
                sums[..., k - 1] += np.einsum("...i,...i->...", later, earlier)
    kept = pairs > n / 4
    return sums[..., kept], pairs[kept]


@dataclass(frozen=True, eq=False)
class SensorTests:
    """The tests of one sensor's residuals: `p` of any errors."""

    signal: str
    given: bool  # its noise, else estimated
    space: ResidualSpace
    series: list[Series]
    freedom: float
    faults: dict[str, Array]  # {kind: unit regressor (N,), the parameters' part taken out}

    @classmethod
    def of(cls, space: ResidualSpace, signal: str, given: bool) -> SensorTests:
        series, faults = space.of_signal(signal), {}
        for kind, made in (("offset", _constant), ("drift", _time), ("late", _change)):
            d = np.zeros(len(space.t))
            for one in series:
                part = slice(one.first, one.end)
                d[part] = made(space.t[part], space.computed[part])
            rest = space.left(d)
            if np.linalg.norm(rest) > SILENT * np.linalg.norm(d):
                faults[kind] = rest / np.linalg.norm(rest)
        return cls(signal, given, space, series, space.freedom(signal), faults)

    def square(self, e: Array) -> Array:
        """The sum of squares (..) of the sensor's part of errors (.., N)."""
        return np.asarray(sum((e[..., one.first : one.end] ** 2).sum(axis=-1) for one in self.series))

    def p(self, e: Array, draws: Array | None) -> tuple[tuple[str, ...], Array]:
        """(kinds, p (.., kinds)) of residuals (.., N). Autocorrelations are set against the mean and the deviation that
        `draws` (DRAWS, N) of residuals have, None: those of independent errors.
        """
        from scipy.stats import chi2, f

        square, found = self.square(e), {}
        variance = np.maximum(square / self.freedom, 1e-300)
        sums, pairs = lagged(e, self.series)
        if len(pairs):
            z = sums / variance[..., None] / np.sqrt(pairs)
            if draws is not None:
                own = lagged(draws, self.series)[0] / (self.square(draws) / self.freedom)[:, None] / np.sqrt(pairs)
                z = (z - own.mean(axis=0)) / np.maximum(own.std(axis=0), 1e-12)
            found["colour"] = beyond_squares((z**2).sum(axis=-1), len(pairs), pairs[0])
            weight = np.arange(len(pairs), 0, -1) * np.sqrt(pairs)
            weight = weight / np.linalg.norm(weight)
            found["neighbours"] = pearson(z @ weight, skewness(weight / np.sqrt(pairs), pairs[0]))
        scores = {kind: ((e @ d) ** 2, 1) for kind, d in self.faults.items()}
        if len(self.series) > 1:
            means = sum(e[..., one.first : one.end].sum(axis=-1) ** 2 / (one.end - one.first) for one in self.series)
            scores["motions"] = (np.asarray(means), len(self.series))
        for kind, (score, k) in scores.items():
            if self.given:
                found[kind] = chi2.sf(score, k)
            elif self.freedom > k + 1:
                rest = np.maximum(square - score, 1e-12 * square) / (self.freedom - k)
                found[kind] = f.sf(score / k / np.maximum(rest, 1e-300), k, self.freedom - k)
        if self.given:
            found["size"] = chi2.sf(square, self.freedom)
        return tuple(found), np.stack(list(found.values()), axis=-1)

    def words(self, kind: str) -> str:
        """What a test of that kind says, as a sentence."""
        e = self.space.residual
        if kind == "size":
            return (
                f"the residuals of {self.signal} are {np.sqrt(self.square(e) / self.freedom):.3g} times the noise "
                f"that was given"
            )
        if kind in FAULTS:
            return FAULTS[kind].format(self.signal)
        sums, pairs = lagged(e, self.series)
        near = sums[0] / pairs[0] * self.freedom / self.square(e)
        return not_white(self.signal, near)


def not_white(what: str, near: float) -> str:
    """The sentence on residuals whose neighbours correlate by `near`."""
    return (
        f"the residuals of {what} are not white noise (neighbours correlate by {near:.2g}): "
        "a false minimum, physics that lack, or disturbances; try bounds with tries, or a finer plant"
    )


def judged(
    experiments: Sequence[Checked],
    played: Sequence[Played],
    free: Array,
    sigma: Mapping[str, float],
    given: Mapping[str, float],
    floor: Mapping[str, float],
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """(doubts, untested) as sentences: what the residuals of motions `played` say against their noise sigma, and the
    sensors of which tests can say little. `free` (np,): parameters that do not stand at a bound. Estimated noise at its
    `floor` is no noise: such residuals are rounding, and not looked at.
    """
    space = ResidualSpace.of(experiments, played, sigma, free)
    tests, doubts, untested = [], [], []
    for name in [s for s in sigma if space.of_signal(s)]:
        freedom = space.freedom(name)
        left = f"{max(freedom, 0.0):.3g} degrees of freedom"
        if freedom < TELLING:
            untested.append(
                f"the residuals of {name} have {left}: with fewer than {TELLING} the tests miss many a wrong model, "
                "and intervals hold only if the model does"
            )
        if name not in given and freedom < FEWEST:
            doubts.append(
                f"too few samples of {name} to test the residuals, from which its noise is estimated: they have "
                f"{left}, {FEWEST} are needed; give its noise"
            )
        elif freedom > 1 and (name in given or sigma[name] > floor[name]):
            tests.append(SensorTests.of(space, name, name in given))
    doubts += _doubts(experiments, played, tests, space)
    return tuple(doubts), tuple(untested)


def _doubts(
    experiments: Sequence[Checked], played: Sequence[Played], tests: Sequence[SensorTests], space: ResidualSpace
) -> Iterator[str]:
    """What tests say against the residuals, as sentences."""
    alone = set()
    for one, this in zip(experiments, played):
        for name, r in zip(one.signals, this.residual.T):
            near = coloured(r) if any(test.signal == name for test in tests) else None
            if near is not None:
                alone.add(name)
                yield not_white(f"{name} in {one.name}", near)
    for test, kind in failed(tests, space):
        if not (kind in ("colour", "neighbours") and test.signal in alone):
            alone.update({test.signal} if kind not in FAULTS and kind != "size" else ())
            yield test.words(kind)


def failed(tests: Sequence[SensorTests], space: ResidualSpace) -> list[tuple[SensorTests, str]]:
    """The tests, and of each the kind, whose p-values are smaller than the smallest of all should be."""
    if not tests:
        return []
    n = len(space.residual)
    draws = None
    if n <= FEW:
        draws = space.left(np.random.default_rng(0).standard_normal((DRAWS, n)))
    found = [(test, *test.p(space.residual, draws)) for test in tests]
    kinds = [(test, kind, p) for test, names, values in found for kind, p in zip(names, values)]
    critical = level_of(n) / len(kinds)
    if draws is not None:
        smallest = np.min([test.p(draws, draws)[1].min(axis=-1) for test in tests], axis=0)
        critical = np.sort(smallest)[int(level_of(n) * (DRAWS + 1)) - 1]
    return [(test, kind) for test, kind, p in kinds if p < critical]


def _constant(t: Array, y: Array) -> Array:
    return np.ones_like(t)


def _time(t: Array, y: Array) -> Array:
    return t - t[0]


def _change(t: Array, y: Array) -> Array:
    return np.diff(y, prepend=y[0])
