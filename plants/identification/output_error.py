"""The residuals of a plant's motions against measured ones, linearised in the parameters and in unknown starts.

z = [theta/scale; starts of motion 1/scale; ..], residuals in standard deviations of each sensor's noise.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import in_order, require_by_name, require_parts
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant
from pliant.plants.integration.step_maps import step_limit

from .bounded_least_squares import Linearised
from .experiment import Checked, Experiment, checked
from .fisher_information import condensed, triangle
from .parameter_space import ParameterSpace, varied
from .tangent_motion import METHOD, MOST_STEPS, SAME, TangentMotion, measured_function

Array = np.ndarray
OF_LIMIT = 0.5  # of the method's stability limit that the first step is
ROWS = 16_384  # samples at which outputs are computed at once


@dataclass(frozen=True, eq=False)
class Played:
    """One experiment computed: residuals y - y(z) (nt, ny), NaN where missing, and dy/dz (nt, ny, m)."""

    residual: Array
    slopes: Array


@dataclass(frozen=True, eq=False)
class Fit:
    """The end of a search: z, the noise {signal: sigma} there, and minus the logarithm of the likelihood."""

    z: Array
    at: Linearised
    sigma: Mapping[str, float]
    evaluations: int
    converged: bool
    cost: float


class OutputError:
    """y - y(theta, starts) of a set of experiments."""

    def __init__(self, plant: Plant, experiments: Sequence[Checked], space: ParameterSpace) -> None:
        self.plant, self.experiments, self.space = plant, experiments, space
        self.motion = TangentMotion(plant)
        self.np = len(space.start)
        self.sizes = [len(e.unknown) for e in experiments]
        self.ends = (self.np + np.cumsum([0, *self.sizes])).tolist()
        self.steps = [self._first_step(e) for e in experiments]
        self.share = 1.0  # of every experiment that is played, from its start
        self.signals = tuple(dict.fromkeys(s for e in experiments for s in e.signals))

    @property
    def start(self) -> Array:
        """z where the search begins."""
        parts = [self.space.start / self.space.scale]
        parts += [e.start[list(e.unknown)] / e.scale for e in self.experiments]
        return np.concatenate(parts)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper z; starts are free."""
        free = np.full(sum(self.sizes), np.inf)
        lower, upper = (b / self.space.scale for b in (self.space.lower, self.space.upper))
        return np.append(lower, -free), np.append(upper, free)

    def parameters(self, z: Array) -> Array:
        """theta (np,)."""
        return z[: self.np] * self.space.scale

    def starts(self, z: Array, k: int) -> Array:
        """The state (nx,) at which experiment k starts."""
        one = self.experiments[k]
        x0 = one.start.copy()
        x0[list(one.unknown)] = z[self.ends[k] : self.ends[k + 1]] * one.scale
        return x0

    def _first_step(self, one: Checked) -> float:
        shortest = float(np.diff(one.t).min())
        points = (one.start, self.plant.rest_state)
        with np.errstate(all="ignore"):
            limits = [step_limit(self.plant, x, METHOD, u=one.u[0], p=self.space.start) for x in points]
        step = float(min(shortest * (1 + SAME), OF_LIMIT * min(limits)))
        require_parts(f"step of {one.name}", step, float(one.t[-1] - one.t[0]), MOST_STEPS, "steps")
        return step

    def halve(self) -> bool:
        """Take steps half as long; False where they would be too many."""
        if max(float(e.t[-1] - e.t[0]) / h for e, h in zip(self.experiments, self.steps)) * 2 > MOST_STEPS:
            return False
        counts = [np.ceil(np.diff(e.t).max() / h - SAME) for e, h in zip(self.experiments, self.steps)]
        self.steps = [float(np.diff(e.t).max() / (2 * n) * (1 + SAME)) for e, n in zip(self.experiments, counts)]
        return True

    def play(self, z: Array, k: int) -> Played | None:
        """Experiment k, the share of it that is played; None where the motion is not finite."""
        one, p, m = self.experiments[k], self.parameters(z), self.np + self.sizes[k]
        nx, x0 = self.plant.nx, self.starts(z, k)
        seeds, directions = np.zeros((m, nx)), np.zeros((m, self.np))
        directions[: self.np] = np.diag(self.space.scale)
        for j, (state, size) in enumerate(zip(one.unknown, one.scale), self.np):
            seeds[j, state] = size
        options = {"step": self.steps[k], "hold": one.hold}
        nt, ny = max(2, int(np.ceil(self.share * len(one.t)))), len(one.signals)
        x, tangents = self.motion(one.t[:nt], x0, one.u[:nt], one.w, p, seeds, directions, **options)  # type: ignore[arg-type]
        if not (np.isfinite(x[-1]).all() and np.isfinite(tangents[-1]).all()):
            return None
        measured = measured_function(self.plant, one.signals)
        y, slopes = np.empty((nt, ny)), np.empty((nt, ny, m))
        for a in range(0, nt, ROWS):
            b = min(nt, a + ROWS)
            rows = slice(a, b)
            found = measured(one.t[rows, None], x[rows], one.u[rows], one.w, p, batch=b - a)
            y[rows] = found[0][:, :, 0]
            slopes[rows] = found[1] @ tangents[rows].transpose(0, 2, 1)
            slopes[rows, :, : self.np] += found[2] * self.space.scale
        if not (np.isfinite(y).all() and np.isfinite(slopes).all()):
            return None
        return Played(one.y[:nt] - y, slopes)

    def play_all(self, z: Array) -> list[Played] | None:
        """All experiments; None where one is not finite."""
        played = []
        for k in range(len(self.experiments)):
            one = self.play(z, k)
            if one is None:
                return None
            played.append(one)
        return played

    def factor(self, k: int, this: Played, sigma: Mapping[str, float]) -> Array:
        """Of experiment k the triangle of [d(starts), d(theta), residual], in standard deviations."""
        weight = 1 / np.array([sigma[s] for s in self.experiments[k].signals])
        r = (this.residual * weight).ravel()
        J = (this.slopes * weight[:, None]).reshape(len(r), -1)
        known = ~np.isnan(r)
        order = [*range(self.np, J.shape[1]), *range(self.np)]
        return condensed(-J[known][:, order], r[known])

    def linearised(self, played: Sequence[Played], sigma: Mapping[str, float]) -> Linearised:
        """r(z + s) ~ R s + r in all of z; what the triangles leave of the residual no s changes."""
        rows, rest = [], 0.0
        for k, this in enumerate(played):
            T, m = self.factor(k, this, sigma), self.sizes[k]
            block = np.zeros((len(T) - 1, self.ends[-1] + 1))
            block[:, self.ends[k] : self.ends[k + 1]] = T[:-1, :m]
            block[:, : self.np] = T[:-1, m : m + self.np]
            block[:, -1] = T[:-1, -1]
            rows.append(block)
            rest += float(T[-1, -1] ** 2) / 2
        whole = np.vstack(rows)
        return Linearised(whole[:, :-1], whole[:, -1], rest)

    def information_of(self, k: int, this: Played, sigma: Mapping[str, float]) -> Array:
        """R with R'R the Fisher information of experiment k on theta/scale, its unknown start eliminated."""
        m = self.sizes[k]
        return self.factor(k, this, sigma)[m:-1, m : m + self.np]

    def information(self, played: Sequence[Played], sigma: Mapping[str, float]) -> Array:
        """The same (np, np) of all experiments together."""
        return triangle(np.vstack([self.information_of(k, this, sigma) for k, this in enumerate(played)]))

    @property
    def samples(self) -> int:
        """How many were measured, of all sensors."""
        return int(sum((~np.isnan(e.y)).sum() for e in self.experiments))

    def squares(self, played: Sequence[Played]) -> dict[str, tuple[float, int]]:
        """Of each sensor the sum of squared residuals and the number of samples."""
        found = dict.fromkeys(self.signals, (0.0, 0))
        for one, this in zip(self.experiments, played):
            for j, name in enumerate(one.signals):
                r = this.residual[:, j]
                s, n = found[name]
                found[name] = s + float(np.nansum(r**2)), n + int((~np.isnan(r)).sum())
        return found


def stated(
    owner: str, plant: Plant, motions: Any, noise: Any, bounds: Any, start: Any
) -> tuple[OutputError, dict[str, float]]:
    """The problem that a plant's varied parameters and one motion or several pose, and the noise {signal: sigma} that
    is given; ValueError, which names `owner`, where they pose none.
    """
    plant = varied(owner, plant)
    one = isinstance(motions, (Experiment, Trajectory))
    given = (motions,) if one else in_order(f"{owner}.motions", motions, "motions")
    if not given:
        raise ValueError(f"{owner}.motions = () must hold at least one motion")
    experiments = [checked(plant, motion, f"{owner}.motions[{k}]", k) for k, motion in enumerate(given)]
    signals = tuple(dict.fromkeys(s for e in experiments for s in e.signals))
    levels = require_by_name(f"{owner}.noise", {} if noise is None else noise, signals, "signal", "positive")
    return OutputError(plant, experiments, ParameterSpace.of(owner, plant, bounds, start)), levels
