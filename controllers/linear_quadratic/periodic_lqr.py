"""Optimal control of a machine that runs in a cycle: the regulator of deviations from it, repeated for ever.

Law    u = u* - K(phi) (x - x*(phi)) - k(phi), within the limits, held over dt; phi the angle that goes round
Cost   the mean over time of the scene's cost, to second order about the cycle, its first order included

Where in the cycle the machine stands is told by the angle itself, not by the clock: deviations are taken across the
cycle, at the same angle, so that being early or late is none. Over a step A_k = Pi_k+1 dF/dx, Pi = 1 - f e'/f_phi with
f the cycle's direction: what has moved along it is taken back. Every multiplier of what is left can be below 1.
To be further on by dphi saves what is dearer than the mean of that stretch, (r'r - mean) dphi / (dphi/dt): first order.

(x*, u*) is the cycle of the sampled plant under a constant input, by Newton's method on a whole number of control
periods in few turns; k moves it to the cycle of least mean cost. Both are found at the nodes of these turns, which lie
densely in the angle, and are linear in between.

Guarantee   the multipliers of the linear loop about its cycle are inside the unit circle. None beyond.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.controller import moment, reading, saturation
from pliant.controllers.base.objective import Objective
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.controllers.optimal_control.stage_derivatives import StageTerms
from pliant.controllers.riccati.periodic import PeriodicRegulator
from pliant.plants.core.argument_gates import require_number
from pliant.plants.core.errors import EquilibriumError
from pliant.plants.core.signals import OwnsArrays

from .period_cost import period_cost

Array = np.ndarray
TURNS, NODES = 24, 5000  # in which control periods have to fit, at most; nodes of these
FITS = 1e-6  # of a control period by which they may miss
NEWTON, CLOSED = 30, 1e-10  # steps; of the cycle's size, what may be left open at its end


@final
@dataclass(eq=False)
class PeriodicLQR(OwnsArrays):
    """Made by `for_scene`."""

    dt: float  # [s]
    reads: tuple[str, ...]
    angle: int  # which of `reads` goes round
    x: Array  # (N, nx) x* by angle within one turn, ascending from x[0, angle] in [0, 2 pi)
    u: Array  # (N, nu) u* - k
    K: Array  # (N, nu, nx), zero for the angle
    regulator: PeriodicRegulator  # of deviations across the cycle, by time: N steps in `turns`
    turns: int
    limits: tuple[Array, Array]  # lowest, highest (nu,)

    def __post_init__(self) -> None:
        self._phi = self.x[:, self.angle]
        ends = np.r_[self._phi[-1] - 2 * np.pi, self._phi, self._phi[0] + 2 * np.pi]
        around = np.r_[-1, np.arange(len(self._phi)), 0]
        self._nodes, self._x, self._u, self._K = ends, self.x[around], self.u[around], self.K[around]

    @classmethod
    def for_scene(cls, scene: CostedScene, *, effort: float = 1.0) -> PeriodicLQR:
        """About the cycle that a scene's goal runs in, with its cost, limits and control period.

        The angle that goes round is the state in rad that alone moves at the goal, at a steady rate. effort: a factor
        on what the inputs cost. EquilibriumError where no cycle is found; UncontrollableError where a deviation from it
        cannot be made to decay, or the cost does not see it. effort: dimensionless, a factor on what the inputs cost.
        """
        require_scene("PeriodicLQR.for_scene", scene)
        effort = require_number("PeriodicLQR.for_scene.effort", effort, "positive")
        cycle = deviations(scene, effort)
        made = riccati.dplqr(*cycle.system, q=cycle.q, s=cycle.s)
        steps, plant, angle = len(made.K), scene.plant, cycle.angle
        K = np.zeros((steps, plant.nu, plant.nx))
        K[:, :, [i for i in range(plant.nx) if i != angle]] = made.K
        path = cycle.x.copy()
        path[:, angle] = np.mod(path[:, angle], 2 * np.pi)
        order = np.argsort(path[:, angle])
        high = np.array(scene.limits, dtype=float)
        limits = saturation("PeriodicLQR", (-high, high), [s.name for s in plant.inputs])
        names, u = tuple(s.name for s in plant.states), scene.target[1] - made.k
        return cls(scene.dt, names, angle, path[order], u[order], K[order], made, cycle.turns, limits)

    @property
    def multipliers(self) -> Array:
        """Of the closed loop over one turn (nx - 1,), largest first: sizes. Dimensionless."""
        return np.asarray(np.abs(self.regulator.multipliers) ** (1 / self.turns))

    def reset(self) -> None:
        """Nothing is kept from one period to the next."""

    def act(self, t: float, y: Array) -> Array:
        """u (nu,) from the states y (nx,)."""
        y = reading("PeriodicLQR.y", y, len(self.reads))
        moment("PeriodicLQR", t)
        phi = y[self.angle] % (2 * np.pi)
        k = min(max(int(np.searchsorted(self._nodes, phi, side="right")) - 1, 0), len(self._nodes) - 2)
        share = (phi - self._nodes[k]) / (self._nodes[k + 1] - self._nodes[k])
        off = y - ((1 - share) * self._x[k] + share * self._x[k + 1])
        off[self.angle] = 0.0
        u = (1 - share) * (self._u[k] - self._K[k] @ off) + share * (self._u[k + 1] - self._K[k + 1] @ off)
        return np.minimum(np.maximum(u, self.limits[0]), self.limits[1])


class Deviations(NamedTuple):
    """x (N, nx) on the cycle, and the steps of deviations across it with what they cost."""

    angle: int
    turns: int
    x: Array
    system: tuple[Array, Array, Array, Array, Array]  # A, B, Q, R, N, each (N, ..)
    q: Array  # (N, nx - 1)
    s: Array  # (N, nu)


def deviations(scene: CostedScene, effort: float = 1.0) -> Deviations:
    """The linear-quadratic problem about the cycle of a scene's goal."""
    about, plant = Objective.of(scene), scene.plant
    given = np.zeros(plant.nw), plant.nominal_parameters
    angle, rate = turning(scene)
    turns, steps = whole_turns(2 * math.pi / abs(rate), scene.dt)
    dt = 2 * math.pi * turns / abs(rate) / steps  # the scene's own, to rounding
    x, found = _cycle(scene, angle, rate, turns, steps, dt)
    u, t = np.tile(about.u_goal, (steps, 1)), dt * np.arange(steps)
    r, J = StageTerms(about, about.residual_expression).values(t, x[:-1], u, *given)
    Q, R, N = period_cost(J, plant.nx, dt, effort)
    slope = dt * np.einsum("kri,kr->ki", J, r)
    flow = plant.dynamics(x[1:], u)
    rest = [i for i in range(plant.nx) if i != angle]
    A, B = found[:, :, : plant.nx], found[:, :, plant.nx :]
    along = flow[:, rest] / flow[:, angle, None]
    A_across = A[:, rest][:, :, rest] - along[:, :, None] * A[:, None, angle, rest]
    B_across = B[:, rest] - along[:, :, None] * B[:, None, angle]
    system = A_across, B_across, Q[:, rest][:, :, rest], R, N[:, rest]
    rate_of_cost = (r**2).sum(axis=1)
    rate_of_cost = (rate_of_cost + np.roll(rate_of_cost, -1)) / 2  # what a sum over periods sees at the end of each
    ahead = (rate_of_cost.mean() - rate_of_cost) / flow[:, angle] / 2
    q = slope[:, rest] + ahead[:, None] * A[:, angle, rest]
    s = effort * slope[:, plant.nx :] + ahead[:, None] * B[:, angle]
    return Deviations(angle, turns, x[:-1], system, q, s)


def turning(scene: CostedScene) -> tuple[int, float]:
    """Which state goes round at the goal, and its rate [rad/s]; EquilibriumError where not one alone does."""
    x, u = scene.target
    f, units = scene.plant.dynamics(x, u), [s.unit for s in scene.plant.states]
    kinematic = {s.name for s in scene.plant.states}
    found = [
        i
        for i, s in enumerate(scene.plant.states)
        if units[i] == "rad" and abs(f[i]) > 1e-9 and f"{s.name}_rate" in kinematic
    ]
    if len(found) != 1:
        named = ", ".join(scene.plant.states[i].name for i in found) or "none"
        raise EquilibriumError(
            f"the goal of scene {scene.name!r} is no cycle: angles that go round there: {named}, must be one", np.inf
        )
    return found[0], float(f[found[0]])


def whole_turns(period: float, dt: float) -> tuple[int, int]:
    """Fewest turns of `period` [s] that whole control periods fill, and how many; EquilibriumError where none do."""
    for turns in range(1, TURNS + 1):
        steps = round(turns * period / dt)
        if steps >= 8 and steps <= NODES and abs(turns * period / dt - steps) <= FITS:
            return turns, steps
    raise EquilibriumError(
        f"a turn of {period:.6g} s: no {TURNS} turns or fewer are whole control periods of {dt:.6g} s; take another dt",
        period,
    )


def _cycle(scene: CostedScene, angle: int, rate: float, turns: int, steps: int, dt: float) -> tuple[Array, Array]:
    """x* (steps + 1, nx) under the goal's input, ending where it began but for the turns, and its steps' slopes."""
    plant = scene.plant
    (start, u_goal), given = scene.target, (np.zeros(plant.nw), plant.nominal_parameters)
    u, nx = u_goal[None], plant.nx
    round_ = np.zeros(nx)
    round_[angle] = math.copysign(2 * math.pi * turns, rate)
    start = start.copy()
    for _ in range(NEWTON):
        x, slopes, whole = [start], [], np.eye(nx)
        for k in range(steps):
            now = HeldSteps(plant, dt, scene.substeps, np.array([k * dt]), *given).slopes(x[-1][None], u)
            x.append(now.end[0])
            slopes.append(now.slope[0])
            whole = slopes[-1][:, :nx] @ whole
        open_ = x[-1] - start - round_
        size = float(np.abs(np.array(x) - start).max(axis=0)[np.arange(nx) != angle].max(initial=0.0))
        if not np.isfinite(open_).all():
            break
        if np.abs(open_).max() <= CLOSED * max(size, 1.0):
            return np.array(x), np.array(slopes)
        # no unique start along the cycle, nor among cycles of other speeds: the shortest step
        start = start - np.linalg.lstsq(whole - np.eye(nx), open_, rcond=1e-9)[0]
    raise EquilibriumError(f"no cycle about the goal of scene {scene.name!r} is found", float(np.abs(open_).max()))
