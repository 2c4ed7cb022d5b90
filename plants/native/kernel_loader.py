"""Batch kernels: CasADi SX functions as vectorised C over structure-of-arrays lanes, or its virtual machine instead.

A kernel is compiled once, compared at random points with what the virtual machine's operations give in extended
precision, and only then published to the cache. Without a compiler, or with PLIANT_NATIVE=0, the same calls run on the
virtual machine: slower, the same to rounding.
"""

from __future__ import annotations

import ctypes
import os
import threading
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from pliant.plants.rounding.agreement import KernelMismatch, Trial, require_agreement
from pliant.plants.toolchain import compiler_process, shared_library

from . import compiler, kernel_cache
from .compiler import CompileError, NoCompiler
from .kernel_templates import LANES
from .thread_pool import pool, spreader

Array = np.ndarray
CHECKED_AT = {np.dtype(np.float64): 16, np.dtype(np.float32): 64}  # points: two whole vectors, or more where cheap
SLOWER = "20 times slower at one state and 100 to 300 times at many"  # steps of four scenes' plants, one thread
ON, OFF, EVERY = ("", "1", "true", "yes", "on"), ("0", "false", "no", "off"), "*"
generating = threading.RLock()  # CasADi's code generation is not thread-safe; within it trials look for rows' C
_spreading = threading.Lock()
_told: set[str] = set()  # kernels that were warned of; EVERY for all


class NativeWarning(UserWarning):
    """Native code is not used for a kernel, and why; said once a kernel."""


def wanted() -> bool:
    """False where PLIANT_NATIVE=0 asks for the virtual machine. CompilerSettingError where it says something else."""
    asked = os.environ.get("PLIANT_NATIVE", "").strip().lower()
    if asked not in (*ON, *OFF):
        raise compiler_process.CompilerSettingError(
            f"PLIANT_NATIVE={os.environ['PLIANT_NATIVE']!r} must be 0 (the virtual machine alone) or 1 (compiled code)"
        )
    return asked not in OFF


def compiler_known() -> bool:
    """Whether this process, or an earlier one, has asked the compiler what it can: else nothing of it is kept."""
    if compiler.toolchain.cache_info().currsize:
        return True
    return any(compiler._stored(command) is not None for command in compiler_process.candidates())


def tell(why: str, name: str, *, every: bool = False, slower: str = SLOWER) -> None:
    """Warn, once a kernel, that native code is not used for it; once a process where that holds for every kernel."""
    key = EVERY if every else name
    if key not in _told and EVERY not in _told:
        _told.add(key)
        which = f"{name} and every other kernel" if every else name
        message = f"native code is off for {which}; the virtual machine runs, typically {slower}: {why}"
        warnings.warn(message, NativeWarning, stacklevel=4)


class Kernel:
    """One compiled `run`, or what `entry` names, called with lists of (n, B) arrays; see kernel_templates.py."""

    def __init__(self, path: Path, dtype: np.dtype, lanes: int, entry: str = "run") -> None:
        self.dtype, self.lanes, self.path = dtype, lanes, path
        (function,) = shared_library.functions(path, entry)
        pointer = ctypes.c_void_p
        function.argtypes = [ctypes.c_long] * 3 + [pointer] * 3 + [ctypes.c_long]
        function.restype = None
        self._run: Callable[..., None] = function

    def bind(self, inputs: Sequence[Array], outputs: Sequence[Array]) -> Bound:
        """Fix the arrays, so that a call costs little more than the kernel."""
        return Bound(self, inputs, outputs)

    def __call__(
        self, inputs: Sequence[Array], outputs: Sequence[Array], scalars: Sequence[float] = (), count: int = 1
    ) -> None:
        self.bind(inputs, outputs)(scalars, count)

    def on_rows(self, arrays: Array, starts: Sequence[int], inputs: int) -> None:
        """Once, on the parts of one C-ordered array (n, ld) of the kernel's numbers: `inputs` of those that begin at
        the rows `starts` are read, the others written.
        """
        lanes, size = arrays.shape[1], ctypes.sizeof(ctypes.c_void_p)
        first, row = arrays.ctypes.data, arrays.strides[0]
        places = (ctypes.c_void_p * len(starts))(*[first + row * k for k in starts])
        self._run(0, lanes, lanes, ctypes.addressof(places), ctypes.addressof(places) + size * inputs, None, 1)


class Bound:
    """A kernel with its arrays, each (n, ld) with the lanes side by side; ld a multiple of the kernel's lanes."""

    def __init__(self, kernel: Kernel, inputs: Sequence[Array], outputs: Sequence[Array]) -> None:
        self.kernel, self.arrays = kernel, (*inputs, *outputs)
        self.ld = self.arrays[0].shape[1]
        for array in self.arrays:
            whole = array.dtype == kernel.dtype and array.flags.c_contiguous and array.shape[1] == self.ld
            if not whole or self.ld % kernel.lanes:
                raise ValueError(
                    f"kernel array of {array.dtype}{array.shape} must be C-ordered {kernel.dtype}"
                    f"(n, {self.ld}), and {self.ld} a multiple of {kernel.lanes}"
                )
        self._in = (ctypes.c_void_p * max(1, len(inputs)))(*[a.ctypes.data for a in inputs])
        self._out = (ctypes.c_void_p * len(outputs))(*[a.ctypes.data for a in outputs])
        self._scalars = np.zeros(8)
        self._address = ctypes.cast(cast(Any, kernel._run), ctypes.c_void_p)
        self._fixed = (ctypes.addressof(self._in), ctypes.addressof(self._out), self._scalars.ctypes.data)

    def __call__(self, scalars: Sequence[float] = (), count: int = 1, threads: int = 1) -> None:
        for i, value in enumerate(scalars):
            self._scalars[i] = value
        run, lanes = self.kernel._run, self.kernel.lanes
        if threads <= 1 or self.ld <= lanes * threads:
            run(0, self.ld, self.ld, *self._fixed, count)
            return
        share = -(-self.ld // lanes // threads) * lanes
        spread = spreader()
        if spread is not None and _spreading.acquire(blocking=False):  # its pool serves one caller at a time
            try:
                spread(self._address, share, self.ld, *self._fixed, count)
            finally:
                _spreading.release()
            return
        waiting = [
            pool(threads).submit(run, b, min(b + share, self.ld), self.ld, *self._fixed, count)
            for b in range(share, self.ld, share)
        ]
        run(0, share, self.ld, *self._fixed, count)
        for task in waiting:
            task.result()

    def part(self, first: int, last: int, scalars: Sequence[float] = (), count: int = 1) -> None:
        """The lanes from `first` to before `last` alone, multiples of the kernel's lanes, on this thread."""
        for i, value in enumerate(scalars):
            self._scalars[i] = value
        self.kernel._run(first, last, self.ld, *self._fixed, count)


_loaded: dict[str, Kernel] = {}


def load(
    write_source: Callable[[], str],
    dtype: np.dtype,
    trials: Callable[[], Sequence[Trial]],
    *,
    name: str = "a kernel",
    lanes: int | None = None,
) -> Kernel | None:
    """The kernel from the cache, or compiled, checked by `trials` and published.

    None where native code is not wanted or not to be had: the caller then uses the virtual machine.
    """
    if not wanted():
        return None
    lanes = LANES[dtype] if lanes is None else lanes
    try:
        with generating:
            source = write_source()
            key = compiler.digest(source, compiler.toolchain())
            if key not in _loaded:
                made = kernel_cache.kept(
                    f"kernel-{key}.so",
                    lambda: compiler.build(source),
                    lambda path: Kernel(path, dtype, lanes),
                    lambda path: check(path, trials(), dtype, lanes, name),
                )
                _loaded[key] = made
            return _loaded[key]
    except NoCompiler as missing:
        tell(str(missing), name, every=True)
    except (CompileError, NotImplementedError, kernel_cache.CacheError, KernelMismatch, OSError) as failure:
        tell(str(failure), name)
    return None


def check(path: Path, trials: Sequence[Trial], dtype: np.dtype, lanes: int, name: str) -> tuple[float, float]:
    """Largest error at a point and over the points of a sound kernel, in what rounding explains; or KernelMismatch."""

    def run(trial: Trial, inputs: list[Array], results: list[Array]) -> None:
        Kernel(path, dtype, lanes, trial.entry)(inputs, results, trial.scalars, trial.count)

    return require_agreement(run, trials, dtype, CHECKED_AT[dtype], name)
