"""The range in which a plant's kinematics hold, and where a motion leaves it.

A kinematics leaves something out: that slopes have a sine, that a bent link is shorter, that a pulled one is stiffer. A
`Range` names a quantity by whose size that grows, up to which size it is small, and what holds beyond. Its value is an
expression of what a motion stores, so that it costs the steps of a simulation nothing: it is computed afterwards, at
the times asked for. What happens between two of these it does not see.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import require_instance
from pliant.plants.core.errors import ValidityWarning
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.signals import Signal, names
from pliant.plants.core.trajectory import Trajectory

Array = np.ndarray


@dataclass(frozen=True)
class Range:
    """The kinematics hold while `value` (a scalar expression >= 0 in t, x, u, w, p, y) is at most `limit`."""

    quantity: str  # as in "slope of link 1"
    unit: str
    limit: float
    keeps: str  # what is true within, as in "static deflections err by less than 5 %"
    holds: str  # the kinematics that hold beyond
    value: ca.SX = field(repr=False, compare=False)
    measures: str = ""  # by which it is asked for, where it is

    def __getstate__(self) -> dict[str, Any]:
        """Without the expression, which is the plant's and travels with no pickle: a copy elsewhere has NaN."""
        return {**self.__dict__, "value": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, value=ca.SX(np.nan))

    def __deepcopy__(self, memo: Any) -> Range:
        return self


class Left(NamedTuple):
    """A range that a motion leaves: its largest value, when, and since when it is outside."""

    range: Range
    largest: float
    time: float  # [s]
    since: float  # [s]

    @property
    def words(self) -> str:
        """As in "slope of the link 0.82 rad at t = 0.44 s (holds up to 0.3 rad, left at t = 0.2 s ..)"."""
        return in_words(self.to_json())

    def to_json(self) -> dict[str, Any]:
        """Plain numbers and words, as in `Trajectory.stats["validity"]`."""
        own = self.range
        return {
            "quantity": own.quantity,
            "unit": own.unit,
            "range": [0.0, own.limit],
            "largest": self.largest,
            "time": self.time,
            "since": self.since,
            "keeps": own.keeps,
            "holds": own.holds,
        }


def in_words(entry: Mapping[str, Any]) -> str:
    """An entry of `Trajectory.stats["validity"]` as a sentence without its full stop."""
    largest, limit = entry["largest"], entry["range"][1]
    unit = "" if entry["unit"] in ("", "1") else f" {entry['unit']}"
    return (
        f"{entry['quantity']} {largest:.3g}{unit} at t = {entry['time']:.6g} s, {largest / limit:.3g} times the "
        f"{limit:.3g}{unit} up to which {entry['keeps']} (left at t = {entry['since']:.6g} s); beyond holds: "
        f"{entry['holds']}"
    )


def values(plant: PlantLike, motion: Trajectory, p: Any = None) -> np.ndarray:
    """Values (nt, n) of the plant's ranges along a motion in its own signals; NaN where they are no finite numbers."""
    for kind in ("states", "inputs", "outputs"):
        own: tuple[Signal, ...] = plant.signals[kind]
        if getattr(motion, kind) != own:
            raise ValueError(
                f"left_ranges: motion.{kind} = {', '.join(names(getattr(motion, kind)))} must be those of "
                f"{type(plant).__name__}: {', '.join(names(own))}"
            )
    return _at(plant, motion.t, motion.x, motion.u, motion.w, motion.y, p)


def _at(plant: PlantLike, t: Array, x: Array, u: Array, w: Array | None, y: Array, p: Any) -> Array:
    if not plant.validity:
        return np.zeros((len(t), 0))
    w = np.zeros(plant.nw) if w is None or not w.size else w
    p = plant.nominal_parameters if p is None else p
    with np.errstate(all="ignore"):
        return _or_nan(plant._reached(t[:, None], x, u, w, p, y, batch=len(t))[0])


def _or_nan(found: Array) -> Array:
    return np.where(np.isfinite(found), found, np.nan)


def _left(plant: PlantLike, t: Array, reached: Array) -> tuple[Left, ...]:
    found = []
    for own, column in zip(plant.validity, reached.T, strict=True):
        outside = np.flatnonzero(column > own.limit)
        if outside.size:
            k = int(np.nanargmax(column))
            found.append(Left(own, float(column[k]), float(t[k]), float(t[outside[0]])))
    return tuple(sorted(found, key=lambda a: -a.largest / a.range.limit))


def left(plant: PlantLike, motion: Trajectory, p: Any = None) -> tuple[Left, ...]:
    """The ranges that a motion leaves, the farthest (as a share of its limit) first."""
    return _left(plant, require_instance("left_ranges.motion", motion, Trajectory).t, values(plant, motion, p))


def left_along(plant: PlantLike, t: Array, x: Array) -> tuple[Left, ...]:
    """The ranges that states x (nt, nx) at the times t leave without any input."""
    u = np.zeros((len(t), plant.nu))
    return _left(plant, t, _at(plant, t, x, u, None, _outputs(plant, t, x, u, None, None), None))


def left_at(
    plant: PlantLike, t: float, x: Array, u: Array, *, w: Array | None = None, p: Any = None
) -> tuple[Left, ...]:
    """The ranges outside of which one state x (nx,) lies."""
    at = np.array([t])
    return _left(plant, at, _at(plant, at, x, u, w, _outputs(plant, t, x, u, w, p), p))


def _outputs(plant: PlantLike, t: Any, x: Array, u: Array, w: Array | None, p: Any) -> Array:
    """Outputs where some range depends on them, else zeros: they cost more than all ranges."""
    if not plant._measured_ranges:
        return np.zeros(len(plant.outputs))
    return plant.measure(x, u, w=w, p=p, t=t)


def tell(plant: PlantLike, found: Sequence[Left], stacklevel: int, what: str = "the motion") -> None:
    """Warn (ValidityWarning) of the ranges that a motion has left, all in one."""
    if found:
        warnings.warn(
            f"{what} leaves the range in which the kinematics of {type(plant).__name__} ({plant.label}) hold: "
            + "; ".join(a.words for a in found),
            ValidityWarning,
            stacklevel=stacklevel + 1,
        )


def judged(
    plant: PlantLike, motion: Trajectory, p: Any = None, *, reached: Array | None = None, stacklevel: int = 2
) -> Trajectory:
    """The motion, with what it leaves told and in its stats; `reached` (nt, n) where the values are known."""
    found = left(plant, motion, p) if reached is None else _left(plant, motion.t, _or_nan(reached))
    tell(plant, found, stacklevel + 1)
    return replace(motion, stats={**motion.stats, "validity": [a.to_json() for a in found]}) if found else motion


def reach(ranges: Sequence[Range]) -> ca.SX:
    """The largest value over its limit of all the ranges, 0 without any: above 1 outside."""
    farthest = ca.SX(0)
    for own in ranges:
        farthest = ca.fmax(farthest, own.value / own.limit)
    return farthest


def largest(rows: np.ndarray, q: ca.SX) -> ca.SX:
    """The largest |row . q| of constant rows (k, n); 0 where there are none."""
    found = ca.SX(0)
    for row in np.atleast_2d(rows):
        found = ca.fmax(found, ca.fabs(ca.dot(ca.DM(row), q)))
    return found
