"""How adaptive methods choose their steps, and what ends them.

A step h whose error, set against atol + rtol |x|, is e < 1 is taken, others are tried again; the next is
h min(GROW, max(SHRINK, SAFETY e^(-1/(q + 1)))), q the order of the estimate (Hairer, Norsett and Wanner, "Solving
Ordinary Differential Equations I", II.4), but no shorter than what a step was to be that was cut to end on a time.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np

from pliant.plants.core.errors import IntegrationError

SAFETY, SHRINK, GROW = 0.9, 0.2, 10.0  # limits of the step-size change, as in SciPy
MOST_STEPS = 100_000_000  # of one simulation: they take hours
_fewer: ContextVar[int | None] = ContextVar("fewer steps", default=None)
SMALLEST_STEP = 1e-13  # relative to the time reached
TOO_MANY, TOO_SMALL, PAUSED = 1, 2, 3  # what an adaptive native call gives; the last after as many steps as one takes


def limits() -> tuple[float, ...]:
    """What bounds the steps, in the order in which compiled motions take them."""
    return GROW, SHRINK, SAFETY, SMALLEST_STEP, most_steps()


def most_steps() -> int:
    """After how many steps a simulation ends."""
    fewer = _fewer.get()
    return MOST_STEPS if fewer is None else min(fewer, MOST_STEPS)


@contextmanager
def at_most(steps: int) -> Iterator[None]:
    """Simulations of this thread, or task, inside end after so many steps."""
    before = _fewer.set(steps)
    try:
        yield
    finally:
        _fewer.reset(before)


def too_many_steps(t: float, x: np.ndarray, trial: float, method: str = "dop853") -> IntegrationError:
    """What ends a motion after too many steps."""
    other = 'method="rodas5p", which is for stiff plants' if method == "dop853" else "larger rtol and atol"
    return IntegrationError(
        f"{method} stopped at t = {t:.6g} s after {most_steps():,} steps, the last of {trial:.3g} s; go on from the "
        f"last state, or use {other}",
        t,
        x,
        trial,
    )


def too_small_a_step(t: float, z: np.ndarray, h: float, nx: int, method: str = "dop853") -> IntegrationError:
    """What ends a motion whose step has fallen to nothing."""
    return IntegrationError(
        f"{method} stopped at t = {t:.6g} s, its step having fallen to {h:.3g} s, at state {z}; the motion is singular "
        "there, or rtol and atol are too small",
        t,
        z[:nx],
        h,
    )


def stopped(status: int, t: float, x: np.ndarray, step: float, trial: float, method: str) -> IntegrationError:
    """What ends a motion in native code, by what the call gave."""
    many = status == TOO_MANY
    return too_many_steps(t, x, trial, method) if many else too_small_a_step(t, x, step, len(x), method)
