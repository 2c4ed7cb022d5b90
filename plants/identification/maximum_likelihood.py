"""Parameters of a plant from measured motions, by maximum likelihood of the output error.

y(t_k) = h(x(t_k), u, theta) + e_k, the motion itself undisturbed, e_k independent and normal with a standard deviation
sigma of each sensor. Where sigma is not given it is estimated: between searches it becomes the residuals' own (Ljung,
"System Identification: Theory for the User", Sections 7.4 and 10.2; Maine and Iliff, NASA RP-1168, 1985). The search is
Gauss-Newton's with Levenberg's and Marquardt's damping on exact sensitivities. An interval is claimed only where the
residuals pass the tests of residual_tests.py: a false minimum, physics that lack and disturbances leave coloured ones.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_count, require_function
from pliant.plants.core.errors import IntegrationError
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant
from pliant.plants.experiments.experiment import Experiment

from . import bounded_least_squares, residual_tests
from .bounded_least_squares import Found, Linearised
from .fisher_information import covariance
from .identification import Identification, conclude
from .output_error import Fit, OutputError, Played, stated

Array = np.ndarray
NOISE_ROUNDS, NOISE_SETTLED = 12, 1e-3  # searches between which the noise is estimated, and its relative change
SMALLEST_NOISE = 1e-7  # of a signal's size: what integration and rounding leave
STEP_ERROR, STEP_HALVINGS = 0.05, 10  # standard errors that the steps may move a value
SMALL_CHANGE = 1e-9  # relative to a parameter: what the steps may always move it
TRIES = 1000
MANY, FIRST_PARTS = 20_000, (1 / 16, 1 / 4)  # times past which a search begins with first parts of every motion
Told = Callable[[float, str], None]


def identify(
    plant: Plant,
    motions: Experiment | Trajectory | Sequence[Experiment | Trajectory],
    *,
    noise: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    start: Mapping[str, float] | None = None,
    tries: int = 1,
    seed: int = 0,
    progress: Told | None = None,
) -> Identification:
    """The varied parameters of a plant from measured motions.

    plant     one that varies parameters, by path: `plant.vary("link1.E", "payload.mass")`
    motions   an `Experiment` or a Trajectory, or several; each has its own inputs, sensors, start and missing samples
    noise     {signal: standard deviation of a sample}, of all motions; of the signals left out it is estimated
    bounds    {parameter: (low, high)}, kept at every step; else only what the parameter itself must be
    start     {parameter: value} where the search starts, else the plant's own
    tries     searches, the further ones from a Latin hypercube within the bounds; the likeliest end is taken. Where
              there are several, each begins with the first sixteenth and the first quarter of every motion
    progress  called with the part done and what is done

    Raises IntegrationError where no search has a start whose motion is finite. See `Identification` for the result.

    >>> found = identify(arm.vary("link.E"), [motion], noise={"hub_angle": 2.4e-5})
    >>> low, high = found.intervals["link.E"]
    >>> low < found.values["link.E"] < high, found.unidentifiable
    (True, ())
    """
    began, owner = clock.perf_counter(), "identify"
    problem, levels = stated(owner, plant, motions, noise, bounds, start)
    tries, seed = require_count(owner, "tries", tries, 1, TRIES), require_count(owner, "seed", seed, 0, 2**63)
    tell = require_function(f"{owner}.progress", progress) if progress is not None else lambda part, doing: None
    search = _Search(problem, levels, tell)
    fit = search.best(problem.space.tried(owner, tries, seed))
    if fit is None:
        raise IntegrationError(
            "no search has a start whose motion is finite; give a start nearer to the truth, or bounds",
            float(problem.experiments[0].t[0]),
            problem.experiments[0].start,
            problem.steps[0],
        )
    fit, step_error = search.refined(fit)
    stats: dict[str, Any] = {"tries": tries, "evaluations": search.evaluations, "steps": list(problem.steps)}
    assert search.played is not None
    tested, untested = search.judged(fit)
    stats["seconds"] = clock.perf_counter() - began
    doubts = (*_of_search(fit, step_error), *tested)
    return conclude(problem, fit, search.played, levels, doubts, untested, step_error, stats)


class _Search:
    """Searches of one problem."""

    def __init__(self, problem: OutputError, levels: Mapping[str, float], tell: Told) -> None:
        self.problem, self.levels, self.tell = problem, levels, tell
        self.evaluations, self.ahead, self.damping = 0, (0.0, 1.0), bounded_least_squares.FIRST
        self.size = dict.fromkeys(problem.signals, 0.0)
        for e in problem.experiments:
            for name, column in zip(e.signals, e.y.T):
                if not np.isnan(column).all():
                    self.size[name] = max(self.size[name], float(np.nanmax(np.abs(column))))
        self.samples = problem.samples
        self.played: list[Played] | None = None
        self._kept: dict[bytes, list[Played]] = {}

    def best(self, starts: Array) -> Fit | None:
        """The likeliest end of searches from parameters (tries, np)."""
        found: Fit | None = None
        by_parts = len(starts) > 1 or sum(len(e.t) for e in self.problem.experiments) > MANY
        for k, theta in enumerate(starts):
            self.ahead, self.damping = (k / len(starts), 1 / len(starts)), bounded_least_squares.FIRST
            z = self.problem.start
            z[: self.problem.np] = theta / self.problem.space.scale
            fit = self.fitted(*(self._from_parts(z) if by_parts else (z, None)))
            if fit is not None and (found is None or fit.cost < found.cost):
                found = fit
        return found

    def _from_parts(self, z: Array) -> tuple[Array, Mapping[str, float] | None]:
        """A nearer start, from first parts of the motions: a short one has fewer false minima, and fewer samples.

        Taken where it is nearer to the whole motions than z, which else is the start.
        """
        near, sigma = z, None
        for share in FIRST_PARTS:
            self._play_share(share)
            found = self.fitted(near, sigma)
            near, sigma = (found.z, found.sigma) if found is not None else (near, sigma)
        self._play_share(1.0)
        if sigma is None:
            return z, None
        costs = [at.cost if (at := self._linearise(point, sigma)) is not None else np.inf for point in (z, near)]
        return (near, sigma) if costs[1] <= costs[0] else (z, None)

    def _play_share(self, share: float) -> None:
        self.problem.share = share
        self._kept.clear()

    def fitted(self, z: Array, sigma: Mapping[str, float] | None = None) -> Fit | None:
        """From z, the noise estimated between searches where it is not given."""
        now = {s: self.levels.get(s, self._loudest(s)) for s in self.problem.signals} if sigma is None else dict(sigma)
        used, settled, found = 0, False, None
        for _ in range(NOISE_ROUNDS):
            found = self._minimised(z, now)
            if found is None:
                return None
            used, z = used + found.evaluations, found.z
            new, played = self._estimated(z, now), self.played
            settled = all(abs(new[s] / now[s] - 1) < NOISE_SETTLED for s in now)
            now = new
            if settled:
                break
        assert found is not None and played is not None
        at = self.problem.linearised(played, now)
        counts = {s: n for s, (_, n) in self.problem.squares(played).items()}
        cost = at.cost + sum(n * np.log(now[s]) for s, n in counts.items())
        return Fit(z, at, now, used, found.converged and settled, float(cost))

    def _loudest(self, signal: str) -> float:
        return self.size[signal] or 1.0

    def _linearise(self, z: Array, sigma: Mapping[str, float]) -> Linearised | None:
        """At z, whose motions are played unless they are one of the last two."""
        played = self._kept.get(z.tobytes())
        if played is None:
            self.evaluations += self.problem.share == 1.0
            played = self.problem.play_all(z)
            if played is None:
                return None
            if len(self._kept) > 1:
                self._kept.pop(next(iter(self._kept)))
            self._kept[z.tobytes()] = played
        return self.problem.linearised(played, sigma)

    def _minimised(self, z: Array, sigma: Mapping[str, float]) -> Found | None:
        def told(used: int, cost: float) -> None:
            first, part = self.ahead
            rms = np.sqrt(2 * cost / max(1, self.samples * self.problem.share))
            self.tell(min(0.99, first + part * used / 30), f"evaluation {self.evaluations}, residuals {rms:.4g} sigma")

        lower, upper = self.problem.bounds
        options: dict[str, Any] = {"damping": self.damping, "told": told}
        found = bounded_least_squares.minimise(lambda trial: self._linearise(trial, sigma), z, lower, upper, **options)
        if found is not None:
            self.damping = found.damping
            self.played = self._kept.get(found.z.tobytes()) or self.problem.play_all(found.z)
        return found

    def _estimated(self, z: Array, now: Mapping[str, float]) -> dict[str, float]:
        """The noise of each sensor: given, or the residuals' own, its share of the unknowns taken from the samples."""
        assert self.played is not None
        share = len(z) / max(self.samples * self.problem.share, len(z) + 1)
        found = {}
        for s, (squares, n) in self.problem.squares(self.played).items():
            level = np.sqrt(squares / max(n * (1 - share), 1e-3)) if n else now[s]
            found[s] = self.levels.get(s, max(float(level), SMALLEST_NOISE * self._loudest(s)))
        return found

    def refined(self, fit: Fit) -> tuple[Fit, float]:
        """The fit with steps so short that halving them moves no value by more than STEP_ERROR standard errors; the
        largest such move that is left.
        """
        n = self.problem.np
        for _ in range(STEP_HALVINGS):
            error = np.inf
            if not self.problem.halve():
                break
            self.evaluations += 1
            finer = self.problem.play_all(fit.z)
            if finer is None:
                break
            self.played = finer
            self._kept = {fit.z.tobytes(): finer}
            at = self.problem.linearised(finer, fit.sigma)
            lower, upper = self.problem.bounds
            move = np.abs(bounded_least_squares.within(at.R, at.r, lower - fit.z, upper - fit.z)[:n])
            deviation = np.sqrt(np.diag(covariance(at.R)))[:n]
            sure = np.isfinite(deviation) & (deviation > 0) & (move > SMALL_CHANGE * np.abs(fit.z[:n]))
            error = float((move[sure] / deviation[sure]).max(initial=0.0))
            if error <= STEP_ERROR:
                break
            again = self.fitted(fit.z, fit.sigma)
            if again is None:
                break
            fit = again
        return fit, error

    def judged(self, fit: Fit) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """What the residuals say against the end of the searches, and of which no test of them could speak."""
        floor = {s: SMALLEST_NOISE * self._loudest(s) for s in fit.sigma}
        bound = self.problem.space.at_bound(self.problem.parameters(fit.z))
        free = np.array([name not in bound for name in self.problem.space.names])
        experiments, played = self.problem.experiments, self.played or ()
        return residual_tests.judged(experiments, played, free, fit.sigma, self.levels, floor)


def _of_search(fit: Fit, step_error: float) -> Iterator[str]:
    """What of the search itself speaks against its end."""
    if not fit.converged:
        yield "the search has not converged: give bounds, another start, or tries"
    if not step_error <= STEP_ERROR:
        yield f"the integration steps move values by {step_error:.2g} standard errors"
