"""What an argument of numbers may be, and what it may not: arrays, one number, counts."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from argument_kinds import Kind, Pairs

POSITIVE: dict[str, Any] = {"low": 0.0, "open": True}  # of a Number


@dataclass(frozen=True)
class Array(Kind):
    """Real numbers of one shape. `wrong`: other lengths are nonsense."""

    wrong: bool = True
    infinite: bool = False
    finite: bool = True  # False: left to the caller
    text: bool = False  # a name is valid too
    calls: bool = False  # a function of time is valid too, as a class is
    leads: bool = False  # others must be as long as it: how long it is, is told of them

    def bad(self) -> Pairs:
        """Strings, objects, complex numbers, other shapes, not finite."""
        yield from ((what, value) for what, value in Kind.bad(self) if not (self.calls and callable(value)))
        a = np.asarray(self.value, dtype=float)
        if not self.text:
            yield "a string", "abc"
            yield "bytes", b"abc"
        yield "a string of a number", "1.5"
        yield "strings of numbers", a.astype(str).tolist() if a.ndim else "1"
        yield "an array of strings", a.astype(str)
        yield "complex", a + 1j
        yield "objects", np.full(a.shape, None, dtype=object)
        yield "dates", np.full(a.shape, np.datetime64("2026-01-01"))
        yield "masked", np.ma.masked_array(a, mask=np.ones(a.shape, bool))
        if a.size:
            if self.finite:
                yield "NaN", _with(a, np.nan)
            if self.finite and not self.infinite:
                yield "infinity", _with(a, np.inf)
                yield "minus infinity in a list", _with(a, -np.inf).tolist()
            yield "an integer beyond a float", _huge(a)
        if a.ndim and self.wrong:
            if not self.leads:
                yield "one more", np.concatenate([a, a[-1:]]) if len(a) else np.ones((1, *a.shape[1:]))
            if len(a) > 1 and not self.leads:
                yield "one less", a[:-1]
            yield "a dimension more", a[None, None]
            yield "ragged", [[1.0], [1.0, 2.0]]
            if a.ndim > 1:
                yield "one more column", np.concatenate([a, a[..., -1:]], axis=-1)
                yield "flat", a.ravel() if a.size != len(a) or (a.ndim > 1 and a.shape[0] != 1) else a[None, None]

    def good(self) -> Pairs:
        """Any layout, integers where they are, read-only, big-endian, lists and tuples."""
        a = np.asarray(self.value, dtype=float)
        yield "a list", a.tolist()
        yield "Fortran order", np.asfortranarray(a)
        yield "big-endian", a.astype(">f8")
        locked = a.copy()
        locked.setflags(write=False)
        yield "read-only", locked
        if a.ndim:
            yield "strided", np.repeat(a, 2, axis=-1)[..., ::2]
            yield "a tuple", _tuples(a)
        yield "long double", a.astype(np.longdouble)
        if (a == a.astype(np.float32)).all():
            yield "float32", a.astype(np.float32)
        if (a == np.round(a)).all() and np.abs(a).max(initial=0) < 100:
            yield "integers", a.astype(int)
            yield "a list of Python's integers", a.astype(int).tolist()
            yield "int8", a.astype(np.int8)
        yield "fractions", np.vectorize(Fraction, otypes=[object])(a) if a.size else a


@dataclass(frozen=True)
class Number(Kind):
    """One real number. `low`, `high`: what is outside is nonsense; `text`: a name is valid too.

    `array`: so is one a row.
    """

    low: float | None = None
    high: float | None = None
    open: bool = False  # `low` itself is nonsense
    infinite: bool = False
    array: bool = False
    text: bool = False

    def bad(self) -> Pairs:
        """Strings, lists, complex numbers, out of range."""
        yield from Kind.bad(self)
        if not self.text:
            yield "a string", "abc"
        yield "a string of a number", "1.5"
        yield "complex", 1.0 + 2.0j
        yield "NaN", float("nan")
        if not self.infinite:
            yield "infinity", float("inf")
            yield "an integer beyond a float", 10**400
            yield "minus an integer beyond a float", -(10**400)
        if not self.array:
            yield "a list", [float(self.value)]
            yield "an array", np.array([float(self.value)] * 2)
        yield "a date", np.datetime64("2026-01-01")
        if self.low is not None:
            yield "too small", self.low if self.open else self.low - 1.0
            yield "minus infinity", -np.inf
        if self.high is not None:
            yield "too great", self.high + 1.0

    def good(self) -> Pairs:
        """NumPy's numbers, integers and fractions."""
        v = float(self.value)
        yield "float64", np.float64(v)
        yield "an array without dimensions", np.array(v)
        yield "a fraction", Fraction(v)
        if float(np.float32(v)) == v:
            yield "float32", np.float32(v)
        if v == int(v):
            yield "an integer", int(v)
            yield "int64", np.int64(v)


@dataclass(frozen=True)
class Count(Kind):
    """An integer from `low`."""

    low: int | None = 1
    tuples: bool = False

    def bad(self) -> Pairs:
        """Fractions, strings, lists, out of range."""
        yield from Kind.bad(self)
        yield from (("a fraction", 1.5), ("a string", "abc"), ("a string of a number", "2"), ("NaN", float("nan")))
        yield from (("infinity", float("inf")), ("complex", 1j), ("True", True), ("too great", 10**30))
        yield "a list of strings", ["a"]
        if not self.tuples:
            yield "a list", [int(self.value)]
            yield "an array", np.array([1, 2])
        if self.low is not None:
            yield "too small", self.low - 1

    def good(self) -> Pairs:
        """NumPy's integers."""
        yield from (("int64", np.int64(self.value)), ("int32", np.int32(self.value)), ("uint16", np.uint16(self.value)))
        yield "an array without dimensions", np.array(int(self.value))


@dataclass(frozen=True)
class Counts(Kind):
    """A tuple of integers, of that length only where `wrong`."""

    wrong: bool = True

    def bad(self) -> Pairs:
        """Fractions, strings, another length."""
        yield from Kind.bad(self)
        yield from (("a number", 3.5), ("a string", "abc"), ("strings", ("1", "2")), ("fractions", (1.5, 2.5)))
        if self.wrong:
            yield "one more", (*self.value, 1)
        yield "NaN among them", (float("nan"),) * len(self.value)

    def good(self) -> Pairs:
        """Lists and arrays."""
        yield from (("a list", list(self.value)), ("integers", np.array(self.value)))
        yield "int64 among them", tuple(map(np.int64, self.value))


def _with(a: np.ndarray, value: float) -> np.ndarray:
    out = a.copy()
    out.flat[out.size // 2] = value
    return out


def _huge(a: np.ndarray) -> Any:
    out = a.astype(object)
    out.flat[0] = 10**400
    return out.tolist()


def _tuples(a: np.ndarray) -> Any:
    return tuple(_tuples(row) for row in a) if a.ndim > 1 else tuple(a.tolist())
