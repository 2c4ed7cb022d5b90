"""What an argument may be, and what it may not: of each kind of argument values that must be refused, or be taken.

A kind yields pairs (what it is in words, value). `bad`: nonsense; `good`: the valid value in another guise, with which
the same call must give the same result.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
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
    """An argument with a valid value. `none`: None is valid too."""

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
        yield "lists without end", endless()
        yield "an iterator that fails", Failing()

    def good(self) -> Pairs:
        """The same in another guise."""
        yield "itself", self.value


@dataclass(frozen=True)
class Choice(Kind):
    """One of a few strings. `numbers`: a number, or an array of them, is valid too."""

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
    """A public callable with a valid call. `compare`: guises of a valid value must give the same result."""

    name: str
    function: Callable[..., Any]
    kinds: dict[str, Kind]
    fixed: dict[str, Any] = field(default_factory=dict)
    positional: tuple[str, ...] = ()
    compare: bool = True
    long: bool = False  # a valid call takes long: only nonsense is tried, which is refused before


def endless() -> list[Any]:
    """A list that holds itself."""
    found: list[Any] = []
    found.append(found)
    return found
