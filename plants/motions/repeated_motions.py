"""A motion by fixed steps under held inputs on a grid that is known from before: one native call, little around it.

What depends on the plant, the times, the method and the step alone is prepared once and kept with the plant, which
never changes. This is the short way of `simulate`, with every check of the long one: it gives a motion only where all
is plainly sound, the same to the last digit, and else None, whereupon the long way says what there is to say.
"""

from __future__ import annotations

import math
import time as clock
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import LEAST
from pliant.plants.core.parameters import least_parameters
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.native import kernel_loader

from . import played_motion, time_limit
from .motion_library import A_CALL, MotionLibrary
from .observations import observer, slopes_at_rows
from .played_motion import LEFT, NEAR, ODD, PlayedMotion

Array = np.ndarray
KEPT = 8  # grids of a plant
MOST_NUMBERS = 2_000_000  # of a motion whose arrays are kept
SAVED = 2e-4  # [s] a call, which pays for the C of it: the long way takes as much longer
FLOAT = np.dtype(float)
NAME = "_played"  # under which a plant keeps them


Found = tuple[Trajectory, Array | None] | None


@dataclass(frozen=True)
class StepLimit:
    """How steps are held against their limit: at the start of `every` so many intervals."""

    every: int
    bound: float  # of step times eigenvalue, below which there is no doubt; inf where a method has no limit
    rounded: float  # what rounding is, of each state, in the bound of the eigenvalues
    doubtful: Callable[..., Any]  # (plant, x, method, steps, u, p, t): which of the rows have to be looked at


class Repeated:
    """Motions of a plant on one grid."""

    def __init__(self, plant: PlantLike, played: PlayedMotion, looks: Array, steps: Array, limit: StepLimit) -> None:
        self.plant, self.played, self._looks, self._steps, self._limit = plant, played, looks, steps, limit
        self._rates = plant._dynamics._function.n_out()

    def motion(self, x0: Array, u: Array | None, w: Array | None, p: Array | None, method: str, step: float) -> Found:
        """As `again`."""
        plant, played, began = self.plant, self.played, clock.perf_counter()
        played.x[0], played.u[:] = x0, 0.0 if u is None else u
        played.w[:], played.p[:] = plant.quiet[0] if w is None else w, plant.quiet[1] if p is None else p
        found = played.play()
        if found & ODD or (found & NEAR and not self._is_within(method)):
            return None
        plant.check_state(x0)
        results = [rows.copy() for rows in played.results]
        x, held, w = played.x.copy(), played.u.copy(), np.empty((len(played.t), len(played.w)))
        w[:] = played.w
        dx = plant._sound_rate(x, results[: self._rates])
        made: Trajectory = object.__new__(Trajectory)
        fields: dict[str, Any] = {"t": played.t.copy(), "x": x, "u": held, "y": results[self._rates]}
        fields |= {"dx": dx, "w": w}
        for array in fields.values():
            array.setflags(write=False)
        made.__dict__.update(fields)
        made.__dict__.update(plant.signals)
        made.__dict__["hold"] = "linear" if u is None or u.ndim == 1 else "zero-order"
        taken = {"seconds": clock.perf_counter() - began, "steps": played.steps, "step": step, "native": True}
        made.__dict__["stats"] = {"method": method, **taken}
        return made, results[-1] if found & LEFT else None

    def _is_within(self, method: str) -> bool:
        """Whether every step that is looked at is within its limit, by the rule of the long way."""
        played, k = self.played, self._looks
        at = (played.x[k], method, self._steps, played.u[k], played.p, played.t[k])
        return not len(self._limit.doubtful(self.plant, *at))


def again(
    plant: PlantLike, x0: Any, u: Any, t: Any, w: Any, p: Any, method: Any, step: Any, tolerances: tuple[Any, Any]
) -> Found:
    """The motion, and values of its ranges where it leaves one; None where it cannot be had in one call, or something
    about it is odd: go the long way.
    """
    if type(method) is not str or type(step) is not float or time_limit.limited() or not kernel_loader.wanted():
        return None
    rtol, atol = tolerances  # which fixed steps do not use
    if type(rtol) is not float or type(atol) is not float or not (LEAST <= rtol <= 1.0 and LEAST <= atol <= 1.0):
        return None
    x0 = plant.rest_state if x0 is None else x0
    if not (_numbers(t) and t.ndim == 1 and _numbers(x0) and x0.shape == (plant.nx,)):
        return None
    if u is not None and not (_numbers(u) and u.shape in ((plant.nu,), (len(t), plant.nu))):
        return None
    if w is not None and not (_numbers(w) and w.shape == (plant.nw,)):
        return None
    if p is not None and not (_numbers(p) and p.shape == (len(plant.varied),)):
        return None
    if p is not None and (p < least_parameters(plant)).any():
        return None
    kept: OrderedDict[Any, Repeated] = plant.__dict__.setdefault(NAME, OrderedDict())
    known = kept.get((method, step, t.tobytes()))
    if known is None or not known.played.lock.acquire(blocking=False):  # its arrays serve one caller at a time
        return None
    try:
        return known.motion(x0, u, w, p, method, step)
    finally:
        known.played.lock.release()


def _numbers(value: Any) -> bool:
    return type(value) is np.ndarray and value.dtype == FLOAT


def prepare(
    plant: PlantLike, t: Array, method: str, step: float, library: MotionLibrary, counts: Array, limit: StepLimit
) -> None:
    """Lay out what `again` needs for motions like one that the library has just marched by `counts` steps an interval,
    where what is compiled of the plant besides is in memory too.
    """
    kept: OrderedDict[Any, Repeated] = plant.__dict__.setdefault(NAME, OrderedDict())
    seen, limited = observer(plant), limit.bound < math.inf
    own, slopes = seen.kernel.loaded, slopes_at_rows(plant).kernel.loaded if limited else None
    numbers = len(t) * (3 * plant.nx + plant.nu + 2 * plant.nw + 2 * len(plant.outputs))
    if own is None or (limited and slopes is None) or counts.sum() > A_CALL or numbers > MOST_NUMBERS:
        return
    if (key := (method, step, t.tobytes())) in kept or (run := played_motion.program.at_hand(SAVED)) is None:
        return
    sizes = plant.nx, plant.nu, plant.nw, len(plant.varied)
    ranges = np.array([float(r.limit) for r in plant.validity])
    looks = np.arange(0, len(t) - 1, limit.every) if limited else np.zeros(0, dtype=int)
    grid, looked_at = (t.copy(), counts), (looks, limit.bound, limit.rounded)
    played = PlayedMotion(run, (library.fixed[method], own, slopes), sizes, seen.sizes, grid, ranges, looked_at)
    steps = (t[looks + 1] - t[looks]) / counts[looks]
    kept[key] = Repeated(plant, played, looks, steps, limit)
    while len(kept) > KEPT:
        kept.popitem(last=False)
