"""A scene's control period and its rest states as batch kernels: what the single and the vector environment both run."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants import kernels
from pliant.plants.batch import BatchKernel, map_kernel, random_points, rate_function
from pliant.plants.functions import NumericFunction

from .scene import Scene
from .step import LARGEST, observe_function, reference, substep_function

Array = np.ndarray
T, X, ACTION, REF, W, P = range(6)  # inputs of the kernel
X_NEXT, OBS, COST, MARGIN, FINITE = range(5)  # its outputs


def _parts(scene: Scene) -> tuple[ca.Function, ca.Function, ca.Function]:
    """drive (action) -> u, score (x, u, ref, w, p) -> cost, sense (x, u, ref, w, p) -> (obs, margin)."""
    action = ca.SX.sym("action", scene.plant.nu)
    drive = ca.Function("drive", [action], [ca.fmax(-1.0, ca.fmin(1.0, action)) * ca.DM(scene.limits)])
    observe = observe_function(scene)
    symbols = observe.sx_in()
    obs, cost, margin = observe(*symbols)
    score = ca.Function("score", symbols, ca.cse([cost]))
    return drive, score, ca.Function("sense", symbols, ca.cse([obs, margin]))


def _reference(scene: Scene) -> Any:
    """The kernel's computation on the virtual machine."""
    drive, score, sense = (NumericFunction(f) for f in _parts(scene))
    substep = NumericFunction(substep_function(scene))

    def compute(
        t: Array, x: Array, action: Array, ref: Array, w: Array, p: Array, scalars: Any, count: int
    ) -> Sequence[Array]:
        n = len(x)
        u = drive(action, batch=n)[0]
        cost = score(x, u, ref, w, p, batch=n)[0]
        for _ in range(count):
            x = substep(x, u, w, p, batch=n)[0]
        obs, margin = sense(x, u, ref, w, p, batch=n)
        whole = np.isfinite(np.concatenate([x, obs, cost, margin], axis=1)).all(axis=1, keepdims=True)
        return [x, obs, cost, margin, whole.astype(float)]

    return compute


@lru_cache(maxsize=32)
def control_kernel(scene: Scene, dtype: np.dtype) -> BatchKernel:
    """(t, x, action, ref, w, p) -> (x_next, obs, cost, margin, finite), called with scalars (h,) and the substeps."""
    rate = rate_function(scene.varied_plant)
    drive, score, sense = _parts(scene)
    ref = reference(scene)
    t, x, _, w, p = random_points(scene.varied_plant, rng := np.random.default_rng(0))
    lanes = t.shape[1]
    action = rng.uniform(-1.5, 1.5, (scene.plant.nu, lanes))
    rows_in = [1, rate.nnz_in(1), scene.plant.nu, len(ref), rate.nnz_in(3), rate.nnz_in(4)]
    return BatchKernel(
        lambda: kernels.control_step_source(rate, drive, score, sense, dtype),
        _reference(scene),
        (rows_in, [rate.nnz_in(1), sense.nnz_out(0), 1, 1, 1]),
        [t, x, action, np.tile(ref[:, None], lanes), w, p],
        dtype,
        scalars=(scene.dt / scene.substeps / 10,),
        count=2,
    )


class ControlStep:
    """The arrays of `lanes` environments and the control period on them.

    Attributes x, action, ref, w, p are input arrays (n, lanes) to write into; obs, cost, margin outputs to read.
    The state is advanced in place.
    """

    def __init__(self, scene: Scene, lanes: int, dtype: np.dtype, threads: int) -> None:
        self.kernel = control_kernel(scene, dtype)
        self.work = self.kernel.workspace(lanes)
        self.lanes, self.threads = lanes, threads
        self._scalars, self._count = (scene.dt / scene.substeps,), scene.substeps
        work = self.work
        self.x, self.action, self.ref, self.w, self.p = (
            work.inputs[k][:, :lanes] for k in (X, ACTION, REF, W, P)
        )
        self._padding = work.padded > lanes
        work.set(REF, reference(scene))
        work.set(P, scene.varied_plant.nominal_parameters)
        work.set(X, scene.initial[0])
        self._after = work.outputs[X_NEXT]
        self.obs, self.cost = work.outputs[OBS][:, :lanes], work.outputs[COST][0, :lanes]
        self._margin, self._finite = work.outputs[MARGIN][0, :lanes], work.outputs[FINITE][0, :lanes]

    @property
    def native(self) -> bool:
        """Whether compiled code runs."""
        return self.kernel.native

    def run(self) -> tuple[Array, Array]:
        """Advance all lanes; returns (diverged, out of bounds), both (lanes,) bool.

        A diverged lane's x and obs are not to be used: the caller starts that lane again.
        """
        if self._padding:
            for array in self.work.inputs:
                array[:, self.lanes :] = array[:, :1]
        self.work.run(self._scalars, self._count, self.threads)
        after = self._after[:, : self.lanes]
        with np.errstate(all="ignore"):
            peak = np.maximum(np.abs(after).max(axis=0), np.abs(self.obs).max(axis=0))
            diverged = (self._finite == 0) | ~(peak < LARGEST)
            self.x[:] = after
            return diverged, self._margin < 0


class Rows:
    """An SX function of rows: arrays (n, columns) in and out, any n, in chunks of one compiled size."""

    CHUNK = 64

    def __init__(self, function: ca.Function, points: Sequence[Array]) -> None:
        self._work = map_kernel(function, points).workspace(self.CHUNK)

    def __call__(self, *arrays: Array) -> list[Array]:
        n, work = len(arrays[0]), self._work
        found: list[list[Array]] = []
        for start in range(0, n, self.CHUNK):
            count = min(self.CHUNK, n - start)
            for array, have in zip(work.inputs, arrays):
                array[:, :count] = have[start : start + count].T
                array[:, count:] = array[:, :1]
            work.run()
            found.append([out[:, :count].T.copy() for out in work.outputs])
        return [np.concatenate(parts) for parts in zip(*found)]
