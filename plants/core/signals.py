"""Named signals with units; how an input given as a number, an array or a function of time is sampled; own arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, Self

import numpy as np

from .argument_gates import in_order, real_array, require_instance, shown
from .parameters import require_finite

GAUSS = 0.5 + np.sqrt(3.0) / 6.0 * np.array([-1.0, 1.0])  # two-point Gauss-Legendre nodes on [0, 1]

InputLike = Any  # None, (n,) constant, (nt, n) zero-order hold, or a function of time that returns (n,)


@dataclass(frozen=True)
class Signal:
    """One state, input, disturbance, output or parameter: its name and SI unit ("" where it has none)."""

    name: str
    unit: str

    def __post_init__(self) -> None:
        for field, value in (("name", self.name), ("unit", self.unit)):
            if type(value) is not str:
                require_instance(f"Signal.{field}", value, str, what="string")


@dataclass(frozen=True)
class Sensed:
    """A place for a data sheet's sensor: the device reads `scale` times the signal's unit for each of its own."""

    device: str  # "encoder", "strain gauge", "accelerometer", "gyro", "fibre-optic gyro", "star tracker", "tachometer"
    signal: str  # the output or state that it reads
    unit: str = ""  # of the reading; "" is the signal's own
    scale: float = 1.0  # [unit of the signal / unit of the device]: 1/(distance from the neutral axis) of a gauge


@dataclass(frozen=True)
class Joint:
    """An input and the one coordinate that it drives, by names of inputs and of states or outputs; where data say it,
    how far the coordinate may go and how large the input may be, each in its signal's unit.
    """

    input: str
    position: str
    rate: str
    lower: float = -math.inf
    upper: float = math.inf
    effort: float = math.inf


@dataclass(frozen=True)
class Unfelt:
    """States, of a plant or of its linear models, that may have no part in its stability."""

    groups: tuple[tuple[str, ...], ...] = ()  # left out together where the rest does not feel them
    given: tuple[str, ...] = ()  # their motion is prescribed
    stored: tuple[str, ...] = ()  # left out where nothing changes them


def per_second(unit: str) -> str:
    """The unit of a rate of something in `unit`: "rad" gives "rad/s", "rad/s" gives "rad/s^2"."""
    numerator, _, denominator = unit.rpartition("/")
    return f"{numerator}/s^2" if numerator and denominator == "s" else f"{unit}/s"


def names(signals: Sequence[Signal]) -> tuple[str, ...]:
    """The names alone."""
    return tuple(s.name for s in signals)


def index(signals: Sequence[Signal], name: str, kind: str) -> int:
    """Position of the signal called `name`; ValueError that lists the known names of this `kind`."""
    known = names(signals)
    if not isinstance(name, str) or name not in known:
        raise ValueError(f"{kind} {shown(name)} must be one of {', '.join(known) or '(there are none)'}")
    return known.index(name)


class HasRows(Protocol):
    """A linear model y = C x + D u + F w, of one point or along a motion."""

    @property
    def states(self) -> tuple[Signal, ...]: ...

    @property
    def outputs(self) -> tuple[Signal, ...]: ...

    @property
    def C(self) -> np.ndarray: ...

    @property
    def D(self) -> np.ndarray: ...

    @property
    def F(self) -> np.ndarray: ...


class Rows(NamedTuple):
    """Some of [x; y] = C x + D u + F w."""

    at: list[int]  # (n,) where they stand in [x; y]
    C: np.ndarray  # (.., n, nx)
    D: np.ndarray  # (.., n, nu)
    F: np.ndarray  # (.., n, nw)


def rows_by_name(model: HasRows, wanted: Iterable[str], kind: str = "state or output") -> Rows:
    """The named states and outputs of a linear model; a state goes before an output of the same name.

    ValueError that lists the known names of this `kind`.
    """
    at = [index(model.states + model.outputs, name, kind) for name in wanted]
    n, found = len(model.states), []
    for own, block in ((np.eye(n), model.C), (None, model.D), (None, model.F)):
        own = np.zeros((n, block.shape[-1])) if own is None else own
        whole = np.concatenate([np.broadcast_to(own, (*block.shape[:-2], *own.shape)), block], axis=-2)
        found.append(whole[..., at, :])
    return Rows(at, *found)


def as_signals(owner: str, given: Sequence[str | Signal] | None, n: int | None, prefix: str) -> tuple[Signal, ...]:
    """`n` distinct signals from names or signals, any number where None; prefix1 .. prefixn where `given` is None."""
    if given is None and n is not None:
        return tuple(Signal(f"{prefix}{i + 1}", "") for i in range(n))
    signals = tuple(s if isinstance(s, Signal) else Signal(s, "") for s in _given_names(owner, given))
    if n is not None and len(signals) != n:
        raise ValueError(f"{owner} = {names(signals)} must be {n} names")
    if len(set(names(signals))) != len(signals):
        raise ValueError(f"{owner} = {names(signals)} must be distinct names")
    return signals


def _given_names(owner: str, given: Any) -> tuple[Any, ...]:
    found = in_order(owner, given, "a tuple of names")
    for i, item in enumerate(found):
        if not isinstance(item, (str, Signal)):
            raise ValueError(f"{owner}[{i}] = {shown(item)} must be a name or a Signal")
    return found


class Sealed(NamedTuple):
    """An array that travels write-protected: pickle forgets that."""

    array: np.ndarray


class OwnsArrays:
    """Base of what holds arrays: a copy, however it came, owns its own, write-protected where the original's are.

    What is read from shared memory or a file, by protocol 5, joblib or Ray, is else neither its own nor to be written.
    """

    def __getstate__(self) -> dict[str, Any]:
        return {name: sealed(value) for name, value in self.__dict__.items()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update({name: owned(value) for name, value in state.items()})

    def __copy__(self) -> Self:
        return deepcopy(self)  # nothing that changes is shared


def sealed(value: Any) -> Any:
    """With arrays that may not be written to, also in tuples, lists and dicts, as `Sealed`."""
    return _each(value, _seal)


def owned(value: Any) -> Any:
    """Arrays, also in tuples, lists and dicts, as own copies; those that came `Sealed` write-protected."""
    return _each(value, _open)


def _each(value: Any, made: Callable[[Any], Any]) -> Any:
    """The value with made(array) for each array in it; what holds none is left as it is."""
    if isinstance(value, (np.ndarray, Sealed)):
        return made(value)
    if type(value) is dict:
        return {key: _each(part, made) for key, part in value.items()}
    if type(value) is list:
        return [_each(part, made) for part in value]
    if isinstance(value, tuple):
        parts = [_each(part, made) for part in value]
        if all(new is old for new, old in zip(parts, value)):
            return value
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    return value


def _seal(array: np.ndarray) -> Any:
    return array if array.flags.writeable else Sealed(array)


def _open(value: Any) -> np.ndarray:
    array = np.array(value.array if isinstance(value, Sealed) else value, order="K", subok=True)
    array.setflags(write=not isinstance(value, Sealed))
    return array


def read_only(name: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    """An own, write-protected copy of `value`; ValueError unless finite and of `shape` (-1: any length)."""
    array = np.array(require_finite(name, value, shape))
    array.setflags(write=False)
    return array


def read_only_times(name: str, t: Any, fewest: int = 2) -> np.ndarray:
    """Times (nt,) [s] as a write-protected copy; ValueError unless finite and strictly increasing."""
    times = read_only(name, t, (-1,))
    if len(times) < fewest:
        raise ValueError(f"{name} has {len(times)} times, must have at least {fewest}")
    late = np.flatnonzero(np.diff(times) <= 0)
    if late.size:
        k = int(late[0])
        raise ValueError(
            f"{name}[{k + 1}] = {times[k + 1]:.9g} must be greater than {name}[{k}] = {times[k]:.9g}: "
            "times must be strictly increasing"
        )
    return times


def sample(name: str, value: InputLike, t: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """An input at the nodes (nt, n) and at two Gauss points of each interval (nt-1, 2, n).

    `value`: None (zero), (n,) constant, (nt, n) held from each node to the next, or a function of time.
    """
    if callable(value):
        at = _called(name, value, n)
        inner = t[:-1, None] + np.diff(t)[:, None] * GAUSS
        nodes = np.array([at(s) for s in t])
        return nodes, np.array([at(s) for s in inner.ravel()]).reshape(len(t) - 1, 2, n)
    if value is None:
        value = np.zeros(n)
    array = real_array(name, value)
    if array.ndim == 1 and array.shape != (n,):
        raise ValueError(f"{name} has shape {array.shape}, must be ({n},), ({len(t)}, {n}) or a function")
    nodes = np.broadcast_to(require_finite(name, array, (n,) if array.ndim == 1 else (len(t), n)), (len(t), n))
    return nodes, np.repeat(nodes[:-1, None, :], 2, axis=1)


def _called(name: str, function: Callable[[float], Any], n: int) -> Callable[[float], np.ndarray]:
    def at(s: float) -> np.ndarray:
        at = f"{name}({s:.6g})"
        return require_finite(at, np.atleast_1d(real_array(at, function(float(s)))), (n,))

    return at
