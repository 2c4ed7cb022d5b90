"""Parameters of a plant from measured motions, by maximum likelihood of the output error.

y(t_k) = h(x(t_k), u, theta) + e_k, the motion itself undisturbed, e_k independent and normal with a standard deviation
sigma of each sensor. Where sigma is not given it is estimated: between searches it becomes the residuals' own (Ljung,
"System Identification: Theory for the User", Sections 7.4 and 10.2; Maine and Iliff, NASA RP-1168, 1985). The search is
Gauss-Newton's with Levenberg's and Marquardt's damping on exact sensitivities. An interval is claimed only where the
residuals pass the tests of residual_tests.py: a false minimum, physics that lack and disturbances leave coloured ones.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import in_order, require_by_name, require_count, require_function
from pliant.plants.core.errors import IntegrationError
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant

from . import bounded_least_squares, residual_tests
from .bounded_least_squares import Found, Linearised
from .experiment import Experiment, checked
from .fisher_information import NORMAL, Untold, covariance, untold
from .identification import NOTHING, Identification, Residuals
from .output_error import OutputError, Played
from .parameter_space import ParameterSpace, varied

Array = np.ndarray
NOISE_ROUNDS, NOISE_SETTLED = 12, 1e-3  # searches between which the noise is estimated, and its relative change
SMALLEST_NOISE = 1e-7  # of a signal's size: what integration and rounding leave
STEP_ERROR, STEP_HALVINGS = 0.05, 10  # standard errors that the steps may move a value
SMALL_CHANGE = 1e-9  # relative to a parameter: what the steps may always move it
TRIES = 1000
Told = Callable[[float, str], None]


@dataclass(frozen=True, eq=False)
class Fit:
    """The end of a search: z, the noise {signal: sigma} there, and minus the logarithm of the likelihood."""

    z: Array
    at: Linearised
    sigma: Mapping[str, float]
    evaluations: int
    converged: bool
    cost: float


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
    tries     searches, the further ones from a Latin hypercube within the bounds; the likeliest end is taken
    progress  called with the part done and what is done

    Raises IntegrationError where no search has a start whose motion is finite. See `Identification` for the result.

    >>> found = identify(arm.vary("link1.E", "payload.mass"), motions, noise={"theta1": 2.4e-5})
    >>> found.values["link1.E"], found.intervals["link1.E"], found.unidentifiable, found.doubts
    """
    began, owner = clock.perf_counter(), "identify"
    plant = varied(owner, plant)
    one = isinstance(motions, (Experiment, Trajectory))
    given = (motions,) if one else in_order(f"{owner}.motions", motions, "motions")
    if not given:
        raise ValueError(f"{owner}.motions = () must hold at least one motion")
    experiments = [checked(plant, motion, owner, k) for k, motion in enumerate(given)]
    signals = tuple(dict.fromkeys(s for e in experiments for s in e.signals))
    levels = require_by_name(f"{owner}.noise", {} if noise is None else noise, signals, "signal", "positive")
    space = ParameterSpace.of(owner, plant, bounds, start)
    tries, seed = require_count(owner, "tries", tries, 1, TRIES), require_count(owner, "seed", seed, 0, 2**63)
    tell = require_function(f"{owner}.progress", progress) if progress is not None else lambda part, doing: None
    search = _Search(OutputError(plant, experiments, space), levels, tell)
    fit = search.best(space.tried(owner, tries, seed))
    if fit is None:
        raise IntegrationError(
            "no search has a start whose motion is finite; give a start nearer to the truth, or bounds",
            float(experiments[0].t[0]),
            experiments[0].start,
            search.problem.steps[0],
        )
    fit, step_error = search.refined(fit)
    stats = {"tries": tries, "evaluations": search.evaluations, "steps": list(search.problem.steps)}
    return search.result(fit, step_error, {**stats, "seconds": clock.perf_counter() - began})


class _Search:
    """Searches of one problem."""

    def __init__(self, problem: OutputError, levels: Mapping[str, float], tell: Told) -> None:
        self.problem, self.levels, self.tell = problem, levels, tell
        self.evaluations, self.ahead = 0, (0.0, 1.0)
        self.size = {s: 0.0 for s in problem.signals}
        for e in problem.experiments:
            for name, column in zip(e.signals, e.y.T):
                if not np.isnan(column).all():
                    self.size[name] = max(self.size[name], float(np.nanmax(np.abs(column))))
        self.samples = int(sum((~np.isnan(e.y)).sum() for e in problem.experiments))
        self.played: list[Played] | None = None

    def best(self, starts: Array) -> Fit | None:
        """The likeliest end of searches from parameters (tries, np)."""
        found: Fit | None = None
        for k, theta in enumerate(starts):
            self.ahead = (k / len(starts), 1 / len(starts))
            z = self.problem.start
            z[: self.problem.np] = theta / self.problem.space.scale
            fit = self.fitted(z)
            if fit is not None and (found is None or fit.cost < found.cost):
                found = fit
        return found

    def fitted(self, z: Array, sigma: Mapping[str, float] | None = None) -> Fit | None:
        """From z, the noise estimated between searches where it is not given."""
        now = {s: self.levels.get(s, self._loudest(s)) for s in self.problem.signals} if sigma is None else dict(sigma)
        used = 0
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
        assert played is not None
        at = self.problem.linearised(played, now)
        counts = {s: n for s, (_, n) in self.problem.squares(played).items()}
        cost = at.cost + sum(n * np.log(now[s]) for s, n in counts.items())
        return Fit(z, at, now, used, found.converged and settled, float(cost))

    def _loudest(self, signal: str) -> float:
        return self.size[signal] or 1.0

    def _minimised(self, z: Array, sigma: dict[str, float]) -> Found | None:
        kept: dict[bytes, list[Played]] = {}

        def linearise(trial: Array) -> Linearised | None:
            self.evaluations += 1
            played = self.problem.play_all(trial)
            if played is None:
                return None
            if len(kept) > 1:
                kept.pop(next(iter(kept)))
            kept[trial.tobytes()] = played
            return self.problem.linearised(played, sigma)

        def told(used: int, cost: float) -> None:
            first, part = self.ahead
            rms = np.sqrt(2 * cost / max(1, self.samples))
            self.tell(min(0.99, first + part * used / 30), f"evaluation {self.evaluations}, residuals {rms:.4g} sigma")

        lower, upper = self.problem.bounds
        found = bounded_least_squares.minimise(linearise, z, lower, upper, told=told)
        if found is not None:
            self.played = kept.get(found.z.tobytes()) or self.problem.play_all(found.z)
        return found

    def _estimated(self, z: Array, now: Mapping[str, float]) -> dict[str, float]:
        """The noise of each sensor: given, or the residuals' own, its share of the unknowns taken from the samples."""
        assert self.played is not None
        share = len(z) / max(self.samples, len(z) + 1)
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
            at = self.problem.linearised(finer, fit.sigma)  # type: ignore[arg-type]
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

    def result(self, fit: Fit, step_error: float, stats: Mapping[str, Any]) -> Identification:
        """With intervals where they may be claimed."""
        problem, space, n = self.problem, self.problem.space, self.problem.np
        played, sigma = self.played, dict(fit.sigma)
        assert played is not None
        theta = problem.parameters(fit.z)
        R = problem.information(played, sigma)
        C = covariance(R) * np.outer(space.scale, space.scale)
        deviation = np.sqrt(np.diag(C))
        relative = np.where(theta != 0, np.abs(theta), space.scale) / space.scale
        groups = untold(R * relative, space.names)
        bound = tuple(space.at_bound(theta))
        doubts = tuple(self._doubts(fit, played, step_error))
        lost = {name for g in groups for name in g.names} | set(bound)
        width = self._quantile(len(fit.z)) * deviation
        intervals = {
            name: NOTHING if doubts or name in lost else (float(v - w), float(v + w))
            for name, v, w in zip(space.names, theta, width)
        }
        sizes = np.where(np.isfinite(deviation) & (deviation > 0), deviation, np.nan)
        whole = np.sqrt(np.diag(covariance(fit.at.R)))
        starts = []
        for k, one in enumerate(problem.experiments):
            x0, states = problem.starts(fit.z, k), problem.plant.states
            errors = whole[problem.ends[k] : problem.ends[k + 1]] * one.scale
            starts.append({states[i].name: (float(x0[i]), float(e)) for i, e in zip(one.unknown, errors)})
        return Identification(
            given=problem.plant,
            values=dict(zip(space.names, theta.tolist())),
            units=dict(zip(space.names, space.units)),
            standard_errors=dict(zip(space.names, deviation.tolist())),
            intervals=intervals,
            unidentifiable=groups,
            doubts=doubts,
            correlation=C / np.outer(sizes, sizes),
            noise=sigma,
            noise_given=tuple(self.levels),
            starts=tuple(starts),
            residuals=tuple(
                Residuals(e.name, e.t, e.signals, one.residual) for e, one in zip(problem.experiments, played)
            ),
            at_bound=bound,
            converged=fit.converged,
            step_error=step_error,
            samples=self.samples,
            stats=stats,
        )

    def _quantile(self, unknowns: int) -> float:
        """Student's where any noise is estimated."""
        if set(self.levels) == set(self.problem.signals):
            return NORMAL
        from scipy.stats import t

        return float(t.ppf(0.975, max(1, self.samples - unknowns)))

    def _doubts(self, fit: Fit, played: Sequence[Played], step_error: float) -> list[str]:
        found = []
        if not fit.converged:
            found.append("the search has not converged: give bounds, another start, or tries")
        if not step_error <= STEP_ERROR:
            found.append(f"the integration steps move values by {step_error:.2g} standard errors")
        for e, one in zip(self.problem.experiments, played):
            for name, r in zip(e.signals, one.residual.T):
                if fit.sigma[name] <= SMALLEST_NOISE * self._loudest(name) and name not in self.levels:
                    continue
                near = residual_tests.coloured(r)
                if near is not None:
                    found.append(
                        f"the residuals of {name} in {e.name} are not white noise (neighbours correlate by {near:.2g}): "
                        "a false minimum, physics that lack, or disturbances; try bounds with tries, or a finer plant"
                    )
        for name, (squares, n) in self.problem.squares(played).items():
            if name in self.levels and residual_tests.too_large(squares / self.levels[name] ** 2, n):
                times = np.sqrt(squares / n) / self.levels[name]
                found.append(f"the residuals of {name} are {times:.3g} times the noise that was given")
        return found


__all__ = ["Untold", "identify"]
