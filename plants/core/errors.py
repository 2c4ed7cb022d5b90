"""Failures that carry what was tried and a remedy. Bad input is a plain ValueError naming field, value and range."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import numpy as np

_RESTS_TOLD = ContextVar("_RESTS_TOLD", default=True)
PASSED = ("pliant.", "functools", "contextlib")  # modules between a warning and the line that is warned


class PliantError(Exception):
    """Base of all failures that are not simply bad input. They come back from other processes as they are."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _raised, (type(self), self.args), self.__dict__


def _raised(kind: type[PliantError], args: tuple[Any, ...]) -> PliantError:
    return kind.__new__(kind, *args)  # not through __init__, which takes more than the message


class EquilibriumError(PliantError):
    """No equilibrium was found; `residual` [units of dx/dt] is the largest remaining rate."""

    def __init__(self, message: str, residual: float) -> None:
        super().__init__(message)
        self.residual = residual


class IntegrationError(PliantError):
    """A simulation could not go on: `time` [s], `state` (nx,) and `step` [s] where it stopped."""

    def __init__(self, message: str, time: float, state: np.ndarray, step: float) -> None:
        super().__init__(message)
        self.time, self.state, self.step = time, state, step


class StabilityLimitError(PliantError):
    """A fixed step is past the stability limit of its method.

    `step` and `largest_step` [s]; `mode` is the eigenvalue [1/s] of the fastest mode.
    """

    def __init__(self, message: str, step: float, mode: complex, largest_step: float) -> None:
        super().__init__(message)
        self.step, self.mode, self.largest_step = step, mode, largest_step


class MassMatrixError(PliantError):
    """The mass matrix has lost definiteness; `state` (nx,) is where, `pivot` its smallest Cholesky pivot."""

    def __init__(self, message: str, state: np.ndarray, pivot: float) -> None:
        super().__init__(message)
        self.state, self.pivot = state, pivot


class UncontrollableError(PliantError):
    """Modes that the input cannot reach, or the output or cost cannot see; `modes` names them."""

    def __init__(self, message: str, modes: tuple[str, ...]) -> None:
        super().__init__(message)
        self.modes = modes


class NotFiniteWarning(RuntimeWarning):
    """A plant's function gave NaN or an infinite number at finite arguments."""


class DivergenceWarning(RuntimeWarning):
    """Lanes of a batch are no longer finite numbers."""


class UnstableRestWarning(UserWarning):
    """A rest point that a motion leaves, however close it starts. Told where `equilibrium` is asked for it, not of the
    start and goal of scenes: `pliant check` and `pliant stability` say it of those.
    """


class ValidityWarning(UserWarning):
    """A motion leaves the range in which the plant's kinematics hold."""


class NominalWarning(UserWarning):
    """Nominal inputs beyond a scene's limits, or an open-loop motion that does not arrive."""


@contextmanager
def unstable_rests_untold() -> Iterator[None]:
    """No UnstableRestWarning within: of rests that a controller is to hold, or that are one of many."""
    before = _RESTS_TOLD.set(False)
    try:
        yield
    finally:
        _RESTS_TOLD.reset(before)


def rests_told() -> bool:
    """Whether unstable rests are warned of here."""
    return _RESTS_TOLD.get()


def warn_caller(message: str, kind: type[Warning]) -> None:
    """Warn of the first line outside the library that led here; inside, which line it is depends on the way taken."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith(PASSED):
        level, frame = level + 1, frame.f_back
    warnings.warn(message, kind, stacklevel=level)


class InfeasibleError(PliantError):
    """A constrained problem has no solution."""
