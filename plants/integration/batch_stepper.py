"""Fixed steps of a plant over a batch of lanes, on native kernels or on CasADi's virtual machine."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import real_array, require_flag, require_number
from pliant.plants.core.parameters import LONGEST, SHORTEST, require_choice, require_count, require_seconds
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.runge_kutta_tableaux import TABLEAUS
from pliant.plants.native import kernel_loader, kernel_templates
from pliant.plants.native.batch_kernels import FEW, Array, BatchKernel, random_points
from pliant.plants.native.kernel_loader import Bound
from pliant.plants.native.thread_pool import available

from .step_guard import StepGuard, sound
from .step_maps import METHODS, step_map, stepper


def rate_function(plant: PlantLike) -> ca.Function:
    """(t, x, u, w, p) -> dx/dt as one SX function."""
    return ca.Function("rate", list(plant.symbols), [ca.densify(ca.cse([plant.expressions[0]])[0])])


def step_reference(plant: PlantLike, method: str = "rk4") -> kernel_loader.Reference:
    """count steps of scalars[0] seconds on the virtual machine."""
    step, taken = stepper(plant, method), len(METHODS[method].input_times)

    def reference(t: Array, x: Array, u: Array, w: Array, p: Array, scalars: Any, count: int) -> Sequence[Array]:
        us, h = np.tile(u, (1, taken)), scalars[0]
        for _ in range(count):
            x = step(t, x, us, w, p, np.full((len(x), 1), h), batch=len(x))[0]
            t = t + h
        return [x]

    return reference


@lru_cache(maxsize=64)
def step_kernel(plant: PlantLike, method: str, dtype: np.dtype, lanes: int | None = None) -> BatchKernel:
    """Fixed steps of a plant: (t, x, u, w, p) -> x. The implicit midpoint rule stays on the virtual machine."""
    require_choice("stepper", "method", method, tuple(METHODS))
    rate = rate_function(plant)
    sources: dict[str, Callable[[], str]] = {
        "rk4": lambda: kernel_templates.rk4_source(rate, dtype, lanes),
        "rk8": lambda: kernel_templates.explicit_source(rate, TABLEAUS["rk8"](), dtype, lanes),
        "rosenbrock": lambda: kernel_templates.steps_source(step_map(plant, method), dtype),
    }
    return BatchKernel(
        sources.get(method),
        step_reference(plant, method),
        (kernel_templates._sizes(rate)[0], [plant.nx]),
        random_points(plant, np.random.default_rng(0)),
        dtype,
        scalars=(1e-4,),
        count=2,
        lanes=lanes,
    )


def _numbers(name: str, value: Any) -> Array:
    """`value` itself where it is an array of floating-point numbers, of either kind."""
    return value if type(value) is np.ndarray and value.dtype.kind == "f" else real_array(name, value)


class Stepper:
    """Steps a batch of states by dt: `step(x, u, p) -> x`. See Plant.stepper."""

    def __init__(
        self,
        plant: PlantLike,
        dt: float,
        method: str,
        batch: int,
        dtype: np.dtype,
        threads: int | None,
        substeps: int,
        check: bool = True,
    ) -> None:
        dt = require_seconds("stepper.dt", dt, SHORTEST, LONGEST)
        batch = require_count("stepper", "batch", batch, 1, 10_000_000)
        substeps = require_count("stepper", "substeps", substeps, 1, 1_000_000)
        threads = threads if threads is None else require_count("stepper", "threads", threads, 1, 4096)
        check = require_flag("stepper.check", check)
        require_choice("stepper", "method", method, tuple(METHODS))
        self.plant, self.dt, self.batch, self.substeps = plant, dt, batch, substeps
        self.threads = available() if threads is None else threads
        if threads is None and batch < FEW:
            self.threads = 1
        self.kernel = step_kernel(plant, method, dtype)
        self.guard = StepGuard(plant, method, dt / substeps, check=check)
        self.work = self.kernel.workspace(batch)
        self.work.set(4, plant.nominal_parameters)
        self._direct: tuple[tuple[int, int], Bound] | None = None
        self._last: Array | None = None

    @property
    def native(self) -> bool:
        """Whether compiled code runs."""
        return self.kernel.native

    @property
    def sound(self) -> Array:
        """Which lanes (batch,) hold finite numbers, in the array that the last call gave, as it is now."""
        return np.ones(self.batch, dtype=bool) if self._last is None else sound(self._last)

    def __call__(
        self, x: Array, u: Any = None, p: Any = None, *, w: Any = None, t: float = 0.0, out: Array | None = None
    ) -> Array:
        """States (batch, nx) after dt, Fortran-ordered; u, p, w: (batch, n) or shared (n,), None keeps the last.

        A Fortran-ordered x (and out, which may be x) of the kernel's dtype is used in place, without a copy. Raises
        StabilityLimitError as `StepGuard` says. That x, u, p and w are finite is left to the caller: `sound` shows it.
        """
        work, plant = self.work, self.plant
        x = _numbers("stepper.x", x)
        if x.shape != (self.batch, plant.nx):
            raise ValueError(f"stepper.x has shape {x.shape}, must be ({self.batch}, {plant.nx})")
        for k, name, value in ((2, "u", u), (4, "p", p), (3, "w", w)):
            if value is not None:
                n, value = self.kernel.rows[0][k], _numbers(f"stepper.{name}", value)
                if value.shape not in ((n,), (self.batch, n)):
                    raise ValueError(f"stepper.{name} has shape {value.shape}, must be ({n},) or ({self.batch}, {n})")
                work.set(k, value)
        work.inputs[0][:] = t if type(t) is float else require_number("stepper.t", t, unit="s")
        self.guard.before(x, work.inputs[2].T, work.inputs[4].T[: self.batch], p is not None, t)
        out = np.empty((self.batch, plant.nx), dtype=self.kernel.dtype, order="F") if out is None else out
        scalars, count = (self.dt / self.substeps,), self.substeps
        bound = self._in_place(x, out)
        if bound is not None:
            bound(scalars, count, self.threads)
        else:
            work.set(1, x)
            work.run(scalars, count, self.threads)
            out[:] = work.get(0)
        self._last = out
        self.guard.after(out)
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
