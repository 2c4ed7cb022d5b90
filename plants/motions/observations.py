"""What is seen on a motion: dx/dt and outputs at all its rows, in one native call over vectors of lanes where it pays.

After compiled steps this is most of what a motion costs: a row takes the virtual machine as long as four such steps.
"""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from functools import lru_cache, partial
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


class Observer:
    """All that `_dynamics` and `_output` of a plant give, at rows (t, x, u, w, p)."""

    def __init__(self, plant: PlantLike) -> None:
        self.plant, self._parts = plant, (plant._dynamics._function, plant._output._function)
        self._sizes_in = [self._parts[0].size1_in(k) for k in range(self._parts[0].n_in())]
        self._rows = [f.size1_out(k) for f in self._parts for k in range(f.n_out())]
        self.kernel = OnDemand(
            self._told_apart,
            lambda: sum(f.n_instructions() for f in self._parts),
            "observed",
            lambda path: Kernel(path, DOUBLE, LANES),
            lambda: kernel_templates.map_source(self._joined(), DOUBLE),
            lambda: [Trial(of_function(self._joined()), partial(random_points, plant))],
            f"rates and outputs of {type(plant).__name__} ({plant.label})",
            LANES,
        )

    def _told_apart(self) -> ca.Function:
        """What says which equations these are, without looking for what both parts have in common."""
        symbols = list(self.plant.symbols)
        return ca.Function("observed", symbols, [e for f in self._parts for e in f.call(symbols)])

    def _joined(self) -> ca.Function:
        """Both parts as one function, what they have in common computed once."""
        symbols = list(self.plant.symbols)
        both = [e for f in self._parts for e in f.call(symbols)]
        return ca.Function("observed", symbols, [ca.densify(e) for e in ca.cse(both)])

    def __call__(self, values: Sequence[Any], batch: int) -> tuple[list[Array], list[Array]]:
        """What `_dynamics` and what `_output` gives, for a batch of rows."""
        native = self.kernel.library(expected := self.kernel.seconds_of_rows(batch))
        if native is None:
            began = clock.perf_counter()
            found = self.plant._dynamics(*values, batch=batch), self.plant._output(*values, batch=batch)
            self.kernel.spent += min(clock.perf_counter() - began, 2 * expected)  # not what building them took
            return found
        lanes = -(-batch // LANES) * LANES
        inputs = [np.zeros((n, lanes)) for n in self._sizes_in]
        for array, value in zip(inputs, values):
            array[:, :batch] = np.atleast_2d(value).T
            array[:, batch:] = array[:, :1]
        outputs = [np.zeros((n, lanes)) for n in self._rows]
        native(inputs, outputs)
        results = [np.ascontiguousarray(a[:, :batch].T) for a in outputs]
        return results[: self._parts[0].n_out()], results[self._parts[0].n_out() :]


observer = lru_cache(maxsize=64)(Observer)
