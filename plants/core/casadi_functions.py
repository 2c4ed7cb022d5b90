"""CasADi functions of (t, x, u, w, p): called with NumPy arrays, one point or a batch of rows; built once for all equal
plants.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from functools import cached_property, wraps
from typing import Any, ClassVar, TypeVar

import casadi as ca
import numpy as np

MAPS_KEPT = 8  # batch sizes whose mapped function is kept
LONG = 20_000  # operations past which common subexpressions stay; no compiler is asked for as many either
FEW = 3000  # calls that lose what looking for common subexpressions takes: 12 us an operation, 4 ns of it lost a call
SEVERAL = 8  # rows: fewer are the virtual machine's
KEPT = 32  # plants whose properties are kept
K = TypeVar("K")
T = TypeVar("T")
_building = threading.RLock()  # expressions of equal plants are shared between threads, and must be built by one


class NumericFunction:
    """Evaluate a CasADi function through raw buffers, without conversions to and from DM.

    A row-major (B, n) array is CasADi's column-major (n, B) matrix, so a batch needs no transposition.
    Outputs come back as (rows,) for a column vector and (rows, columns) otherwise, with a leading B in a batch;
    with `matrices` a column vector stays (rows, 1). A function that is `raw` has its common subexpressions removed
    once it has been called often, or is asked for: the same operations, each done once.
    """

    rows_read: ClassVar[Any] = None  # rows_read(function)(B): what gives B rows faster than a mapped function, or None

    def __init__(self, function: ca.Function, *, matrices: bool = False, raw: bool = False) -> None:
        self._function, self.matrices, self.raw = function, matrices, raw
        self._left = FEW if raw else -1
        self._rows: Any = None  # what reads the function's instructions for many rows
        self._shapes = [function.size_out(i) for i in range(function.n_out())]
        self._squeeze = [columns == 1 and not matrices for _, columns in self._shapes]
        self._local = threading.local()

    @property
    def function(self) -> ca.Function:
        """The function itself, without common subexpressions."""
        with _building:
            if self.raw:
                symbols = self._function.sx_in()
                self._function = ca.Function(self._function.name(), symbols, ca.cse(self._function.call(symbols)))
                self.raw = False
        return self._function

    def _buffer(self, batch: int) -> tuple:
        store = self._local.__dict__.setdefault("buffers", {})
        if batch not in store:
            if len(store) >= MAPS_KEPT:
                store.pop(next(k for k in store if k != 1))
            mapped = self._function if batch == 1 else self._function.map(batch)
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
        if self.raw:
            self._left -= batch or 1
            if self._left < 0 and self.function:
                self._local.__dict__.pop("buffers", None)
                self._rows = None
        if batch is not None and batch >= SEVERAL and (found := self._read(values, batch)):
            return found
        arguments, results, trigger, _ = self._buffer(batch or 1)
        for argument, value in zip(arguments, values):
            argument[...] = value
        trigger()
        out = []
        for result, squeeze in zip(results, self._squeeze):
            array = result[:, 0, :].copy() if squeeze else result.transpose(0, 2, 1).copy()
            out.append(array if batch else array[0])
        return out

    def _read(self, values: tuple[np.ndarray | float, ...], batch: int) -> list[np.ndarray] | None:
        """The results of many rows by their instructions; None where these are not read."""
        if self.rows_read is None:
            return None
        self._rows = self._rows or self.rows_read(self._function)
        if (read := self._rows(batch)) is None:
            return None
        results = [found.reshape(batch, c, r) for found, (r, c) in zip(read(values, batch), self._shapes)]
        return [
            found[:, 0, :] if squeeze else np.ascontiguousarray(found.transpose(0, 2, 1))
            for found, squeeze in zip(results, self._squeeze)
        ]

    def __reduce__(self) -> tuple:
        return _rebuilt, (self._function, self.matrices, self.raw)


def _rebuilt(function: ca.Function, matrices: bool, raw: bool) -> NumericFunction:
    return NumericFunction(function, matrices=matrices, raw=raw)


def function(name: str, symbols: list[ca.SX], results: list[ca.SX], *, matrices: bool = False) -> NumericFunction:
    """A NumericFunction from expressions, outputs dense.

    Common subexpressions go once that pays, and never from more than LONG operations: looking for them takes 12 us
    each, and the derivatives of expressions that have none repeat but a twentieth.
    """
    built = ca.Function(name, symbols, [ca.densify(r) for r in results])
    return NumericFunction(built, matrices=matrices, raw=built.n_instructions() <= LONG)


def entries(v: ca.SX, where: slice) -> ca.SX:
    """v[where] as a column: where no entries are asked of a column of one, CasADi gives a row."""
    return v[where] if where.stop > where.start else ca.SX(0, 1)


def last_call(method: Callable[..., T]) -> Callable[..., T]:
    """A method of expressions, that gives again what it gave where it is asked for the very same ones once more."""

    @wraps(method)
    def called(self: Any, *symbols: ca.SX) -> T:
        kept = self.__dict__.get(method.__qualname__)
        if kept is None or any(a is not b for a, b in zip(kept[0], symbols, strict=True)):
            kept = self.__dict__[method.__qualname__] = symbols, method(self, *symbols)
        found: T = kept[1]
        return found

    return called


class Built(dict[K, T]):
    """What is built for a key the first time that it is asked for, by one thread."""

    def of(self, key: K, build: Callable[[], T]) -> T:
        with _building:
            if key not in self:
                self[key] = build()
        return self[key]


class built_once(cached_property[T]):
    """A cached property whose value depends on the fields of a frozen dataclass alone.

    Where an equal instance has had it built, it is taken from there, of the last KEPT different instances. A symbolic
    copy (`nominal` differs from it) builds its own: expressions have no equality.
    """

    _kept: ClassVar[OrderedDict[Any, dict[str, Any]]] = OrderedDict()

    def __get__(self, instance: Any, owner: type | None = None) -> Any:
        if instance is None or instance.nominal is not instance:
            return super().__get__(instance, owner)
        name = str(self.attrname)
        with _building:
            shared = instance.__dict__.get("_shared")
            if shared is None:  # for good: all that an instance takes must be in the same symbols
                shared = instance.__dict__["_shared"] = self._of_equals(instance)
            if name not in shared:
                shared[name] = super().__get__(instance, owner)
            taken = getattr(instance, "_taken", None)  # an instance may make its own of what is shared
            found = instance.__dict__[name] = taken(name, shared[name]) if taken else shared[name]
        return found

    @classmethod
    def has(cls, instance: Any, name: str) -> bool:
        """Whether it is built for an instance, or an equal one."""
        shared = instance.__dict__.get("_shared")
        return name in (cls._kept.get(instance, {}) if shared is None else shared)

    @classmethod
    def _of_equals(cls, instance: Any) -> dict[str, Any]:
        try:
            found = cls._kept.setdefault(instance, {})
            cls._kept.move_to_end(instance)
            if len(cls._kept) > KEPT:
                cls._kept.popitem(last=False)
        except TypeError:  # a plant with a field that has no hash
            return {}
        return found


def pattern(of: ca.SX, symbols: ca.SX) -> np.ndarray:
    """(rows, columns) which entries of a column of expressions depend on which symbols. SX in, truths out."""
    found: np.ndarray = np.array(ca.DM(ca.jacobian(of, symbols).sparsity(), 1).full(), dtype=bool)
    return found
