"""Functions of a plant over a batch of lanes, on native kernels or on CasADi's virtual machine."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import Any, TypeVar

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import shown
from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.rounding.agreement import Draw, Reference, Trial, Written, of_function

from . import kernel_loader, kernel_templates
from .thread_pool import available

Array = np.ndarray
P = TypeVar("P", bound=PlantLike)
FEW = 512  # lanes below which a second thread costs more than it brings
QUICK = 2400  # operations of a function that is compared at the usual number of points, a shorter one at more
CHECKED = 64  # random points that a new kernel is compared at are drawn at a time


def as_dtype(dtype: Any, owner: str = "native") -> np.dtype:
    """float64 or float32, of the type or its name, in the machine's order of bytes; ValueError otherwise."""
    try:
        found = np.dtype(dtype) if isinstance(dtype, (str, type, np.dtype)) else np.dtype(object)
    except (TypeError, ValueError, SyntaxError, RecursionError):  # what a word or a class may raise there
        found = np.dtype(object)
    if found not in (np.dtype("float64"), np.dtype("float32")):
        raise ValueError(f"{owner}.dtype = {shown(dtype)} must be one of 'float64', 'float32'")
    return found


class BatchKernel:
    """A kernel with its fall-back. `native` says which of the two runs.

    source() writes the C (None: the virtual machine always); written(NumericFunction) gives what computes the same on
    the virtual machine, of inputs (B, n) .., scalars, count, and written(arithmetic) its true value; rows gives n of
    every input and output; trials() how both are compared. A copy, here or in another process, is what `made`, a
    function and its arguments, makes there.
    """

    def __init__(
        self,
        source: Callable[[], str] | None,
        written: Written,
        rows: tuple[Sequence[int], Sequence[int]],
        trials: Callable[[], Sequence[Trial]],
        dtype: np.dtype,
        *,
        name: str,
        made: tuple[Callable[..., BatchKernel], tuple[Any, ...]],
        lanes: int | None = None,
    ) -> None:
        self.dtype, self.rows, self.written, self.trials = dtype, rows, written, trials
        self.source, self.name = source, name
        self.lanes = kernel_templates.LANES[dtype] if lanes is None else lanes
        self._made = made
        self.kernel = None
        if source is not None:
            name = name if dtype == np.float64 else f"{name} in single precision"
            self.kernel = kernel_loader.load(source, dtype, trials, name=name, lanes=self.lanes)
        if self.kernel is None:  # here, not at the first call, which may be one of several threads'
            _ = self.reference

    @cached_property
    def reference(self) -> Reference:
        """The same on the virtual machine."""
        return self.written(NumericFunction)

    def __reduce__(self) -> tuple[Any, ...]:
        return self._made

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

    def __reduce__(self) -> tuple[Any, ...]:
        return _workspace, (self.kernel, self.batch, [a.copy() for a in (*self.inputs, *self.outputs)])

    def get(self, k: int) -> Array:
        """Output k as rows (B, n); a view."""
        return self.outputs[k][:, : self.batch].T


def _workspace(kernel: BatchKernel, batch: int, arrays: Sequence[Array]) -> Workspace:
    """A workspace with these inputs and outputs, where the kernel may have other lanes than where they come from."""
    made = Workspace(kernel, batch)
    for array, value in zip((*made.inputs, *made.outputs), arrays):
        array[:, :batch] = value[:, :batch]
        array[:, batch:] = array[:, :1]
    return made


def random_points(plant: PlantLike, rng: np.random.Generator, batch: int = CHECKED) -> list[Array]:
    """States, inputs, disturbances and parameters (n, batch) at which a kernel is compared: moderate motions.

    The plant's `small_states` stay within centimetres, so that mass matrices stay definite, and within less where a
    plant is so small that its equations end there. At every other point, and at another time than 0, each value is
    smaller by up to a thousand: what is small where all are large shows there. A state that `rest_state` says is not
    zero, a rope's length, stays within an eighth of that.
    """
    small = plant.small_states
    lengths = np.array([s.name in small for s in plant.states])
    about = home(plant)[:, None]
    sizes = np.where(lengths, 0.02, 1.0)
    sizes = np.where(about[:, 0] == 0, sizes, np.minimum(sizes, np.abs(about[:, 0]) / 8))
    x = sizes[:, None] * rng.uniform(-1.0, 1.0, (plant.nx, batch))
    u, w = rng.uniform(-1.0, 1.0, (plant.nu, batch)), rng.uniform(-0.1, 0.1, (plant.nw, batch))
    p = plant.nominal_parameters[:, None] * rng.uniform(0.9, 1.1, (len(plant.varied), batch))
    t = np.zeros((1, batch))
    for a in (x, u, w):
        a[:, 1::2] *= 10.0 ** -rng.uniform(0.0, 3.0, a[:, 1::2].shape)
    t[:, 1::2] = rng.uniform(0.0, 1.0, t[:, 1::2].shape)
    if not _finite(plant, t, about + x, u, w, p):
        for _ in range(10):
            x[lengths] /= 2
            if _finite(plant, t, about + x, u, w, p):
                break
        x[lengths] /= 2
    return [t, about + x, u, w, p]


def home(plant: PlantLike) -> Array:
    """x (nx,) that points are drawn about: where the plant's own `rest_state` is not zero. Quaternions are drawn."""
    named = [index for index, state in enumerate(plant.states) if state.name not in plant.attitude_states]
    found = np.zeros(plant.nx)
    found[named] = np.asarray(plant.rest_state, dtype=float)[named]
    return found


def _finite(plant: PlantLike, *points: Array) -> bool:
    values = (np.ascontiguousarray(a.T) for a in points)
    return bool(np.isfinite(plant._dynamics(*values, batch=points[0].shape[1])[0]).all())


def drawn(points: Draw | Sequence[Array]) -> Draw:
    """Points (n, m) as what draws points."""
    return points if callable(points) else partial(_given, points)


def _given(points: Sequence[Array], rng: np.random.Generator) -> Sequence[Array]:
    order = rng.permutation(points[0].shape[1])
    return [a[:, order] for a in points]


def map_kernel(
    function: ca.Function, points: Draw | Sequence[Array], dtype: Any = np.float64, lanes: int | None = None
) -> BatchKernel:
    """An SX function once a lane, compared at points [(n, m) ..] or what draws them."""
    dtype, written = as_dtype(dtype), of_function(function)
    return BatchKernel(
        lambda: kernel_templates.map_source(function, dtype, lanes),
        written,
        kernel_templates._sizes(function),
        lambda: [Trial(written, drawn(points), times=max(1, min(8, QUICK // function.n_instructions())))],
        dtype,
        name=f"the function {function.name()!r} of {function.n_instructions()} operations",
        made=(map_kernel, (function, points, dtype, lanes)),
        lanes=lanes,
    )


class NativeFunction(NumericFunction):
    """A NumericFunction whose single points and batches run on a native kernel."""

    def __init__(self, function: ca.Function, points: Draw | Sequence[Array], *, matrices: bool = False) -> None:
        super().__init__(function, matrices=matrices)
        self._kernel, self._points = map_kernel(function, points), points
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

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(NativeFunction, matrices=self.matrices), (self._function, self._points)

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
    points = partial(random_points, plant)
    for name in names:
        slow = getattr(plant, name)
        fast.__dict__[name] = NativeFunction(slow.function, points, matrices=slow.matrices)
    return fast
