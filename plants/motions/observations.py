"""What is seen on a motion: dx/dt, outputs, how far its ranges are reached, and df/dx, at all its rows, in one native
call over vectors of lanes where it pays.

After compiled steps this is most of what a motion costs: a row takes the virtual machine as long as four such steps.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from itertools import accumulate
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.native import kernel_templates
from pliant.plants.native.batch_kernels import random_points
from pliant.plants.native.kernel_loader import Kernel
from pliant.plants.rounding.agreement import Trial, of_function

from .compile_rule import OnDemand

Array = np.ndarray
DOUBLE = np.dtype(float)
LANES = kernel_templates.LANES[DOUBLE]


class Rows:
    """What a CasADi function of (t, x, u, w, p) gives at many rows, in one native call where it pays.

    `function()` is written as C when it is compiled; `equations()` is what tells it apart, `count()` its operations.
    """

    def __init__(
        self,
        plant: PlantLike,
        kind: str,
        function: Callable[[], ca.Function],
        equations: Callable[[], ca.Function],
        count: Callable[[], int],
    ) -> None:
        self._sizes_in = [s.shape[0] for s in plant.symbols]
        self.kernel = OnDemand(
            equations,
            count,
            kind,
            lambda path: Kernel(path, DOUBLE, LANES),
            lambda: kernel_templates.map_source(function(), DOUBLE),
            lambda: [Trial(of_function(function()), partial(random_points, plant))],
            f"{kind} of {type(plant).__name__} ({plant.label})",
            LANES,
        )

    def __call__(
        self, values: Sequence[Any], batch: int, sizes: Sequence[int], interpreted: Callable[[], list[Array]]
    ) -> list[Array]:
        """Its outputs [(batch, n) ..] of the `sizes` n, or what `interpreted` gives, whose time counts."""
        native = self.kernel.library(expected := self.kernel.seconds_of_rows(batch))
        if native is None:
            began = clock.perf_counter()
            found = interpreted()
            self.kernel.spent += min(clock.perf_counter() - began, 2 * expected)  # not what building it took
            return found
        starts = [*accumulate((*self._sizes_in, *sizes), initial=0)]
        arrays = np.empty((starts.pop(), -(-batch // LANES) * LANES))  # in which all have their places
        for start, size, value in zip(starts, self._sizes_in, values):
            arrays[start : start + size, :batch] = np.atleast_2d(value).T
        arrays[:, batch:] = arrays[:, :1]
        native.on_rows(arrays, starts, len(self._sizes_in))
        results = arrays[starts[len(self._sizes_in)] :, :batch]
        return [np.ascontiguousarray(results[end - size : end].T) for size, end in zip(sizes, accumulate(sizes))]


class Observer:
    """All that `_dynamics`, `_output` and `_reached` of a plant give, at rows (t, x, u, w, p)."""

    def __init__(self, plant: PlantLike) -> None:
        self.plant, self._parts = plant, (plant._dynamics._function, plant._output._function)
        self._ranges = len(plant.validity)
        sizes = [f.size1_out(k) for f in self._parts for k in range(f.n_out())]
        self.sizes = [*sizes, self._ranges] if self._ranges else sizes  # of all results
        count = sum(f.n_instructions() for f in (*self._parts, *self._of_ranges()))
        self._rows = Rows(plant, "rates, outputs and ranges", self._joined, self._told_apart, lambda: count)
        self.kernel = self._rows.kernel
        self._rates, self._seen = self._parts[0].n_out(), len(sizes)

    def _of_ranges(self) -> list[ca.Function]:
        return [self.plant._reached._function] if self._ranges else []

    def _results(self) -> list[ca.SX]:
        symbols = list(self.plant.symbols)
        rates, outputs = (f.call(symbols) for f in self._parts)
        return [*rates, *outputs, *(e for f in self._of_ranges() for e in f.call([*symbols, outputs[0]]))]

    def _told_apart(self) -> ca.Function:
        """What says which equations these are, without looking for what the parts have in common."""
        return ca.Function("observed", list(self.plant.symbols), self._results())

    def _joined(self) -> ca.Function:
        """All parts as one function, what they have in common computed once."""
        both = ca.cse(self._results())
        return ca.Function("observed", list(self.plant.symbols), [ca.densify(e) for e in both])

    def __call__(self, values: Sequence[Any], batch: int) -> tuple[list[Array], list[Array], Array]:
        """What `_dynamics` and what `_output` gives, and values (batch, ranges) of `validity`, for a batch of rows."""
        plant = self.plant

        def interpreted() -> list[Array]:
            outputs = plant._output(*values, batch=batch)
            reached = plant._reached(*values, outputs[0], batch=batch) if self._ranges else []
            return [*plant._dynamics(*values, batch=batch), *outputs, *reached]

        found = self._rows(values, batch, self.sizes, interpreted)
        reached = found[-1] if self._ranges else np.zeros((batch, 0))
        return found[: self._rates], found[self._rates : self._seen], reached


class Slopes:
    """df/dx of a plant at rows (t, x, u, w, p): what a motion's steps are held against."""

    def __init__(self, plant: PlantLike) -> None:
        self.plant = plant
        self._rows = Rows(
            plant,
            "slopes",
            self._function,
            lambda: plant._dynamics._function,
            lambda: plant._jacobians._function.n_instructions(),
        )
        self.kernel = self._rows.kernel

    def _function(self) -> ca.Function:
        nx, symbols = self.plant.nx, list(self.plant.symbols)
        slopes = ca.densify(ca.cse(self.plant.slopes()[:, :nx]))
        return ca.Function("slopes", symbols, [ca.vec(slopes.T)])  # row by row

    def __call__(self, values: Sequence[Any], batch: int) -> Array:
        """(batch, nx, nx)."""
        nx = self.plant.nx

        def interpreted() -> list[Array]:
            return self.plant._jacobians(*values, batch=batch)[:1]

        return self._rows(values, batch, (nx * nx,), interpreted)[0].reshape(batch, nx, nx)


observer, slopes_at_rows = lru_cache(maxsize=64)(Observer), lru_cache(maxsize=64)(Slopes)


def compile_observations(plant: PlantLike, most: float) -> None:
    """Compile what motions of the plant are seen and held against by, each where that takes at most `most` [s]."""
    for seen in (observer(plant), slopes_at_rows(plant)):
        if seen.kernel.price <= most:
            seen.kernel.library(math.inf)
