"""Functions of a plant over a batch of lanes, on native kernels or on CasADi's virtual machine."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import shown
from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.plant_protocol import PlantLike

from . import kernel_loader, kernel_templates
from .thread_pool import available

Array = np.ndarray
P = TypeVar("P", bound=PlantLike)
FEW = 512  # lanes below which a second thread costs more than it brings
CHECKED = 64  # random points at which a new kernel is compared with the virtual machine


def as_dtype(dtype: Any) -> np.dtype:
    """float64 or float32; ValueError otherwise."""
    try:
        found = np.dtype(dtype) if isinstance(dtype, (str, type, np.dtype)) else np.dtype(object)
    except TypeError:
        found = np.dtype(object)
    if found not in (np.dtype("float64"), np.dtype("float32")):
        raise ValueError(f"native.dtype = {shown(dtype)} must be 'float64' or 'float32'")
    return found


class BatchKernel:
    """A kernel with its fall-back. `native` says which of the two runs.

    source() writes the C (None: the virtual machine always); reference(inputs (B, n) ..., scalars, count) computes the
    same on the virtual machine; rows gives n of every input and output; points the inputs (n, B) at which both are
    compared.
    """

    def __init__(
        self,
        source: Callable[[], str] | None,
        reference: kernel_loader.Reference,
        rows: tuple[Sequence[int], Sequence[int]],
        points: Sequence[Array],
        dtype: np.dtype,
        *,
        scalars: Sequence[float] = (),
        count: int = 1,
        lanes: int | None = None,
    ) -> None:
        self.dtype, self.rows, self.reference = dtype, rows, reference
        self.lanes = kernel_templates.LANES[dtype] if lanes is None else lanes
        self.kernel = None
        if source is not None:
            self.kernel = kernel_loader.load(
                source, dtype, reference, points, rows[1], scalars=scalars, count=count, lanes=self.lanes
            )

    @property
    def native(self) -> bool:
        """Whether compiled code runs."""
        return self.kernel is not None

    def workspace(self, batch: int) -> Workspace:
        """Arrays for a batch, padded to whole vectors, and the call on them."""
        return Workspace(self, batch)


class Workspace:
    """Input and output arrays (n, lanes) of one batch size; `run()` fills the outputs from the inputs.

    The padding lanes repeat lane 0, so that a lane's result depends neither on its place nor on the batch.
    """

    def __init__(self, kernel: BatchKernel, batch: int) -> None:
        self.kernel, self.batch = kernel, batch
        self.padded = -(-batch // kernel.lanes) * kernel.lanes
        self.inputs: list[Array] = []
        self.outputs: list[Array] = []
        self.all_outputs = np.empty(0)
        for rows in kernel.rows:  # one array holds all inputs, one all outputs
            whole = np.zeros((sum(rows), self.padded), dtype=kernel.dtype)
            parts = np.split(whole, np.cumsum(rows)[:-1])
            self.inputs, self.outputs, self.all_outputs = self.outputs, parts, whole
        self._bound = kernel.kernel.bind(self.inputs, self.outputs) if kernel.kernel else None

    def set(self, k: int, value: Any) -> None:
        """Fill input k from rows (B, n), or from one row (n,) for all lanes."""
        array = self.inputs[k]
        value = np.asarray(value)
        if value.ndim < 2:
            array[:] = value.reshape(-1, 1)
        else:
            array[:, : self.batch] = value.T
            array[:, self.batch :] = array[:, :1]

    def run(self, scalars: Sequence[float] = (), count: int = 1, threads: int = 1) -> None:
        """Compute the outputs."""
        if self._bound is not None:
            self._bound(scalars, count, threads)
            return
        found = self.kernel.reference(*[a.T.astype(float) for a in self.inputs], scalars, count)
        for out, value in zip(self.outputs, found):
            out[:] = np.asarray(value).reshape(self.padded, -1).T

    def get(self, k: int) -> Array:
        """Output k as rows (B, n); a view."""
        return self.outputs[k][:, : self.batch].T


def random_points(plant: PlantLike, rng: np.random.Generator, batch: int = CHECKED) -> list[Array]:
    """States, inputs, disturbances and parameters (n, batch) at which a kernel is compared: moderate motions.

    The plant's `small_states` stay within centimetres, so that mass matrices stay definite, and within less where a
    plant is so small that its equations end there.
    """
    small = plant.small_states
    lengths = np.array([s.name in small for s in plant.states])
    x = np.where(lengths, 0.02, 1.0)[:, None] * rng.uniform(-1.0, 1.0, (plant.nx, batch))
    u, w = rng.uniform(-1.0, 1.0, (plant.nu, batch)), rng.uniform(-0.1, 0.1, (plant.nw, batch))
    p = plant.nominal_parameters[:, None] * rng.uniform(0.9, 1.1, (len(plant.varied), batch))
    t = np.zeros((1, batch))
    if not _finite(plant, t, x, u, w, p):
        for _ in range(10):
            x[lengths] /= 2
            if _finite(plant, t, x, u, w, p):
                break
        x[lengths] /= 2
    return [t, x, u, w, p]


def _finite(plant: PlantLike, *points: Array) -> bool:
    values = (np.ascontiguousarray(a.T) for a in points)
    return bool(np.isfinite(plant._dynamics(*values, batch=points[0].shape[1])[0]).all())


def map_kernel(
    function: ca.Function, points: Sequence[Array], dtype: Any = np.float64, lanes: int | None = None
) -> BatchKernel:
    """An SX function once a lane."""
    dtype = as_dtype(dtype)
    numeric = NumericFunction(function)

    def reference(*values: Any) -> Sequence[Array]:
        arrays = values[:-2]
        return [v.transpose(0, 2, 1) if v.ndim == 3 else v for v in numeric(*arrays, batch=len(arrays[0]))]

    rows = kernel_templates._sizes(function)
    return BatchKernel(
        lambda: kernel_templates.map_source(function, dtype, lanes), reference, rows, points, dtype, lanes=lanes
    )


class NativeFunction(NumericFunction):
    """A NumericFunction whose single points and batches run on a native kernel."""

    def __init__(self, function: ca.Function, points: Sequence[Array], *, matrices: bool = False) -> None:
        super().__init__(function, matrices=matrices)
        self._kernel = map_kernel(function, points)
        self._used = [k for k in range(function.n_in()) if function.numel_in(k)]
        self._work: dict[int, Workspace] = {}
        self._lock = threading.Lock()  # the workspaces are shared
        ends = np.cumsum([r * c for r, c in self._shapes]).tolist()
        self._plan = [
            (end - r * c, end, r, c, flatten) for end, (r, c), flatten in zip(ends, self._shapes, self._squeeze)
        ]

    @property
    def native(self) -> bool:
        """Whether compiled code runs."""
        return self._kernel.native

    def __call__(self, *values: Array | float, batch: int | None = None) -> list[Array]:
        if not self._kernel.native:
            return super().__call__(*values, batch=batch)
        size = batch or 1
        with self._lock:
            work = self._work.get(size)
            if work is None:
                if len(self._work) >= 8:
                    self._work.pop(next(iter(self._work)))
                work = self._work[size] = self._kernel.workspace(size)
            for k in self._used:
                work.set(k, values[k])
            work.run(threads=available() if size >= FEW else 1)
            rows = work.all_outputs[:, :size].T.copy()  # (B, all rows); every output is a slice of its columns
        if batch is None:
            flat = rows[0]
            return [flat[a:b] if flatten else flat[a:b].reshape(c, r).T for a, b, r, c, flatten in self._plan]
        return [
            rows[:, a:b] if flatten else rows[:, a:b].reshape(size, c, r).transpose(0, 2, 1)
            for a, b, r, c, flatten in self._plan
        ]


def compiled(plant: P, names: Sequence[str]) -> P:
    """A copy of a plant with these NumericFunctions, attributes by name, on native kernels."""
    fast = dataclasses.replace(plant)  # type: ignore[type-var]
    points = random_points(plant, np.random.default_rng(0))
    for name in names:
        slow = getattr(plant, name)
        fast.__dict__[name] = NativeFunction(slow.function, points, matrices=slow.matrices)
    return fast
