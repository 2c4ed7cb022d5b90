"""CasADi functions of (t, x, u, w, p) called with NumPy arrays: one point, or a batch of rows."""

from __future__ import annotations

import threading

import casadi as ca
import numpy as np

MAPS_KEPT = 8  # batch sizes whose mapped function is kept
LONG = 20_000  # operations past which common subexpressions stay; no compiler is asked for as many either


class NumericFunction:
    """Evaluate a CasADi function through raw buffers, without conversions to and from DM.

    A row-major (B, n) array is CasADi's column-major (n, B) matrix, so a batch needs no transposition.
    Outputs come back as (rows,) for a column vector and (rows, columns) otherwise, with a leading B in a batch;
    with `matrices` a column vector stays (rows, 1).
    """

    def __init__(self, function: ca.Function, *, matrices: bool = False) -> None:
        self.function, self.matrices = function, matrices
        self._shapes = [function.size_out(i) for i in range(function.n_out())]
        self._squeeze = [columns == 1 and not matrices for _, columns in self._shapes]
        self._local = threading.local()

    def _buffer(self, batch: int) -> tuple:
        store = self._local.__dict__.setdefault("buffers", {})
        if batch not in store:
            if len(store) >= MAPS_KEPT:
                store.pop(next(k for k in store if k != 1))
            mapped = self.function if batch == 1 else self.function.map(batch)
            arguments = [np.zeros((batch, mapped.numel_in(i) // batch)) for i in range(mapped.n_in())]
            results = [np.zeros((batch, c, r)) for r, c in self._shapes]
            buffer, trigger = mapped.buffer()
            for i, a in enumerate(arguments):
                buffer.set_arg(i, memoryview(a))  # type: ignore[call-arg, arg-type]
            for i, r in enumerate(results):
                buffer.set_res(i, memoryview(r))  # type: ignore[call-arg, arg-type]
            store[batch] = arguments, results, trigger, buffer
        return store[batch]

    def __call__(self, *values: np.ndarray | float, batch: int | None = None) -> list[np.ndarray]:
        """Results as fresh arrays. `batch` = B where the values are (B, n) arrays; None for one point."""
        arguments, results, trigger, _ = self._buffer(batch or 1)
        for argument, value in zip(arguments, values):
            argument[...] = value
        trigger()
        out = []
        for result, squeeze in zip(results, self._squeeze):
            array = result[:, 0, :].copy() if squeeze else result.transpose(0, 2, 1).copy()
            out.append(array if batch else array[0])
        return out

    def __reduce__(self) -> tuple:
        return _rebuilt, (self.function, self.matrices)


def _rebuilt(function: ca.Function, matrices: bool) -> NumericFunction:
    return NumericFunction(function, matrices=matrices)


def function(name: str, symbols: list[ca.SX], results: list[ca.SX], *, matrices: bool = False) -> NumericFunction:
    """A NumericFunction from expressions, outputs dense and common subexpressions removed.

    Not removed from more than LONG operations: looking for them takes 12 us each, and the derivatives of expressions
    that have none repeat but a twentieth.
    """
    whole = [ca.densify(r) for r in results]
    built = ca.Function(name, symbols, whole)
    if built.n_instructions() <= LONG:
        built = ca.Function(name, symbols, ca.cse(whole))
    return NumericFunction(built, matrices=matrices)
