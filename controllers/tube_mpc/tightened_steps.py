"""The optimisations of a tube MPC: those of an MPC, each with its limits moved in by what the error may take."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pliant.controllers.mpc.constraints import Limits, Step
from pliant.controllers.solvers.daqp_model import INFINITE
from pliant.plants.core.errors import InfeasibleError

from .error_bounds import Course, Tightening

Array = np.ndarray


def largest_share(found: Tightening, limits: Limits) -> tuple[float, str]:
    """The most that is taken of a limit's range at any time of any plan, and of which signal."""
    inputs = (limits.inputs, found.u_high + found.u_low, limits.high - limits.low)
    signals = (limits.bounded, found.z_high + found.z_low, limits.ceiling - limits.floor)
    share, worst = 0.0, ""
    for names, taken, ranges in (inputs, signals):
        for i, name in enumerate(names):  # a limit of one side has no range
            own = float(taken[..., i].max() / ranges[i]) if np.isfinite(ranges[i]) else 0.0
            if own > share:
                share, worst = own, name
    return share, worst


def crowding(found: Tightening, limits: Limits, origin: tuple[Array, Array, Array]) -> float:
    """The most that is taken of what a reference, u (.., nu) and signals (.., nb) of `origin`, leaves to a limit."""
    times, n = found.u_high.shape[:2]
    at = np.add.outer(np.arange(times), np.arange(n))
    worst = 0.0
    ends = ((found.u_high, found.u_low, origin[1], limits.low, limits.high),)
    for high, low, values, least, most in (*ends, (found.z_high, found.z_low, origin[2], limits.floor, limits.ceiling)):
        reference = values[np.minimum(at, len(values) - 1)]
        for taken, left in ((high, most - reference), (low, reference - least)):
            tiny = np.finfo(float).tiny
            worst = max(worst, float((taken / np.maximum(left, tiny)).max(initial=0.0)))
    return worst


def require_room(owner: str, found: Tightening, limits: Limits) -> None:
    """InfeasibleError where the error takes a whole range."""
    share, name = largest_share(found, limits)
    if share >= 1.0:
        raise InfeasibleError(
            f"{owner}: what is uncertain may take {share:.3g} times the range of {name}, which leaves a plan nothing: "
            f"narrow it to less than {1 / share:.2g} of what it is, widen that limit, or shorten the horizon"
        )


def tightened(steps: Sequence[Step], found: Tightening, limits: Limits, course: Course) -> list[Step]:
    """A step for each time of `found`; where there is one step, its solver and maps serve all."""
    finite = np.flatnonzero(np.isfinite(limits.low) | np.isfinite(limits.high))
    times, n = len(found.u_high), len(steps[0].low) // max(steps[0].stride, 1)
    j = np.arange(n)
    at = np.where(course.direct, j[:, None], j[:, None] + 1) + np.zeros(
        (times, 1, 1), dtype=int
    )  # as in `mpc.constraints`
    high, low = (
        np.concatenate([u[:, :n, finite], np.take_along_axis(z, at, axis=1)], axis=2).reshape(times, -1)
        for u, z in ((found.u_high, found.z_high), (found.u_low, found.z_low))
    )
    made = []
    for i in range(times):
        step = steps[min(i, len(steps) - 1)]
        up = np.where(step.high < INFINITE, step.high - high[i] / step.scale, step.high)
        down = np.where(step.low > -INFINITE, step.low + low[i] / step.scale, step.low)
        made.append(step._replace(low=down, high=up))
    return made
