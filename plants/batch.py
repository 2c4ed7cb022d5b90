"""Functions and fixed steps of a plant over a batch of lanes, on native kernels or on CasADi's virtual machine."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from . import kernels, native
from .functions import NumericFunction
from .native import Bound
from .parameters import require_choice, require_count
from .threads import available

if TYPE_CHECKING:
    from .plant import Plant

Array = np.ndarray
FEW = 512  # lanes below which a second thread costs more than it brings
CHECKED = 64  # random points at which a new kernel is compared with the virtual machine


def as_dtype(dtype: Any) -> np.dtype:
    """float64 or float32; ValueError otherwise."""
    found = np.dtype(dtype)
    require_choice("native", "dtype", found.name, ("float64", "float32"))
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
        reference: native.Reference,
        rows: tuple[Sequence[int], Sequence[int]],
        points: Sequence[Array],
        dtype: np.dtype,
        *,
        scalars: Sequence[float] = (),
        count: int = 1,
        lanes: int | None = None,
    ) -> None:
        self.dtype, self.rows, self.reference = dtype, rows, reference
        self.lanes = kernels.LANES[dtype] if lanes is None else lanes
        self.kernel = None
        if source is not None:
            self.kernel = native.load(
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


def random_points(plant: Plant, rng: np.random.Generator, batch: int = CHECKED) -> list[Array]:
    """States, inputs, disturbances and parameters (n, batch) at which a kernel is compared: moderate motions.

    Coordinates that are lengths stay within centimetres, so that mass matrices stay definite, and within less where a
    plant is so small that its equations end there.
    """
    lengths = np.array([s.unit.startswith("m") for s in plant.states])
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


def _finite(plant: Plant, *points: Array) -> bool:
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

    rows = kernels._sizes(function)
    return BatchKernel(lambda: kernels.map_source(function, dtype, lanes), reference, rows, points, dtype, lanes=lanes)


def rate_function(plant: Plant) -> ca.Function:
    """(t, x, u, w, p) -> dx/dt as one SX function."""
    return ca.Function("rate", list(plant.symbols), [ca.densify(ca.cse([plant.expressions[0]])[0])])


def step_reference(plant: Plant, method: str = "rk4") -> native.Reference:
    """count steps of scalars[0] seconds on the virtual machine."""
    from .integrate import stepper

    step = stepper(plant, method)

    def reference(t: Array, x: Array, u: Array, w: Array, p: Array, scalars: Any, count: int) -> Sequence[Array]:
        us, h = np.tile(u, (1, 3)), scalars[0]
        for _ in range(count):
            x = step(t, x, us, w, p, np.full((len(x), 1), h), batch=len(x))[0]
            t = t + h
        return [x]

    return reference


@lru_cache(maxsize=64)
def step_kernel(plant: Plant, method: str, dtype: np.dtype, lanes: int | None = None) -> BatchKernel:
    """Fixed steps of a plant: (t, x, u, w, p) -> x. The implicit midpoint rule stays on the virtual machine."""
    from .integrate import METHODS, step_map

    require_choice("stepper", "method", method, tuple(METHODS))
    rate = rate_function(plant)
    sources: dict[str, Callable[[], str]] = {
        "rk4": lambda: kernels.rk4_source(rate, dtype, lanes),
        "rosenbrock": lambda: kernels.steps_source(step_map(plant, method), dtype),
    }
    return BatchKernel(
        sources.get(method),
        step_reference(plant, method),
        (kernels._sizes(rate)[0], [plant.nx]),
        random_points(plant, np.random.default_rng(0)),
        dtype,
        scalars=(1e-4,),
        count=2,
        lanes=lanes,
    )


class Stepper:
    """Steps a batch of states by dt: `step(x, u, p) -> x`. See Plant.stepper."""

    def __init__(
        self,
        plant: Plant,
        dt: float,
        method: str,
        batch: int,
        dtype: np.dtype,
        threads: int | None,
        substeps: int,
    ) -> None:
        if not 0 < dt < np.inf:
            raise ValueError(f"stepper.dt = {dt!r} must be > 0 [s]")
        require_count("stepper", "batch", batch, 1, 10_000_000)
        require_count("stepper", "substeps", substeps, 1, 1_000_000)
        self.plant, self.dt, self.batch, self.substeps = plant, dt, batch, substeps
        self.threads = available() if threads is None else threads
        if threads is None and batch < FEW:
            self.threads = 1
        self.kernel = step_kernel(plant, method, dtype)
        self.work = self.kernel.workspace(batch)
        self.work.set(4, plant.nominal_parameters)
        self._direct: tuple[tuple[int, int], Bound] | None = None

    @property
    def native(self) -> bool:
        """Whether compiled code runs."""
        return self.kernel.native

    def __call__(
        self, x: Array, u: Any = None, p: Any = None, *, w: Any = None, t: float = 0.0, out: Array | None = None
    ) -> Array:
        """States (batch, nx) after dt, Fortran-ordered; u, p, w: (batch, n) or shared (n,), None keeps the last.

        A Fortran-ordered x (and out, which may be x) of the kernel's dtype is used in place, without a copy.
        """
        work, plant = self.work, self.plant
        if x.shape != (self.batch, plant.nx):
            raise ValueError(f"stepper.x has shape {x.shape}, must be ({self.batch}, {plant.nx})")
        for k, name, value in ((2, "u", u), (4, "p", p), (3, "w", w)):
            if value is not None:
                n = self.kernel.rows[0][k]
                if np.shape(value) not in ((n,), (self.batch, n)):
                    raise ValueError(
                        f"stepper.{name} has shape {np.shape(value)}, must be ({n},) or ({self.batch}, {n})"
                    )
                work.set(k, value)
        work.inputs[0][:] = t
        out = np.empty((self.batch, plant.nx), dtype=self.kernel.dtype, order="F") if out is None else out
        scalars, count = (self.dt / self.substeps,), self.substeps
        bound = self._in_place(x, out)
        if bound is not None:
            bound(scalars, count, self.threads)
            return out
        work.set(1, x)
        work.run(scalars, count, self.threads)
        out[:] = work.get(0)
        return out

    def _in_place(self, x: Array, out: Array) -> Bound | None:
        """A call on the caller's own arrays, where they are whole vectors in the kernel's layout."""
        kernel = self.kernel.kernel
        fits = kernel is not None and self.work.padded == self.batch
        if not (fits and all(a.dtype == self.kernel.dtype and a.flags.f_contiguous for a in (x, out))):
            return None
        key = (x.ctypes.data, out.ctypes.data)
        if self._direct is None or self._direct[0] != key:
            t, _, u, w, p = self.work.inputs
            assert kernel is not None
            self._direct = key, kernel.bind([t, x.T, u, w, p], [out.T])
        return self._direct[1]


class NativeFunction(NumericFunction):
    """A NumericFunction whose single points and batches run on a native kernel."""

    def __init__(self, function: ca.Function, points: Sequence[Array], *, matrices: bool = False) -> None:
        super().__init__(function, matrices=matrices)
        self._kernel = map_kernel(function, points)
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
            for k, value in enumerate(values):
                work.set(k, value)
            work.run(threads=available() if size >= FEW else 1)
            rows = work.all_outputs[:, :size].T.copy()  # (B, all rows); every output is a slice of its columns
        if batch is None:
            flat = rows[0]
            return [flat[a:b] if flatten else flat[a:b].reshape(c, r).T for a, b, r, c, flatten in self._plan]
        return [
            rows[:, a:b] if flatten else rows[:, a:b].reshape(size, c, r).transpose(0, 2, 1)
            for a, b, r, c, flatten in self._plan
        ]
