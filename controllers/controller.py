"""What every controller is: something with act(t, y) -> u, and the plainest one, a constant gain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, Protocol, final, runtime_checkable

import numpy as np

from pliant.plants.parameters import require_finite
from pliant.plants.signals import as_signals, index, read_only


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
    """y as a finite float array (size,), at little cost where it is one; ValueError names what is wrong."""
    if type(y) is np.ndarray and y.shape == (size,) and y.dtype == float and isfinite(y.dot(y)):
        return y
    return require_finite(owner, y, (size,))


def saturation(owner: str, limits: Any, inputs: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """(lowest, highest) (nu,) from None, a pair (lowest, highest) of numbers or arrays, or {input: (lowest,
    highest)}.

    An input without a limit gets infinity. ValueError unless lowest < highest.
    """
    low, high = np.full(len(inputs), -np.inf), np.full(len(inputs), np.inf)
    if isinstance(limits, Mapping):
        signals = as_signals(f"{owner}.inputs", inputs, len(inputs), "u")
        for name, (a, b) in limits.items():
            i = index(signals, name, f"{owner}.limits: input")
            low[i], high[i] = a, b
    elif limits is not None:
        if len(limits) != 2:
            raise ValueError(f"{owner}.limits = {limits!r} must be a pair (lowest, highest)")
        low[:], high[:] = limits[0], limits[1]
    for i, name in enumerate(inputs):
        if not low[i] < high[i]:
            raise ValueError(f"{owner}.limits of {name} = ({low[i]:g}, {high[i]:g}) must be lowest < highest")
    return low, high


@final
@dataclass(frozen=True, eq=False)
class Feedback:
    """u = u_ref - K (y - y_ref), within `limits` = (lowest, highest) where given."""

    K: np.ndarray  # (nu, ny)
    reads: tuple[str, ...]  # (ny,) names
    y_ref: np.ndarray | None = None  # (ny,), zero where None
    u_ref: np.ndarray | None = None  # (nu,), zero where None
    limits: Any = None
    dt: float | None = None

    def __post_init__(self) -> None:
        K = read_only("Feedback.K", self.K, (-1, len(self.reads)))
        nu, ny = K.shape
        values = {
            "K": K,
            "reads": tuple(self.reads),
            "y_ref": read_only("Feedback.y_ref", np.zeros(ny) if self.y_ref is None else self.y_ref, (ny,)),
            "u_ref": read_only("Feedback.u_ref", np.zeros(nu) if self.u_ref is None else self.u_ref, (nu,)),
            "limits": saturation("Feedback", self.limits, [f"u{i + 1}" for i in range(nu)]),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if self.dt is not None and not 0 < self.dt < np.inf:
            raise ValueError(f"Feedback.dt = {self.dt!r} must be > 0")

    def reset(self) -> None:
        """Nothing to forget."""

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,)."""
        y = require_finite("Feedback.y", y, (len(self.reads),))
        return np.clip(self.u_ref - self.K @ (y - self.y_ref), *self.limits)
