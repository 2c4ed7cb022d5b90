"""What an argument may be, and what it may not: of each kind of argument values that must be refused, or be taken.

A kind yields pairs (what it is in words, value). `bad`: nonsense; `good`: the valid value in another guise, with which
the same call must give the same result.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import casadi as ca
import numpy as np

Pairs = Iterator[tuple[str, Any]]


class Hostile:
    """An object of no use, whose repr fails."""

    def __repr__(self) -> str:
        raise RuntimeError("no repr")


class Failing:
    """What can be gone through, and fails as soon as it is."""

    def __iter__(self) -> Iterator[Any]:
        raise RuntimeError("no first")


@dataclass(frozen=True)
class Kind:
    """An argument with a valid value. `none`: None is valid too. `also`: further types that are valid, not tried."""

    value: Any
    none: bool = False

    def bad(self) -> Pairs:
        """Nonsense."""
        if not self.none:
            yield "None", None
        yield "an object", object()
        yield "an object without repr", Hostile()
        yield "a dict", {"a": 1.0}
        yield "a set", {1.0, 2.0}
        yield "a class", int
        yield "Ellipsis", ...
        yield "an expression", ca.SX.sym("a", 2)
        yield "a duration", np.timedelta64(1, "ns")
        yield "no date", np.datetime64("NaT")
        yield "an array of no number", np.array("abc")
        yield "lists without end", _endless()
        yield "an iterator that fails", Failing()

    def good(self) -> Pairs:
        """The same in another guise."""
        yield "itself", self.value


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


@dataclass(frozen=True)
class Choice(Kind):
    """One of a few strings. `also`: numbers or arrays are valid too."""

    numbers: bool = False

    def bad(self) -> Pairs:
        """Another string, another type."""
        yield from Kind.bad(self)
        yield from (("another word", "nonsense"), ("an empty word", ""), ("a list", ["nonsense"]), ("bytes", b"rk4"))
        if not self.numbers:
            yield from (("a number", 3), ("an array", np.zeros(3)), ("NaN", float("nan")))


@dataclass(frozen=True)
class Names(Kind):
    """A tuple of names of signals. `free`: any names are valid."""

    free: bool = False

    def bad(self) -> Pairs:
        """Another name, numbers, a bare word."""
        yield from Kind.bad(self)
        if not self.free:
            yield "an unknown name", ("nonsense",)
        yield from (("numbers", (1, 2)), ("a bare word", "nonsense"))
        yield from (("a number", 3), ("None among them", (None,)), ("a list of lists", [["a"]]), ("twice", ("a", "a")))

    def good(self) -> Pairs:
        """A list, an array of strings."""
        yield "a list", list(self.value)
        yield "a tuple", tuple(self.value)


@dataclass(frozen=True)
class Object(Kind):
    """An object of a type."""

    def bad(self) -> Pairs:
        """Everything else, its class among it."""
        yield from Kind.bad(self)
        yield from (("a number", 3.0), ("a string", "abc"), ("an array", np.zeros(3)), ("a list", [1, 2]))
        yield "its class", type(self.value)
        yield "a function", len


@dataclass(frozen=True)
class Objects(Object):
    """A tuple of objects of a type."""

    def bad(self) -> Pairs:
        """Everything else, a tuple of something else among it."""
        yield from Object.bad(self)
        yield "a tuple of others", (object(), 3)

    def good(self) -> Pairs:
        """A list."""
        yield "a list", list(self.value)


@dataclass(frozen=True)
class Flag(Kind):
    """True or False."""

    def bad(self) -> Pairs:
        """Anything else."""
        yield from Kind.bad(self)
        yield from (("a string", "yes"), ("two", 2), ("NaN", float("nan")), ("a list", [True]))

    def good(self) -> Pairs:
        """NumPy's."""
        yield "NumPy's", np.bool_(self.value)


@dataclass(frozen=True)
class Call:
    """A public callable with a valid call. `same`: how two results are compared, None where they are not."""

    name: str
    function: Callable[..., Any]
    kinds: dict[str, Kind]
    fixed: dict[str, Any] = field(default_factory=dict)
    positional: tuple[str, ...] = ()
    compare: bool = True
    long: bool = False  # a valid call takes long: only nonsense is tried, which is refused before


def _endless() -> list[Any]:
    found: list[Any] = []
    found.append(found)
    return found


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
