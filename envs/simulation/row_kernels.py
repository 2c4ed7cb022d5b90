"""Functions of rows as batch kernels: what the start of an episode is computed with."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.native import kernel_templates
from pliant.plants.native.batch_kernels import FEW, BatchKernel, Workspace, drawn, map_kernel
from pliant.plants.native.thread_pool import available
from pliant.plants.rounding.agreement import Draw, Reference, Trial

Array = np.ndarray


class Rows:
    """An SX function of rows: arrays (n, columns) in and out; a row's result depends on no other row."""

    LEAST, CHUNK = 8, 64  # rows of a call where there are very few, or few; many are one call on all processors

    def __init__(self, function: ca.Function, points: Draw | Sequence[Array]) -> None:
        self._from = function, points
        self._made = self._kernel(function, points)
        self._fewest, self._few = (self._made.workspace(rows) for rows in (self.LEAST, self.CHUNK))
        self._many: Workspace | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), self._from

    def _kernel(self, function: ca.Function, points: Draw | Sequence[Array]) -> BatchKernel:
        return map_kernel(function, points)

    def __call__(self, *arrays: Array, count: int = 1) -> list[Array]:
        """Outputs (n, columns); `count` is the number of steps of an iteration."""
        n, work, chunk, threads = len(arrays[0]), self._few, self.CHUNK, 1
        if n <= self.LEAST:
            work, chunk = self._fewest, self.LEAST
        elif n >= FEW:
            if self._many is None or self._many.batch != n:
                self._many = self._made.workspace(n)
            work, chunk, threads = self._many, n, available()
        found: list[list[Array]] = []
        for start in range(0, n, chunk):
            size = min(chunk, n - start)
            for array, have in zip(work.inputs, arrays):
                array[:, :size] = have[start : start + size].T
                array[:, size:] = array[:, :1]
            work.run((), count, threads)
            found.append([out[:, :size].T.copy() for out in work.outputs])
        return found[0] if len(found) == 1 else [np.concatenate(parts) for parts in zip(*found)]


class Iteration(Rows):
    """z <- z + change(z, ...), `count` times: (z, ...) -> (z, last change)."""

    def _kernel(self, function: ca.Function, points: Draw | Sequence[Array]) -> BatchKernel:
        return iteration_kernel(function, points)


def iteration_kernel(function: ca.Function, points: Draw | Sequence[Array]) -> BatchKernel:
    """`Iteration`'s, in double precision."""

    def written(numeric: Callable[..., Any] = NumericFunction) -> Reference:
        change_of = numeric(function)

        def compute(z: Array, *others: Any) -> Sequence[Array]:
            *fixed, _, count = others
            change = np.zeros_like(z)
            for _ in range(count):
                change = change_of(z, *fixed, batch=len(z))[0]
                z = z + change
            return [z, change]

        return compute

    dtype, (inputs, (nz,)) = np.dtype(float), kernel_templates._sizes(function)
    return BatchKernel(
        lambda: kernel_templates.iteration_source(function, dtype),
        written,
        (inputs, [nz, nz]),
        lambda: [Trial(written, drawn(points), count=count) for count in (1, 2)],
        dtype,
        name=f"the iteration {function.name()!r} of {function.n_instructions()} operations",
        made=(iteration_kernel, (function, points)),
    )
