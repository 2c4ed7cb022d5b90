"""Batch kernels: CasADi SX functions as vectorised C over structure-of-arrays lanes, or its virtual machine instead.

A kernel is compiled once, compared with the virtual machine at random points, and only then published to the cache.
Without a compiler, or with PLIANT_NATIVE=0, the same calls run on the virtual machine: slower, the same to rounding.
"""

from __future__ import annotations

import ctypes
import os
import threading
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from pliant.plants.core.errors import PliantError

from . import compiler, kernel_cache
from .compiler import CompileError
from .kernel_templates import LANES
from .scalar_codegen import TooLong
from .thread_pool import pool, spreader

Array = np.ndarray
Reference = Callable[..., Sequence[Array]]  # (inputs (B, n) ..., scalars, count) -> outputs (B, m)
AGREEMENT = {np.dtype(np.float64): 1e-7, np.dtype(np.float32): 2e-2}  # of kernel and virtual machine, by the largest
generating = threading.Lock()  # CasADi's symbolics and code generation are not thread-safe
_spreading = threading.Lock()
_told = False


class NativeWarning(UserWarning):
    """Native code is not used, and why; said once a process."""


def wanted() -> bool:
    """False where PLIANT_NATIVE=0 asks for the virtual machine."""
    return os.environ.get("PLIANT_NATIVE", "1") != "0"


def tell(why: str) -> None:
    """Warn, once a process, that native code is not used."""
    global _told
    if not _told:
        _told = True
        message = f"native code is off where this holds, and the slower virtual machine runs: {why}"
        warnings.warn(message, NativeWarning, stacklevel=4)


class Kernel:
    """One compiled `run`, called with lists of (n, B) arrays; see kernel_templates.py."""

    def __init__(self, path: Path, dtype: np.dtype, lanes: int) -> None:
        self.dtype, self.lanes, self.path = dtype, lanes, path
        self._run = ctypes.CDLL(str(path)).run
        pointer = ctypes.c_void_p
        self._run.argtypes = [ctypes.c_long] * 3 + [pointer] * 3 + [ctypes.c_long]
        self._run.restype = None

    def bind(self, inputs: Sequence[Array], outputs: Sequence[Array]) -> Bound:
        """Fix the arrays, so that a call costs little more than the kernel."""
        return Bound(self, inputs, outputs)

    def __call__(
        self, inputs: Sequence[Array], outputs: Sequence[Array], scalars: Sequence[float] = (), count: int = 1
    ) -> None:
        self.bind(inputs, outputs)(scalars, count)


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
        self._address = ctypes.cast(kernel._run, ctypes.c_void_p)
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


_loaded: dict[str, Kernel] = {}


def load(
    write_source: Callable[[], str],
    dtype: np.dtype,
    reference: Reference,
    points: Sequence[Array],
    outputs: Sequence[int],
    *,
    scalars: Sequence[float] = (),
    count: int = 1,
    lanes: int | None = None,
) -> Kernel | None:
    """The kernel from the cache, or compiled, checked against `reference` at `points` (n, B) and published.

    None where native code is not wanted or not to be had: the caller then uses the virtual machine.
    outputs: rows of each output.
    """
    if not wanted():
        return None
    lanes = LANES[dtype] if lanes is None else lanes
    try:
        with generating:
            source = write_source()
            key = compiler.digest(source, compiler.toolchain())
            if key in _loaded:
                return _loaded[key]
            name = f"kernel-{key}.so"
            path = kernel_cache.path_of(name)
            if path is None:
                aside = kernel_cache.write_aside(compiler.build(source))
                try:
                    _agree(Kernel(aside, dtype, lanes), reference, points, outputs, scalars, count)
                    path = kernel_cache.publish(aside, name)
                finally:
                    aside.unlink(missing_ok=True)
            _loaded[key] = Kernel(path, dtype, lanes)
            return _loaded[key]
    except (CompileError, TooLong, kernel_cache.CacheError, KernelMismatch, OSError) as failure:
        tell(str(failure))
        return None


class KernelMismatch(PliantError):
    """A compiled kernel disagrees with the virtual machine; it was not published."""


def _agree(
    kernel: Kernel,
    reference: Reference,
    points: Sequence[Array],
    outputs: Sequence[int],
    scalars: Sequence[float],
    count: int,
) -> None:
    inputs = [np.ascontiguousarray(a, dtype=kernel.dtype) for a in points]
    results = [np.zeros((rows, inputs[0].shape[1]), dtype=kernel.dtype) for rows in outputs]
    kernel(inputs, results, scalars, count)
    wanted_ = reference(*[a.T.astype(float) for a in inputs], scalars, count)
    for i, (have, want) in enumerate(zip(results, wanted_)):
        want = np.asarray(want, dtype=float).reshape(have.shape[1], have.shape[0]).T
        size = np.abs(want)  # of a lane, but not so small that only the rounding of its inputs is compared
        scale = size.max(axis=0, keepdims=True, initial=0.0) + 1e-6 * size.max(initial=0.0) + 1e-9
        worst = float(np.max(np.abs(have - want) / scale, initial=0.0))
        if not worst < AGREEMENT[kernel.dtype]:
            raise KernelMismatch(
                f"compiled code disagrees with the virtual machine by {worst:.2g} in output {i}; "
                "it is not used (another compiler, CC=..., may do better)"
            )
