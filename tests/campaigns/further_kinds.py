"""What else an argument may be: numbers by name, pairs, functions, words, files, and what scenes list."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
from argument_kinds import Kind, Pairs


@dataclass(frozen=True)
class ByName(Kind):
    """Numbers by name. `low`: what is below is nonsense, and so is `low` itself where `open`; `any`: no name is."""

    low: float | None = None
    open: bool = False
    any: bool = False
    number: bool = False  # one number is valid too

    def bad(self) -> Pairs:
        """Other types, unknown names, values that are no numbers."""
        name = next(iter(self.value), "nonsense")
        yield from (pair for pair in Kind.bad(self) if pair[0] != "a dict")
        yield from (("a string", "abc"), ("a list of names", [name]), ("an array of none", np.array(None)))
        if not self.number:
            yield "a number", 3.0
        if not self.any:
            yield "an unknown name", {"nonsense": 1.0}
        yield from (("a number as a name", {1: 1.0}), ("a string as a value", {name: "abc"}))
        yield from (("a number in a string", {name: "1.0"}), ("None as a value", {name: None}), ("NaN", {name: np.nan}))
        yield from (
            ("complex", {name: 1j}),
            ("infinity", {name: np.inf}),
            ("an integer beyond a float", {name: 10**400}),
        )
        yield "an array as a value", {name: np.ones(2)}
        if self.low is not None:
            yield "too small", {name: self.low if self.open else self.low - 1.0}

    def good(self) -> Pairs:
        """Another mapping, NumPy's numbers."""
        yield "a read-only mapping", MappingProxyType(dict(self.value))
        yield "NumPy's numbers", {name: np.float64(value) for name, value in self.value.items()}
        yield "arrays without dimensions", {name: np.array(value) for name, value in self.value.items()}


@dataclass(frozen=True)
class Pair(Kind):
    """(lowest, highest)."""

    def bad(self) -> Pairs:
        """One, three, strings, reversed, NaN."""
        yield from Kind.bad(self)
        low, high = self.value
        yield from (("a number", 3.0), ("a string", "ab"), ("bytes", b"ab"), ("strings", ("a", "b")))
        yield from (("one", (low,)), ("three", (low, high, high)), ("reversed", (high, low)), ("twice", (high, high)))
        yield from (("NaN", (np.nan, high)), ("complex", (1j, high)), ("numbers in strings", ("-1", "1")))
        yield from (("objects", (object(), high)), ("an integer beyond a float", (low, 10**400)))

    def good(self) -> Pairs:
        """A list, an array, NumPy's numbers."""
        yield "a list", list(self.value)
        yield "an array", np.array(self.value, dtype=float)
        yield "NumPy's numbers", tuple(np.float64(v) for v in self.value)


@dataclass(frozen=True)
class Function(Kind):
    """What can be called; a class can."""

    def bad(self) -> Pairs:
        """What cannot be called."""
        yield from (pair for pair in Kind.bad(self) if pair[0] != "a class")
        yield from (("a number", 3.0), ("a string", "abc"), ("an array", np.zeros(3)), ("a list", [1.0]))


@dataclass(frozen=True)
class Text(Kind):
    """Words; `empty`: none are words too."""

    empty: bool = False

    def bad(self) -> Pairs:
        """Other types."""
        yield from Kind.bad(self)
        yield from (("a number", 3.0), ("bytes", b"abc"), ("a list", ["abc"]), ("an array", np.zeros(3)))
        if not self.empty:
            yield "an empty word", ""

    def good(self) -> Pairs:
        """NumPy's string."""
        yield "NumPy's", np.str_(self.value)


@dataclass(frozen=True)
class Place(Kind):
    """A file or a folder."""

    def bad(self) -> Pairs:
        """Other types, no name, a name that no file has."""
        yield from Kind.bad(self)
        yield from (
            ("a number", 3),
            ("bytes", b"abc"),
            ("a list", ["abc"]),
            ("an empty word", ""),
            ("a zero byte", "a\0b"),
        )

    def good(self) -> Pairs:
        """A string, a Path."""
        yield "a string", str(self.value)
        yield "a Path", Path(self.value)


@dataclass(frozen=True)
class Valued(Kind):
    """A scene's pairs of a name and a number. `low`: as in ByName."""

    low: float | None = None
    open: bool = False

    def bad(self) -> Pairs:
        """Other types, unknown names, values that are no numbers, one name twice."""
        yield from Kind.bad(self)
        yield from (("a number", 3.0), ("a string", "abc"), ("a bare pair", ("hub_angle", 1.0)))
        (name, number), *_ = self.value
        yield from (
            ("an unknown name", (("nonsense", 1.0),)),
            ("a number as a name", ((1, 1.0),)),
            ("three", ((name, 1.0, 1.0),)),
        )
        for what, wrong in (
            ("a string", "1.0"),
            ("None", None),
            ("NaN", np.nan),
            ("infinity", np.inf),
            ("complex", 1j),
        ):
            yield f"{what} as a value", ((name, wrong),)
        yield from (("an array as a value", ((name, np.ones(2)),)), ("twice", ((name, number), (name, number))))
        yield "an integer beyond a float", ((name, 10**400),)
        if self.low is not None:
            yield "too small", ((name, self.low if self.open else self.low - 1.0),)

    def good(self) -> Pairs:
        """Lists, NumPy's numbers."""
        yield "a list of lists", [list(pair) for pair in self.value]
        yield "NumPy's numbers", tuple((name, np.float64(number)) for name, number in self.value)


@dataclass(frozen=True)
class Blocks(Kind):
    """How many steps each move is held: counts of one sum."""

    def bad(self) -> Pairs:
        """Fractions, strings, other sums."""
        yield from Kind.bad(self)
        yield from (("a number", 3), ("a string", "abc"), ("fractions", (1.5, 2.5)), ("strings", ("1", "3")))
        yield from (("zero", (0, *self.value)), ("NaN", (np.nan, 3)), ("None among them", (None, 3)))
        yield from (("one more", (*self.value, 1)), ("lists", ([1], [3])), ("True", (True, 3)), ("nothing", ()))

    def good(self) -> Pairs:
        """A list, an array of integers."""
        yield from (("a list", list(self.value)), ("an array", np.array(self.value)))
        yield "NumPy's integers", tuple(np.int32(v) for v in self.value)
