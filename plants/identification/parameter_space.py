"""What is searched: the varied parameters of a plant in units of their own size, within bounds."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core import parameters
from pliant.plants.core.argument_gates import require_finite, require_mapping, require_number, shown
from pliant.plants.core.signals import names
from pliant.plants.dynamics.plant import Plant
from pliant.plants.experiments.experiment import is_plant

Array = np.ndarray
NEAREST_ZERO = 1e-4  # of its start, below which a parameter that must be positive is not tried where no bound is given


def varied(owner: str, plant: Any) -> Plant:
    """`plant` itself. ValueError where it is no plant, or varies no parameters."""
    found = is_plant(owner, plant)
    if not found.varied:
        known = ", ".join(parameters.quantities(found)[:6])
        raise ValueError(f"{owner}.plant.varied = () must name parameters: plant.vary(..) of {known} ..")
    return found


@dataclass(frozen=True, eq=False)
class ParameterSpace:
    """theta (np,): names, units, start, sizes and bounds."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    start: Array
    scale: Array
    lower: Array
    upper: Array

    @classmethod
    def of(cls, owner: str, plant: Plant, bounds: Any, start: Any) -> ParameterSpace:
        """From a plant that varies parameters; bounds {name: (low, high)}, start {name: value} or None."""
        found, p = names(plant.parameters), plant.nominal_parameters
        given = require_mapping(f"{owner}.bounds", {} if bounds is None else bounds, found, "parameter")
        begin = require_mapping(f"{owner}.start", {} if start is None else start, found, "parameter")
        low, high, scale = np.empty_like(p), np.empty_like(p), np.empty_like(p)
        for j, name in enumerate(found):
            allowed = _allowed(plant, name)
            if name in begin:
                p[j] = require_number(f"{owner}.start[{name!r}]", begin[name], allowed)
            low[j] = {"positive": NEAREST_ZERO * p[j], "nonnegative": 0.0}.get(allowed, -np.inf)
            high[j] = np.inf
            if name in given:
                label = f"{owner}.bounds[{name!r}]"
                low[j], high[j] = require_finite(label, given[name], (2,))
                require_number(f"{label}[0]", low[j], allowed)
                if not low[j] < high[j]:
                    raise ValueError(f"{label} = {shown(given[name])} must be a lower and a higher number")
                if not low[j] <= p[j] <= high[j]:
                    raise ValueError(f"{label} = {shown(given[name])} must hold the start {p[j]:g}")
            scale[j] = abs(p[j]) or (high[j] - low[j] if np.isfinite(high[j] - low[j]) else 0.0)
            if not scale[j]:
                raise ValueError(f"{owner}.start[{name!r}] = 0 must have a size: give another start, or bounds")
        return cls(found, tuple(s.unit for s in plant.parameters), p, scale, low, high)

    def tried(self, owner: str, tries: int, seed: int) -> Array:
        """(tries, np): the start, and a Latin hypercube within the bounds, by ratios where both are positive."""
        if tries == 1:
            return self.start[None]
        if not np.isfinite([self.lower, self.upper]).all():
            lacking = [n for n, a, b in zip(self.names, self.lower, self.upper) if not np.isfinite(b - a)]
            raise ValueError(f"{owner}.tries = {tries} needs bounds of {', '.join(lacking)}: they say where to start")
        rng, n = np.random.default_rng(seed), tries - 1
        cells = np.column_stack([rng.permutation(n) for _ in self.names])
        part = (cells + rng.uniform(size=cells.shape)) / n
        positive = self.lower > 0
        low, high = (np.where(positive, np.log(np.where(positive, v, 1.0)), v) for v in (self.lower, self.upper))
        points = low + part * (high - low)
        return np.vstack([self.start, np.where(positive, np.exp(np.where(positive, points, 0.0)), points)])

    def at_bound(self, p: Array) -> list[str]:
        """Names of the parameters that stand at a bound."""
        near = 1e-9 * self.scale
        return [n for n, v, a, b, e in zip(self.names, p, self.lower, self.upper, near) if v - a <= e or b - v <= e]


def _allowed(plant: Plant, path: str) -> str:
    """The range of the parameter at a dotted path: "positive", "nonnegative" or "finite"."""
    value, allowed = plant, "finite"
    for key in path.split("."):
        if dataclasses.is_dataclass(value):
            about = next(f for f in dataclasses.fields(value) if f.name == key).metadata
            allowed = about.get("allowed", allowed)
        value = parameters.get(value, key)
    return allowed
