"""Optimal control of a machine that runs in a cycle: the regulator of deviations from it, repeated for ever.

Law    u = u* - K(phi) (x - x*(phi)) - k(phi), within the limits, held over dt; phi the angle that goes round
Cost   the mean over time of the scene's cost, to second order about the cycle, its first order included

Where in the cycle the machine stands is told by the angle itself, not by the clock: deviations are taken across the
cycle, at the same angle, so that being early or late is none (cycle.py), and every multiplier of what is left can be
below 1. k moves the cycle to the one of least mean cost. Both are found at the cycle's nodes, which lie densely in the
angle, and are linear in between.

Late   inputs on their way count as states, less u*. Of a range of delays the gain is the one for a delay that is drawn
       anew at each period from it (riccati/periodic_drawn.py); the loop of each that stays is looked at. Machines of
       a box of parameters are drawn alike; that their own cycles are others is left out.

Guarantee   the multipliers of the linear loop about the cycle are inside the unit circle, at the delays and for the
            machines that were looked at. None beyond.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import final

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.controller import moment, reading, saturation
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.riccati.late_inputs import LOOKED, POINTS, delay_range, past_of
from pliant.controllers.riccati.periodic import PeriodicRegulator
from pliant.controllers.riccati.periodic_drawn import DrawnRegulator, drawn_periodic, multipliers_of
from pliant.controllers.robust_design.many_model_lqr import box_of
from pliant.plants.core.argument_gates import require_number
from pliant.plants.core.errors import UncontrollableError
from pliant.plants.core.signals import OwnsArrays

from .by_angle import ByAngle
from .cycle import Cycle, Machine, of_cycle

Array = np.ndarray
Regulator = PeriodicRegulator | DrawnRegulator


@final
@dataclass(eq=False)
class PeriodicLQR(OwnsArrays):
    """Made by `for_scene`."""

    dt: float  # [s]
    reads: tuple[str, ...]
    angle: int  # which of `reads` goes round
    x: Array  # (N, nx) x* by angle within one turn, ascending from x[0, angle] in [0, 2 pi)
    u: Array  # (N, nu) u* - k
    K: Array  # (N, nu, nx + M nu), zero for the angle; of the M inputs on their way last, the oldest first
    regulator: Regulator  # of deviations across the cycle, by time: N steps in `turns`
    turns: int
    limits: tuple[Array, Array]  # lowest, highest (nu,)
    mean: Array  # (nu,) u*
    around: Array  # (nx - 1 + M nu,) sizes of the loop's multipliers over all `turns`, of the worst delay
    delay: tuple[float, float] = (0.0, 0.0)  # shortest, longest [periods]
    before: Array | None = None  # (M, nu) inputs on their way at the start, less u*

    def __post_init__(self) -> None:
        self._nodes = ByAngle(self.x[:, self.angle])
        self._x, self._u, self._K = (self._nodes.around(v) for v in (self.x, self.u, self.K))
        self.reset()

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        *,
        effort: float = 1.0,
        delay: float | tuple[float, float] = 0.0,
        ranges: Mapping[str, tuple[float, float]] | None = None,
    ) -> PeriodicLQR:
        """About the cycle that a scene's goal runs in, with its cost, limits and control period.

        The angle that goes round is the state in rad that alone moves at the goal, at a steady rate. effort:
        dimensionless, a factor on what the inputs cost. delay: after how many periods an input acts, or (shortest,
        longest) [periods]. ranges: smallest and largest factor by name of parameter: one gain for the machines at the
        corners of that box and its middle, about the cycle of the scene's own plant. EquilibriumError where no cycle is
        found; UncontrollableError where a deviation from it cannot be made to decay, at one of the delays or by one of
        the machines, or the cost does not see it.
        """
        require_scene("PeriodicLQR.for_scene", scene)
        effort = require_number("PeriodicLQR.for_scene.effort", effort, "positive")
        late = delay_range("PeriodicLQR.for_scene", delay)
        return cls.about(Cycle.find(scene), effort, late, box_of(scene, ranges or {}, "PeriodicLQR.ranges"))

    @classmethod
    def about(
        cls,
        cycle: Cycle,
        effort: float,
        delay: tuple[float, float],
        box: Mapping[str, tuple[float, float]] | None = None,
    ) -> PeriodicLQR:
        """The same about a cycle that is found. effort [-], delay (shortest, longest) [periods], box: ranges."""
        if delay[1] or box:
            return cls._of(cycle, *of_draws(cycle, delay, effort, machines_of(cycle, box or {})), delay)
        on_time = of_cycle(cycle, effort)
        made = riccati.dplqr(*on_time.system, q=on_time.q, s=on_time.s)
        return cls._of(cycle, made, np.abs(made.multipliers), delay)

    @classmethod
    def _of(cls, cycle: Cycle, made: Regulator, around: Array, delay: tuple[float, float]) -> PeriodicLQR:
        """The law of a regulator of deviations across a cycle, with the scene's limits."""
        scene, plant, past = cycle.scene, cycle.scene.plant, past_of(delay[1])
        K = np.zeros((cycle.steps, plant.nu, plant.nx + past * plant.nu))
        K[:, :, [*cycle.rest, *range(plant.nx, K.shape[2])]] = made.K
        order = ByAngle(cycle.x[:-1, cycle.angle]).order
        path = cycle.x[:-1].copy()
        path[:, cycle.angle] = np.mod(path[:, cycle.angle], 2 * np.pi)
        high = np.array(scene.limits, dtype=float)
        limits = saturation("PeriodicLQR", (-high, high), [s.name for s in plant.inputs])
        names, u = tuple(s.name for s in plant.states), cycle.u - made.k
        before = np.tile(np.clip(scene.initial[1], -high, high) - cycle.u, (past, 1))
        about = made, cycle.turns, limits, cycle.u, around, delay, before
        return cls(scene.dt, names, cycle.angle, path[order], u[order], K[order], *about)

    @property
    def multipliers(self) -> Array:
        """Of the closed loop over one turn (nx - 1 + M nu,), largest first: sizes. Dimensionless."""
        return np.asarray(self.around ** (1 / self.turns))

    def reset(self) -> None:
        """Forget the inputs on their way."""
        self._past = np.zeros((0, self.u.shape[1])) if self.before is None else self.before.copy()

    def act(self, t: float, y: Array) -> Array:
        """u (nu,) from the states y (nx,)."""
        y = reading("PeriodicLQR.y", y, len(self.reads))
        moment("PeriodicLQR", t)
        u = np.minimum(np.maximum(self.unlimited(y)[0], self.limits[0]), self.limits[1])
        self.asked(u)
        return u

    def unlimited(self, y: Array) -> tuple[Array, Array]:
        """The law's u (nu,) without limits, and what it acts on (nx + M nu,): y (nx,) less the cycle at its angle, zero
        for that, and the inputs on their way less u*."""
        k, share = self._nodes.at(y[self.angle])
        off = y - ((1 - share) * self._x[k] + share * self._x[k + 1])
        off[self.angle] = 0.0
        if len(self._past):
            off = np.concatenate([off, self._past.ravel()])
        return (1 - share) * (self._u[k] - self._K[k] @ off) + share * (self._u[k + 1] - self._K[k + 1] @ off), off

    def asked(self, u: Array) -> None:
        """Take u (nu,) for the last input that was asked for."""
        if len(self._past):
            self._past[:-1] = self._past[1:]
            self._past[-1] = u - self.mean


def machines_of(cycle: Cycle, box: Mapping[str, tuple[float, float]]) -> list[Machine | None]:
    """The scene's own plant, None, and those at the corners of a box of factors by name of parameter."""
    if not box:
        return [None]
    varied = cycle.scene.plant.vary(*box)
    return [None, *((varied, varied.nominal_parameters * factors) for factors in product(*box.values()))]


def of_draws(
    cycle: Cycle, delay: tuple[float, float], effort: float, machines: Sequence[Machine | None]
) -> tuple[DrawnRegulator, Array]:
    """The regulator for inputs that act so late [periods] on each of the machines, and its multipliers' sizes at the
    worst of both."""
    low, high = delay
    past, known = past_of(high), 1 if low == high else POINTS
    drawn = [cycle.late(d, past, effort, one) for d in np.linspace(low, high, known) for one in machines]
    made = drawn_periodic(*(np.array(part) for part in zip(*drawn, strict=True)))
    stays: list[tuple[float, Machine | None]] = [
        (d, None) for d in np.linspace(low, high, 1 if low == high else LOOKED)
    ]
    stays += [(d, one) for d in np.linspace(low, high, known) for one in machines if one is not None]
    sizes = np.abs(multipliers_of(np.array([cycle.late(d, past, effort, one).step for d, one in stays]), made.K))
    worst = int(sizes[:, 0].argmax())
    if not sizes[worst, 0] < 1:
        raise UncontrollableError(
            f"delay = ({low:g}, {high:g}) periods, {len(machines)} machines: the law for all is not stable for one of "
            f"{stays[worst][0]:.3g} that stays (largest multiplier {sizes[worst, 0]:.4f}): narrow delay or ranges, or "
            "make the inputs dearer",
            (),
        )
    return made, sizes[worst]
