"""The parameters in a box at which a motion misses its nominal most: a lower bound, found on the nonlinear plant.

All lanes of one native step at once: corners and random points first, then steps of each parameter alone about the
best, halved where none gains. Each returned value was simulated; what lies between is not searched, so that the true
worst case may be larger.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_count, require_finite, require_instance, require_names
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays, names
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant

from .robust_stability import require_box

Array = np.ndarray
STARTS = 48
CORNERS = 5  # parameters of which all corners are tried
ROUNDS = 12
FIRST, LEAST = 0.5, 1e-3  # of a half width: steps


@dataclass(frozen=True, eq=False)
class WorstParameters(OwnsArrays):
    """At least `miss` [unit of the output] from the nominal, at `time` [s], with these parameters."""

    output: str
    miss: float
    time: float
    parameters: dict[str, float]

    @property
    def words(self) -> str:
        """What an engineer would write."""
        at = ", ".join(f"{n} = {v:.4g}" for n, v in self.parameters.items())
        return f"{self.output} misses its nominal by {self.miss:.4g} or more, at {self.time:.4g} s with {at}"


@dataclass(frozen=True, eq=False)
class MotionsInBox:
    """The motions of one plant over a box of its parameters, from one start under one input and its feedback."""

    varied: Plant
    nominal: Trajectory
    box: dict[str, tuple[float, float]]
    outputs: tuple[str, ...]
    gains: Array = field(repr=False)  # (nt, nu, nx)
    substeps: int

    def missed(self, sides: Array) -> Array:
        """Outputs less the nominal's (m, nt, len(outputs)) of sides (m, k) in [-1, 1]."""
        nominal, p = self.nominal, self.values(sides)
        step = self.varied.stepper(float(nominal.t[1] - nominal.t[0]), batch=len(p), substeps=self.substeps)
        rows = [names(self.varied.outputs).index(n) for n in self.outputs]
        x, found = np.tile(nominal.x[0], (len(p), 1)), np.zeros((len(p), len(nominal.t), len(rows)))
        for i in range(len(nominal.t)):
            u = nominal.u[i] - (x - nominal.x[i]) @ self.gains[i].T
            found[:, i] = np.asarray(self.varied.measure(x, u, p=p))[:, rows] - nominal.y[i, rows]
            if i < len(nominal.t) - 1:
                x = np.array(step(x, u, p))
            if not np.isfinite(x).all():
                raise PliantError(f"a motion within the box leaves the range of numbers with {self.substeps} substeps")
        return found

    def values(self, sides: Array) -> Array:
        """Parameters (m, k) in their units."""
        ends = np.array(list(self.box.values()))
        return np.asarray(ends.mean(axis=1) + np.ptp(ends, axis=1) / 2 * sides)

    def named(self, side: Array) -> dict[str, float]:
        """Parameters by name, of one side (k,)."""
        return dict(zip(self.box, self.values(side).tolist()))


def motions_in_box(
    owner: str, plant: Plant, nominal: Trajectory, box: object, outputs: object, gains: Any, substeps: int
) -> MotionsInBox:
    """After the gates; ValueError names owner and field."""
    plant = require_instance(f"{owner}.plant", plant, Plant)
    nominal = require_instance(f"{owner}.nominal", nominal, Trajectory)
    paths, middle, half = require_box(f"{owner}.box", box)
    seen = require_names(f"{owner}.outputs", outputs, names(plant.outputs), "output")
    substeps = require_count(owner, "substeps", substeps, 1, 10_000)
    steps = np.diff(nominal.t)
    if np.ptp(steps) > 1e-6 * steps[0]:
        raise ValueError(f"{owner}.nominal: nodes {steps.min():.4g} to {steps.max():.4g} s apart must be equal")
    shape = (len(nominal.t), plant.nu, plant.nx)
    K = np.zeros(shape) if gains is None else require_finite(f"{owner}.gains", gains, shape)
    ends = dict(zip(paths, zip((middle - half).tolist(), (middle + half).tolist())))
    return MotionsInBox(plant.vary(*paths), nominal, ends, seen, K, substeps)


def worst_parameters(
    plant: Plant,
    nominal: Trajectory,
    box: Mapping[str, tuple[float, float]],
    outputs: tuple[str, ...] | list[str],
    *,
    gains: Any = None,
    substeps: int = 10,
    seed: int = 0,
) -> dict[str, WorstParameters]:
    """By name of the output, over the motion at the nominal's nodes, which must be equally far apart.

    The plant starts as the nominal does; its inputs are the nominal's, held from node to node, less gains (nt, nu, nx)
    times what it is off, where they are given. box: {"payload.mass": (lowest, highest), ..}.
    ValueError where they are not.

    Example
    -------
    >>> worst = worst_parameters(arm, motion, {"payload.mass": (0.09, 0.11)}, ["tip_deflection"])["tip_deflection"]
    >>> print(worst.words)
    tip_deflection misses its nominal by 0.01232 or more, at 0.26 s with payload.mass = 0.09
    """
    motions = motions_in_box("worst_parameters", plant, nominal, box, outputs, gains, substeps)
    rng, k = np.random.default_rng(require_count("worst_parameters", "seed", seed, 0, 2**31)), len(motions.box)

    def missed(sides: Array) -> Array:
        return np.abs(motions.missed(sides))

    corners = np.array(list(product((-1.0, 1.0), repeat=k))) if k <= CORNERS else rng.choice((-1.0, 1.0), (STARTS, k))
    starts = np.vstack([corners, rng.uniform(-1, 1, (STARTS, k))])
    first = missed(starts)
    result = {}
    for j, name in enumerate(motions.outputs):
        largest = first[..., j].max(axis=1)
        best, value, length = starts[largest.argmax()], float(largest.max()), FIRST
        when = int(first[largest.argmax(), :, j].argmax())
        for _ in range(ROUNDS):
            tried = np.clip(np.vstack([best + length * np.eye(k), best - length * np.eye(k)]), -1, 1)
            found = missed(tried)[..., j]
            at = int(found.max(axis=1).argmax())
            if found[at].max() > value:
                best, value, when = tried[at], float(found[at].max()), int(found[at].argmax())
            elif (length := length / 2) < LEAST:
                break
        at_worst = motions.named(best)
        result[name] = WorstParameters(name, value, float(motions.nominal.t[when]), at_worst)
    return result
