"""Which motions tell most of a plant's parameters, before any is measured.

The Fisher information of a motion, F = J'J with J = d(y/sigma)/d(theta/|theta|), is summed over its samples, unknown
starts eliminated. Criteria of optimal design (Pukelsheim, "Optimal Design of Experiments", 1993; Atkinson, Donev and
Tobias, "Optimum Experimental Designs, with SAS", 2007), each a relative standard deviation, less is better:

D   det(F)^(-1/(2 np))         of all parameters together: the volume of their confidence ellipsoid
A   sqrt(trace(F^-1)/np)       the root mean square of the parameters' own
E   lambda_min(F)^(-1/2)       along the direction that is told least
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_choice
from pliant.plants.core.errors import IntegrationError
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant
from pliant.plants.experiments.experiment import Experiment

from .fisher_information import Untold, covariance, triangle, untold
from .output_error import stated
from .parameter_space import ParameterSpace

Array = np.ndarray
CRITERIA = ("D", "A", "E")


@dataclass(frozen=True, eq=False)
class Told:
    """What one motion tells: its place among the motions given, its criteria, and the standard error of each parameter
    if it alone is measured; inf where it does not tell it.
    """

    index: int
    name: str
    criteria: Mapping[str, float]
    standard_errors: Mapping[str, float]
    unidentifiable: tuple[Untold, ...]


@dataclass(frozen=True, eq=False)
class Ranking:
    """Motions by what they tell, the best first, and what all of them tell together."""

    criterion: str
    motions: tuple[Told, ...]
    together: Told
    units: Mapping[str, str]

    @property
    def best(self) -> Told:
        """The motion that tells most."""
        return self.motions[0]

    def summary(self) -> str:
        """A table as text: a line a motion, relative criteria, standard errors of the parameters."""
        head = ["motion", *CRITERIA, *(f"{n} [{unit}]" for n, unit in self.units.items())]
        rows = [head]
        for one in (*self.motions, self.together):
            numbers = [*one.criteria.values(), *one.standard_errors.values()]
            rows.append([one.name, *("-" if not np.isfinite(v) else f"{v:.3g}" for v in numbers)])
        widths = [max(map(len, column)) for column in zip(*rows)]
        lines = ["  ".join(c.ljust(w) for c, w in zip(row, widths)).rstrip() for row in rows]
        words = [f"{one.name}: {group.words}" for one in (*self.motions, self.together) for group in one.unidentifiable]
        return "\n".join([*lines, *words])


def rank_motions(
    plant: Plant,
    motions: Experiment | Trajectory | Sequence[Experiment | Trajectory],
    *,
    noise: Mapping[str, float],
    criterion: str = "D",
    start: Mapping[str, float] | None = None,
) -> Ranking:
    """Motions ranked by what they tell of the varied parameters of a plant at its own values, or at `start`.

    plant      one that varies parameters: `plant.vary("link1.E", "payload.mass")`
    motions    a Trajectory or Experiment, or several, simulated or measured; what they measured does not count, only
               when, where from, under which inputs and by which sensors
    noise      {signal: standard deviation of a sample}, of every signal that any motion measures
    criterion  "D", "A" or "E": see this module

    Raises IntegrationError where a motion is not finite.

    >>> noise = {s.name: 1e-3 for s in arm.outputs}  # standard deviations, each in its unit
    >>> ranking = rank_motions(arm.vary("link.E"), [motion], noise=noise)
    >>> sorted(ranking.best.standard_errors)
    ['link.E']
    """
    owner = "rank_motions"
    require_choice(owner, "criterion", criterion, CRITERIA)
    problem, levels = stated(owner, plant, motions, noise, None, start)
    lacking = [s for s in problem.signals if s not in levels]
    if lacking:
        raise ValueError(f"{owner}.noise lacks {', '.join(lacking)}: each measured signal needs a standard deviation")
    space = problem.space
    found, parts = [], []
    for k, one in enumerate(problem.experiments):
        played = problem.play(problem.start, k)
        if played is None:
            raise IntegrationError(
                f"{one.name} is not finite with these parameters", float(one.t[0]), one.start, problem.steps[k]
            )
        parts.append(problem.information_of(k, played, levels))
        found.append(_told(k, one.name, parts[-1], space))
    together = triangle(np.vstack(parts))
    order = sorted(found, key=lambda one: one.criteria[criterion])
    units: dict[str, Any] = dict(zip(space.names, space.units))
    return Ranking(criterion, tuple(order), _told(-1, "all of them", together, space), units)


def criteria(R: Array) -> dict[str, float]:
    """D, A and E of F = R'R (np, np); inf where F is singular to rounding."""
    n, s = R.shape[1], np.linalg.svd(R, compute_uv=False)
    C = np.diag(covariance(R))
    if not (np.isfinite(C).all() and s[-1] > 0):
        return {"D": np.inf, "A": np.inf, "E": np.inf}
    return {"D": float(np.exp(-np.log(s).sum() / n)), "A": float(np.sqrt(C.sum() / n)), "E": float(1 / s[-1])}


def _told(index: int, name: str, R: Array, space: ParameterSpace) -> Told:
    errors = np.sqrt(np.diag(covariance(R))) * space.scale
    return Told(index, name, criteria(R), dict(zip(space.names, errors.tolist())), untold(R, space.names))
