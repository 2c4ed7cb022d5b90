"""Fixed steps of a plant, of a batch of lanes or a whole motion, on native kernels or on the virtual machine."""

from __future__ import annotations

import copy
import inspect
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import real_array, require_flag, require_number
from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.parameters import (
    LONGEST,
    SHORTEST,
    require_allowed,
    require_choice,
    require_count,
    require_seconds,
)
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.runge_kutta_tableaux import TABLEAUS
from pliant.plants.motions import motion_source
from pliant.plants.motions.compile_rule import OnDemand
from pliant.plants.motions.motion_library import MotionLibrary
from pliant.plants.native import kernel_templates
from pliant.plants.native.batch_kernels import FEW, Array, BatchKernel, random_points
from pliant.plants.native.kernel_loader import Bound
from pliant.plants.native.thread_pool import available
from pliant.plants.rosenbrock import fixed_source, lanes_source, plant_functions, step_source, tableaux
from pliant.plants.rosenbrock.adaptive import METHOD as RODAS
from pliant.plants.rosenbrock.library import adaptive_kernel, fixed_reference
from pliant.plants.rosenbrock.plant_functions import rate_function
from pliant.plants.rounding.agreement import Reference, Trial, of_function
from pliant.plants.rounding.extended_evaluation import mover

from . import step_maps
from .step_guard import StepGuard, sound
from .step_maps import METHODS, step_map, stepper

IMPLICIT_WRITERS = (step_maps, fixed_source, step_source, tableaux, plant_functions)
POWERS, SMALL, LONGEST_TRIED = 6, 1e-6, 0.1  # finite differences that find the fastest mode, their size; a step [s]


def step_reference(plant: PlantLike, method: str = "rk4", numeric: Callable[..., Any] = NumericFunction) -> Reference:
    """count steps of scalars[0] seconds, on the virtual machine or as `numeric` has it."""
    step: Callable[..., Any]
    if numeric is NumericFunction:
        step = stepper(plant, method)
    elif METHODS[method].tableau is not None:
        step = explicit_step(plant, method, numeric)
    else:
        step = numeric(step_map(plant, method))
    taken = len(METHODS[method].input_times)

    def reference(t: Array, x: Array, u: Array, w: Array, p: Array, scalars: Any, count: int) -> Sequence[Array]:
        us, h = np.tile(u, (1, taken)), scalars[0]
        for _ in range(count):
            x = step(t, x, us, w, p, np.full((len(x), 1), h), batch=len(x))[0]
            t = t + h
        return [x]

    return reference


def explicit_step(plant: PlantLike, method: str, numeric: Callable[..., Any]) -> Callable[..., list[Array]]:
    """An explicit method's step map (t, x, u, w, p, h) -> x of a plant, the input held, from its numeric rate.

    Columns of `u` past the plant's inputs, the same again, are left out.
    """
    rate, moved, nu, tableau = numeric(rate_function(plant)), mover(numeric), plant.nu, TABLEAUS[method]()

    def step(t: Array, x: Array, us: Array, w: Array, p: Array, h: Array, batch: int) -> list[Array]:
        slopes: list[Array] = []
        for i in range(len(tableau.b) + 1):
            at = x
            for j, a in tableau.stage(i).items():
                at = moved(at + moved(h * a * slopes[j]))
            if i < len(tableau.b):
                slopes.append(rate(t + float(tableau.c[i]) * h, at, us[:, :nu], w, p, batch=batch)[0])
        return [at]

    return step


def telling_step(rate: ca.Function, points: Sequence[Array]) -> float:
    """A step [s] that shows what every stage adds: half over the fastest mode, as a few finite differences find it."""
    numeric = NumericFunction(rate)
    t, x, *rest = (np.asarray(a, dtype=float).T for a in points)
    n = len(x)
    f = numeric(t, x, *rest, batch=n)[0]
    size = np.abs(x).max(axis=0) + 1e-3
    fastest, along = 0.0, f
    for _ in range(POWERS):
        length = np.linalg.norm(along / size, axis=1, keepdims=True)
        along = along / np.where(length > 0, length, 1.0)
        along = (numeric(t, x + SMALL * along, *rest, batch=n)[0] - f) / SMALL
        fastest = np.nanmedian(np.linalg.norm(along / size, axis=1))
    return float(np.clip(0.5 / fastest, 1e-9, LONGEST_TRIED)) if np.isfinite(fastest) and fastest > 0 else LONGEST_TRIED


def step_trials(plant: PlantLike, method: str, rate: ca.Function) -> list[Trial]:
    """How a kernel of steps is checked: its rates where it has them, and two steps of which each stage matters."""
    draw = partial(random_points, plant)
    h = telling_step(rate, draw(np.random.default_rng(0)))
    implicit = METHODS[method].tableau is None
    looped = implicit and plant_functions.looped(plant)
    if looped:  # whose Jacobians are most of what comparing costs
        steps = Trial(partial(fixed_reference, plant), draw, (h,))
    else:
        steps = Trial(partial(step_reference, plant, method), draw, (h,), 2)
    return [steps] if implicit and not looped else [Trial(of_function(rate), draw, entry="rates"), steps]


@lru_cache(maxsize=64)
def step_kernel(plant: PlantLike, method: str, dtype: np.dtype, lanes: int | None = None) -> BatchKernel:
    """Fixed steps of a plant: (t, x, u, w, p) -> x. The implicit midpoint rule stays on the virtual machine."""
    require_choice("stepper", "method", method, tuple(METHODS))
    rate = rate_function(plant)
    sources: dict[str, Callable[[], str]] = {
        "rk4": lambda: kernel_templates.rk4_source(rate, dtype, lanes),
        "rk8": lambda: kernel_templates.explicit_source(rate, TABLEAUS["rk8"](), dtype, lanes),
        "rosenbrock": lambda: (
            lanes_source.steps_of(plant, dtype)
            if plant_functions.looped(plant)
            else kernel_templates.steps_source(step_map(plant, method), dtype)
        ),
    }
    return BatchKernel(
        sources.get(method),
        partial(step_reference, plant, method),
        (kernel_templates._sizes(rate)[0], [plant.nx]),
        lambda: step_trials(plant, method, rate),
        dtype,
        name=f"{method} steps of {type(plant).__name__} ({plant.label})",
        made=(step_kernel, (plant, method, dtype) if lanes is None else (plant, method, dtype, lanes)),
        lanes=lanes,
    )


@lru_cache(maxsize=64)
def motion_kernel(plant: PlantLike, method: str) -> OnDemand[MotionLibrary] | None:
    """Whole motions of a plant by a method, all explicit ones together; None for what has no compiled form."""
    if method in motion_source.EXPLICIT[1:]:
        return motion_kernel(plant, motion_source.EXPLICIT[0])  # the same one
    if method in motion_source.EXPLICIT:
        times = {name: METHODS[name].input_times for name in motion_source.EXPLICIT}

        def source() -> str:
            return motion_source.explicit_source(rate_function(plant), times)
    elif method in motion_source.IMPLICIT:

        def source() -> str:
            if plant_functions.looped(plant):
                return fixed_source.motions_of(plant, method)
            return motion_source.implicit_source(step_map(plant, method))
    else:
        return None
    methods = motion_source.EXPLICIT if method in motion_source.EXPLICIT else (method,)

    def compiled() -> list[ca.Function]:
        if len(methods) == 1 and not plant_functions.looped(plant):
            return [step_map(plant, method)]
        rates = [plant._dynamics._function]
        return rates if len(methods) > 1 else [*rates, plant_functions.directional_function(plant)]

    return OnDemand(
        lambda: ca.Function("rate", list(plant.symbols), [plant.expressions[0]]),
        lambda: sum(f.n_instructions() for f in compiled()),
        "explicit" if len(methods) > 1 else "\n".join(map(inspect.getsource, IMPLICIT_WRITERS)),
        lambda path: MotionLibrary(path, methods),
        source,
        lambda: motion_trials(plant, methods),
        f"motions of {type(plant).__name__} ({plant.label}) by {' and '.join(methods)}",
    )


def compile_motions(plant: PlantLike, coming: float, method: str = motion_source.EXPLICIT[0]) -> bool:
    """Compile what `simulate` plays a method by, all explicit ones together, where `coming` seconds of motions pay;
    whether it is there.
    """
    kernel: OnDemand[Any] | None = adaptive_kernel(plant) if method == RODAS else motion_kernel(plant, method)
    return kernel is not None and kernel.library(coming) is not None


def motion_trials(plant: PlantLike, methods: Sequence[str]) -> list[Trial]:
    """How a library of motions is checked: the rates once, and steps by every method."""
    found: dict[str, Trial] = {}
    for method in methods:
        for trial in step_trials(plant, method, rate_function(plant)):
            own = trial if trial.entry == "rates" else replace(trial, entry=f"steps_{method}")
            found.setdefault(own.entry, own)
    return list(found.values())


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

    def __getstate__(self) -> dict[str, Any]:
        """A copy of any kind goes on as this would, in memory of its own."""
        last = None if self._last is None else self._last.copy(order="K")
        own = {"work": copy.copy(self.work), "guard": copy.copy(self.guard), "_last": last, "_direct": None}
        return self.__dict__ | own

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
                if k == 4:
                    require_allowed("stepper.p", value, plant)
                work.set(k, value)
        t = t if type(t) is float else require_number("stepper.t", t, unit="s")
        work.inputs[0][:] = t
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
