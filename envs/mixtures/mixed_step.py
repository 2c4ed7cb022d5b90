"""The control period of lanes that play different models: those of one model side by side, in one kernel call.

A lane keeps its place for its environment. For the kernels lanes are put in order of their models, each model's from
the start of a whole vector on, the places left over filled with its first lane again: one gather of all inputs before,
one of all outputs after.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.envs.simulation.control_kernel import ControlStep, control_kernel, goal_path
from pliant.plants.native.batch_kernels import BatchKernel
from pliant.plants.native.thread_pool import pool

from .mixture import Mixture

Array = np.ndarray


class MixedStep(ControlStep):
    """As `ControlStep`, of lanes that play the model that `mixture.rung` says.

    x (nx of the widest model, lanes): what stands beyond a lane's own states has no meaning.
    """

    def __init__(self, mixture: Mixture, dtype: np.dtype, threads: int) -> None:
        self._made = mixture, dtype, threads
        self.mixture, self.scene, self.lanes, self.threads = mixture, mixture.scene, mixture.lanes, threads
        self._kernels = [control_kernel(scene, dtype) for scene in mixture.scenes]
        self._calls = [((s.dt / s.substeps,), s.substeps) for s in mixture.scenes]
        self._vector = max(kernel.lanes for kernel in self._kernels)
        rows = [[max(n) for n in zip(*(kernel.rows[k] for kernel in self._kernels))] for k in (0, 1)]
        vectors = -(-self.lanes // self._vector) + len(self._kernels)
        whole = [np.zeros((sum(n), self.lanes), dtype=dtype) for n in rows]
        ordered = [np.zeros((sum(n), vectors * self._vector), dtype=dtype) for n in rows]
        (self._inputs, self._outputs), (self._fed, self._found) = whole, ordered
        parts = [np.split(a, np.cumsum(n)[:-1]) for a, n in zip((*whole, *ordered), (*rows, *rows))]
        self.t, self.x, self.action, self.ref, self.w, self.p = parts[0]
        self._after, seen, (self.cost,), (self._margin,), (self._sound,) = parts[1]
        self.obs, self.reach = seen[:-1], seen[-1]
        self._arrays = [
            tuple([a[:n] for a, n in zip(part, sizes)] for part, sizes in zip(parts[2:], kernel.rows))
            for kernel in self._kernels
        ]
        self._bound = [k.kernel.bind(*arrays) if k.kernel else None for k, arrays in zip(self._kernels, self._arrays)]
        self._seated = np.full(self.lanes, -1)
        self._ref, self._drift = goal_path(self.scene)
        self.ref[:] = self._ref
        self.p[:] = self.scene.varied_plant.nominal_parameters[:, None]

    @property
    def native(self) -> bool:
        """Whether compiled code runs, of every model."""
        return all(kernel.native for kernel in self._kernels)

    def __getstate__(self) -> tuple[Any, list[Array]]:
        return self._made, [self._inputs.copy(), self._outputs.copy()]

    def __setstate__(self, state: tuple[Any, list[Array]]) -> None:
        made, arrays = state
        self.__init__(*made)  # type: ignore[misc]
        self._inputs[:], self._outputs[:] = arrays

    def _seat(self) -> None:
        """Where lanes stand among the kernels' columns: `_who` (columns,) lanes, `_place` (lanes,) columns."""
        rung, width = self.mixture.rung, self._vector
        self._who, self._place = np.zeros(self._fed.shape[1], dtype=np.intp), np.zeros(self.lanes, dtype=np.intp)
        self._ranges: list[tuple[int, int, int]] = []  # (model, first, last) column
        first = 0
        for g in range(len(self._kernels)):
            mine = np.flatnonzero(rung == g)
            if len(mine):
                last = first + -(-len(mine) // width) * width
                self._who[first:last] = mine[0]
                self._who[first : first + len(mine)] = mine
                self._place[mine] = first + np.arange(len(mine))
                self._ranges.append((g, first, last))
                first = last
        self._seated = rung.copy()

    def run(self) -> tuple[Array, Array]:
        """Advance all lanes; as `ControlStep.run`."""
        if not np.array_equal(self._seated, self.mixture.rung):
            self._seat()
        np.take(self._inputs, self._who, axis=1, out=self._fed, mode="clip")
        if self.threads <= 1:
            for part in self._ranges:
                self._run(*part)
        else:
            share = -(-self._ranges[-1][2] // self._vector // self.threads) * self._vector
            parts = [(g, k, min(k + share, last)) for g, first, last in self._ranges for k in range(first, last, share)]
            waiting = [pool(self.threads).submit(self._run, *part) for part in parts[1:]]
            self._run(*parts[0])
            for task in waiting:
                task.result()
        np.take(self._found, self._place, axis=1, out=self._outputs, mode="clip")
        self.x[:] = self._after
        return self._sound == 0, self._margin < 0

    def _run(self, g: int, first: int, last: int) -> None:
        bound, (inputs, outputs) = self._bound[g], self._arrays[g]
        if bound is not None:
            bound.part(first, last, *self._calls[g])
            return
        kernel: BatchKernel = self._kernels[g]
        found = kernel.reference(*[a[:, first:last].T.astype(float) for a in inputs], *self._calls[g])
        for out, value in zip(outputs, found):
            out[:, first:last] = np.asarray(value).reshape(last - first, -1).T
