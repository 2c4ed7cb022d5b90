"""The compiled library of a plant's motions: found in the cache without its C being written, or compiled and checked.

Its key is what the C is written from: the plant's equations, what writes C, and the toolchain. Writing it takes a
third of what compiling takes, its key a hundredth.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import inspect
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar, cast

import casadi as ca
import numpy as np

from pliant.plants.core import runge_kutta_tableaux
from pliant.plants.native import (
    compiler,
    expression_graph,
    kernel_cache,
    kernel_loader,
    kernel_templates,
    scalar_codegen,
    slp_codegen,
    slp_packing,
)
from pliant.plants.native.kernel_loader import compiler_known as compiler_known
from pliant.plants.rounding.agreement import KernelMismatch, Trial
from pliant.plants.toolchain import shared_library, straight_line

from . import motion_source
from .adaptive_steps import PAUSED
from .time_limit import check_time, steps_of_a_call

Array = np.ndarray
L = TypeVar("L")
LONG = np.dtype(ctypes.c_long)
DOUBLE = np.dtype(float)
A_CALL = 200_000  # steps of one native call at most, so that a long motion can be interrupted
SAMPLED = 4096  # steps for which a function of time is asked at once, at most
WRITERS: tuple[ModuleType, ...] = (
    motion_source,
    kernel_templates,
    scalar_codegen,
    slp_codegen,
    slp_packing,
    straight_line,
    expression_graph,
    runge_kutta_tableaux,
)


@functools.cache
def _writers() -> str:
    return "\n".join([ca.CasadiMeta.version(), *[inspect.getsource(module) for module in WRITERS]])


def key(equations: ca.Function, kind: str) -> str:
    """The name under which the library of `kind` of these equations is kept."""
    told = f"{kind}\n{_writers()}\n{equations.serialize()}"
    return hashlib.sha256(f"{told}\n{compiler.toolchain().key}".encode()).hexdigest()[:32]


class MotionLibrary:
    """The functions of motion_source.py in one loaded library."""

    def __init__(self, path: Path, methods: Sequence[str]) -> None:
        names = [f"motion_{method}" for method in methods]
        adaptive = ["adaptive"] if motion_source.PAIR in methods else []
        found = shared_library.functions(path, *names, *adaptive)
        self.fixed = dict(zip(methods, found))
        self.adaptive: Any = found[-1] if adaptive else None
        count, pointer = ctypes.c_long, ctypes.c_void_p
        for function in self.fixed.values():
            function.argtypes = [count, count, pointer, pointer, pointer, count, pointer, pointer, pointer, pointer]
            function.restype = count
        if self.adaptive is not None:
            self.adaptive.argtypes = [count, count, count, *[pointer] * 8]
            self.adaptive.restype = count

    def stepped(self, method: str, before: Sequence[Array], after: Sequence[Array]) -> FixedMotion:
        """A motion by fixed steps on arrays (t, counts, u), (w, p, x): see motion_source.py."""
        return FixedMotion(self.fixed[method], before, after)

    def adapted(self, arrays: Sequence[Array], settings: Sequence[float]) -> AdaptiveMotion:
        """A motion by adaptive steps on arrays (t, u, w, p, x), with the numbers s of motion_source.py."""
        return AdaptiveMotion(self.adaptive, [*arrays, np.array(settings, dtype=float)])


class FixedMotion:
    """A motion of fixed steps and its arrays."""

    def __init__(self, function: Any, before: Sequence[Array], after: Sequence[Array]) -> None:
        self._function, self._arrays = function, (*before, *after)
        self._at = np.zeros(2, dtype=LONG)
        self._before = [_place(a) for a in before]
        self._after = [_place(a) for a in (*after, self._at)]

    @property
    def place(self) -> tuple[int, int]:
        """The period and the step in it that come next."""
        return int(self._at[0]), int(self._at[1])

    def march(self, first: int, last: int) -> bool:
        """From the start of period `first` to that of `last`, the input held; False where a step is not finite."""
        self._at[:] = first, 0
        most = steps_of_a_call(A_CALL)
        while self._at[0] < last:
            check_time()
            if self._function(last, most, *self._before, 0, *self._after):
                return False
        return True

    def march_sampled(self, k: int, input_times: Sequence[float], law: Callable[[Array], Array]) -> bool:
        """Through period k under law(times) -> (times * nu,), which is asked for many steps before they are taken."""
        t, counts, fractions = self._arrays[0], self._arrays[1], np.array(input_times)
        h = (t[k + 1] - t[k]) / counts[k]
        self._at[:] = k, 0
        for i in range(0, int(counts[k]), SAMPLED):
            starts = t[k] + np.arange(i, min(i + SAMPLED, int(counts[k]))) * h
            u = np.ascontiguousarray(law((starts[:, None] + fractions * h).ravel()), dtype=float)
            ahead = max(1, u.size // len(starts))
            if self._function(k + 1, len(starts), *self._before[:2], _place(u), ahead, *self._after):
                return False
        return True


class AdaptiveMotion:
    """A motion of adaptive steps and its arrays."""

    def __init__(self, function: Any, arrays: Sequence[Array], scratch: Array | None = None) -> None:
        """scratch: what the function writes to beside."""
        self._scratch = scratch
        self._function, self._now, self._at = function, np.zeros(3), np.zeros(3, dtype=LONG)
        self._arrays = (*arrays, self._now, self._at)

    def march(self, first: int, last: int, step: float, tried: int = 0, *, restart: bool) -> int:
        """From the time of row `first` to that of `last`, begun with `step`, each period anew with `restart`; `tried`
        steps were before.

        0, or why it stopped: adaptive_steps.TOO_MANY, or TOO_SMALL a one.
        """
        self._now[1], self._at[:] = step, (first, 0, tried)
        places, status = [_place(a) for a in self._arrays], PAUSED
        most = steps_of_a_call(A_CALL)
        while status == PAUSED:
            check_time(float(self._now[0]) if self._at[2] > tried else None)
            status = int(self._function(last, most, restart, *places))
        self.time, self.step, self.trial = self._now.tolist()
        self.reached, self.tried = int(self._at[0]), int(self._at[2])
        return status


def _place(array: Array) -> int:
    """Where an array that C reads or writes begins."""
    if array.dtype not in (DOUBLE, LONG) or not array.flags.c_contiguous:
        raise ValueError(f"an array of {array.dtype}{array.shape} must be C-ordered, of doubles or C's long")
    return int(array.ctypes.data)


_loaded: dict[str, Any] = {}


def cached(name: str, load: Callable[[Path], L]) -> L | None:
    """The library kept under a name, in memory or on disk."""
    if name not in _loaded:
        path = kernel_cache.path_of(f"motion-{name}.so")
        if path is None:
            return None
        _loaded[name] = load(path)
    return cast(L, _loaded[name])


def build(
    key_of: Callable[[], str],
    load: Callable[[Path], L],
    source: Callable[[], str],
    trials: Callable[[], Sequence[Trial]],
    said: str,
    lanes: int,
) -> L | None:
    """The library kept under a key, or compiled, compared with the virtual machine and kept; None, told, where not."""
    try:
        with kernel_loader.generating:
            name = key_of()
            if name not in _loaded:
                _loaded[name] = kernel_cache.kept(
                    f"motion-{name}.so",
                    lambda: compiler.build(source()),
                    load,
                    lambda path: kernel_loader.check(path, trials(), DOUBLE, lanes, said),
                )
            return cast(L, _loaded[name])
    except compiler.NoCompiler as missing:
        kernel_loader.tell(str(missing), said, every=True)
    except (
        compiler.CompileError,
        NotImplementedError,
        kernel_cache.CacheError,
        KernelMismatch,
        OSError,
    ) as failure:
        kernel_loader.tell(str(failure), said)
    return None
