"""What every controller is: something with act(t, y) -> u, and the plainest one, a constant gain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, isinf
from typing import Any, Protocol, final, runtime_checkable

import numpy as np

from pliant.plants.core.argument_gates import (
    as_number,
    real_array,
    require_finite,
    require_names,
    require_number,
    require_seconds,
    shown,
)
from pliant.plants.core.signals import OwnsArrays, as_signals, index, read_only

LARGEST = 1e150  # of a reading: its square is a number still


@runtime_checkable
class Controller(Protocol):
    """A feedback law. `act` is called once per sample, with times that increase after each `reset`."""

    @property
    def dt(self) -> float | None:
        """Sampling time [s]; None where it acts at every time of the simulation."""

    @property
    def reads(self) -> tuple[str, ...]:
        """Names of the plant's states or outputs that make up y."""

    def reset(self) -> None:
        """Forget everything since the last start."""

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """The input u (nu,) at time t [s] from the signals y (len(reads),)."""


def reading(owner: str, y: Any, size: int) -> np.ndarray:
    """y as a float array (size,) of numbers up to LARGEST, at little cost where it is one.

    ValueError names what is wrong: a shape, a NaN, or a plant that has run away so far that a law would overflow.
    """
    if type(y) is np.ndarray and y.shape == (size,) and y.dtype == float and isfinite(y.dot(y)):
        return y
    y = require_finite(owner, y, (size,))
    if size and np.abs(y).max() > LARGEST:
        i = int(np.abs(y).argmax())
        raise ValueError(f"{owner}[{i}] = {y[i]:.3g} must be within +-{LARGEST:g}")
    return y


def moment(owner: str, t: float) -> float:
    """t [s], finite."""
    if type(t) is float and isfinite(t):
        return t
    return require_number(f"{owner}.t", t, unit="s")


def pair(name: str, value: Any) -> tuple[Any, Any]:
    """(lowest, highest); ValueError where `value` is anything else."""
    if isinstance(value, np.ndarray) and value.ndim:
        value = tuple(value)
    if not isinstance(value, (tuple, list)) or len(value) != 2:
        raise ValueError(f"{name} = {shown(value)} must be a pair (lowest, highest)")
    return value[0], value[1]


def end(name: str, value: Any) -> float:
    """A number that may be infinite."""
    value = as_number(value)
    return value if isinstance(value, float) and isinf(value) else require_number(name, value)


def share(name: str, value: Any) -> float:
    """A number from 0 to below 1."""
    found = require_number(name, value)
    if not 0 <= found < 1:
        raise ValueError(f"{name} = {found!r} must be >= 0 and < 1")
    return found


def ends(name: str, value: Any) -> tuple[float, float]:
    """A pair of numbers, lowest < highest."""
    low, high = (end(name, one) for one in pair(name, value))
    if not low < high:
        raise ValueError(f"{name} = ({low!r}, {high!r}) must be lowest < highest")
    return low, high


def each(name: str, value: Any, n: int) -> np.ndarray:
    """One number for all, or one for each: (n,), which may be infinite."""
    array = real_array(name, value)
    if array.shape not in ((), (n,)):
        raise ValueError(f"{name} has shape {array.shape}, must be a number or ({n},)")
    if np.isnan(array).any():
        raise ValueError(f"{name} = {shown(value)} must be numbers, has NaN")
    return np.broadcast_to(array, (n,))


def saturation(owner: str, limits: Any, inputs: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """(lowest, highest) (nu,) from None, a pair (lowest, highest) of numbers or arrays, or {input: (lowest,
    highest)}.

    An input without a limit gets infinity. ValueError unless lowest < highest.
    """
    low, high = np.full(len(inputs), -np.inf), np.full(len(inputs), np.inf)
    if isinstance(limits, Mapping):
        signals = as_signals(f"{owner}.inputs", inputs, len(inputs), "u")
        for name, value in limits.items():
            i = index(signals, name, f"{owner}.limits: input")
            own = f"{owner}.limits[{name!r}]"
            low[i], high[i] = (end(own, one) for one in pair(own, value))
    elif limits is not None:
        low, high = (each(f"{owner}.limits", one, len(inputs)).copy() for one in pair(f"{owner}.limits", limits))
    for i, name in enumerate(inputs):
        if not low[i] < high[i]:
            raise ValueError(f"{owner}.limits of {name} = ({low[i]:g}, {high[i]:g}) must be lowest < highest")
    return low, high


@final
@dataclass(frozen=True, eq=False)
class Feedback(OwnsArrays):
    """u = u_ref - K (y - y_ref), within `limits` = (lowest, highest) where given."""

    K: np.ndarray  # (nu, ny)
    reads: tuple[str, ...]  # (ny,) names
    y_ref: np.ndarray | None = None  # (ny,), zero where None
    u_ref: np.ndarray | None = None  # (nu,), zero where None
    limits: Any = None
    dt: float | None = None

    def __post_init__(self) -> None:
        reads = require_names("Feedback.reads", self.reads)
        K = read_only("Feedback.K", self.K, (-1, -1))
        if K.shape[1] != len(reads):
            raise ValueError(f"Feedback.K has shape {K.shape}, must have a column for each of reads = {reads}")
        nu, ny = K.shape
        values = {
            "K": K,
            "reads": reads,
            "y_ref": read_only("Feedback.y_ref", np.zeros(ny) if self.y_ref is None else self.y_ref, (ny,)),
            "u_ref": read_only("Feedback.u_ref", np.zeros(nu) if self.u_ref is None else self.u_ref, (nu,)),
            "limits": saturation("Feedback", self.limits, [f"u{i + 1}" for i in range(nu)]),
        }
        if self.dt is not None:
            values["dt"] = require_seconds("Feedback.dt", self.dt)
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def reset(self) -> None:
        """Nothing to forget."""

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,)."""
        y = reading("Feedback.y", y, len(self.reads))
        u = self.u_ref - self.K.dot(y - self.y_ref)
        return np.minimum(np.maximum(u, self.limits[0]), self.limits[1])
