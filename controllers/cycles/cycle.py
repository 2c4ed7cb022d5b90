"""The cycle that a scene's goal runs in, and deviations across it: taken at the same angle, not at the same time.

(x*, u*) is the cycle of the sampled plant under a constant input, by Newton's method on the ends x*_k of a whole number
of control periods in few turns: its nodes.

Over a step A_k = Pi_k+1 dF/dx, Pi = 1 - f e'/f_phi with f the cycle's direction: what has moved along it is taken back,
so that being early or late is no deviation. To be further on by dphi saves what is dearer than the mean of that
stretch, (r'r - mean) dphi / (dphi/dt): first order.

Inputs that act late by d = m + f periods, 0 <= f < 1: over the first f of period k acts u[k-m-1], over the rest u[k-m];
z = [deviation; u[k-M] - u*; ..; u[k-1] - u*], M the periods of the longest delay, begun ones counted. The cost of a
period is shared between the two as time is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from pliant.controllers.base.objective import Objective
from pliant.controllers.base.scene_protocol import CostedScene
from pliant.controllers.linear_quadratic.period_cost import period_cost
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.controllers.optimal_control.stage_derivatives import StageTerms
from pliant.controllers.riccati.late_inputs import periods_of
from pliant.plants.core.errors import EquilibriumError
from pliant.plants.dynamics.plant import Plant

Array = np.ndarray
Machine = tuple[Plant, Array]  # a plant and its parameters (np,)
TURNS, NODES = 24, 5000  # in which control periods have to fit, at most; nodes of these
FITS = 1e-6  # of a control period by which they may miss
NEWTON, CLOSED = 30, 1e-10  # steps; of the cycle's size, what may be left open at its end


class Deviations(NamedTuple):
    """x (N, nx) on the cycle, and the steps of deviations across it with what they cost."""

    angle: int
    turns: int
    x: Array
    system: tuple[Array, Array, Array, Array, Array]  # A, B, Q, R, N, each (N, ..)
    q: Array  # (N, nx - 1)
    s: Array  # (N, nu)


class LateSteps(NamedTuple):
    """z+ = step [z; u], the cost [z; u]'cost [z; u] + 2 slope'[z; u], of the N steps in time."""

    step: Array  # (N, nz, nz + nu)
    cost: Array  # (N, nz + nu, nz + nu)
    slope: Array  # (N, nz + nu)


@dataclass(frozen=True, eq=False)
class Cycle:
    """Made by `find`."""

    scene: CostedScene
    angle: int  # which state goes round
    rate: float  # its mean rate [rad/s]
    turns: int
    x: Array  # (N + 1, nx), the last one `turns` turns after the first

    @classmethod
    def find(cls, scene: CostedScene) -> Cycle:
        """EquilibriumError where the goal is none, or no cycle is found."""
        angle, rate = turning(scene)
        turns, steps = whole_turns(2 * math.pi / abs(rate), scene.dt)
        return cls(scene, angle, rate, turns, _closed(scene, angle, rate, turns, steps))

    @property
    def steps(self) -> int:
        """N, control periods in the turns."""
        return len(self.x) - 1

    @property
    def dt(self) -> float:
        """[s], the scene's own, to rounding."""
        return 2 * math.pi * self.turns / abs(self.rate) / self.steps

    @cached_property
    def rest(self) -> list[int]:
        """The other states."""
        return [i for i in range(self.scene.plant.nx) if i != self.angle]

    @cached_property
    def u(self) -> Array:
        """(nu,) the constant input."""
        return np.array(self.scene.target[1], dtype=float)

    @cached_property
    def flow(self) -> Array:
        """(N, nx) dx/dt at the ends of the steps."""
        return np.asarray(self.scene.plant.dynamics(self.x[1:], np.tile(self.u, (self.steps, 1))))

    def _moved(self, part: float, x: Array, machine: Machine | None) -> tuple[Array, Array]:
        """Ends (N, nx) and slopes (N, nx, nx + nu) of `part` of a period from x (N, nx)."""
        scene = self.scene
        plant, p = (scene.plant, scene.plant.nominal_parameters) if machine is None else machine
        given = np.zeros(plant.nw), p
        substeps = max(1, math.ceil(part * scene.substeps - 1e-9))
        held = HeldSteps(plant, part * self.dt, substeps, self.dt * np.arange(self.steps), *given)
        found = held.slopes(x, np.tile(self.u, (self.steps, 1)))
        return found.end, found.slope

    def late_slopes(self, delay: float, machine: Machine | None = None) -> tuple[Array, Array, Array]:
        """A (N, nx, nx), and B (N, nx, nu) of the input that acts in the first `f` of a period, and after it, of the
        whole state. machine: another plant and its parameters, along the same cycle."""
        nx, (_, part) = self.scene.plant.nx, periods_of(delay)
        if not part:
            S = self._moved(1.0, self.x[:-1], machine)[1]
            return S[:, :, :nx], np.zeros_like(S[:, :, nx:]), S[:, :, nx:]
        middle, first = self._moved(part, self.x[:-1], machine)
        second = self._moved(1.0 - part, middle, machine)[1]
        A = second[:, :, :nx]
        return A @ first[:, :, :nx], A @ first[:, :, nx:], second[:, :, nx:]

    def across(self, M: Array) -> Array:
        """Rows of M (N, nx, ..) but the angle's, what has moved along the cycle taken back."""
        along = self.flow[:, self.rest] / self.flow[:, self.angle, None]
        return np.asarray(M[:, self.rest] - along[:, :, None] * M[:, None, self.angle])

    def cost(self, effort: float) -> tuple[Array, Array, Array]:
        """H (N, nx + nu, nx + nu) of a period, its slope (N, nx + nu), and what being on by a radian at its end saves
        (N,)."""
        about, plant = Objective.of(self.scene), self.scene.plant
        t, u, given = self.dt * np.arange(self.steps), np.tile(self.u, (self.steps, 1)), plant.nominal_parameters
        r, J = StageTerms(about, about.residual_expression).values(t, self.x[:-1], u, np.zeros(plant.nw), given)
        Q, R, N = period_cost(J, plant.nx, self.dt, effort)
        slope = self.dt * np.einsum("kri,kr->ki", J, r)
        slope[:, plant.nx :] *= effort
        rate = (r**2).sum(axis=1)
        rate = (rate + np.roll(rate, -1)) / 2  # what a sum over periods sees at the end of each
        ahead = (rate.mean() - rate) / self.flow[:, self.angle] / 2
        H = np.concatenate([np.concatenate([Q, N], 2), np.concatenate([N.transpose(0, 2, 1), R], 2)], 1)
        return H, slope, ahead

    def late(self, delay: float, past: int, effort: float = 1.0, machine: Machine | None = None) -> LateSteps:
        """Steps of z with `past` inputs on their way, of inputs that act `delay` periods late."""
        plant, N, (m, part) = self.scene.plant, self.steps, periods_of(delay)
        nx, nu, nr = plant.nx, plant.nu, plant.nx - 1
        nz = nr + past * nu
        A, B_first, B_after = self.late_slopes(delay, machine)
        H, slope, ahead = self.cost(effort)
        keep = [*self.rest, *range(nx, nx + nu)]
        H, slope = H[:, keep][:, :, keep], slope[:, keep]
        step, cost, linear = np.zeros((N, nz, nz + nu)), np.zeros((N, nz + nu, nz + nu)), np.zeros((N, nz + nu))
        step[:, nr:, nr + nu :] = np.eye(past * nu)
        step[:, :nr, :nr] = self.across(A)[:, :, self.rest]
        linear[:, :nr] = ahead[:, None] * A[:, self.angle, self.rest]
        for share, age, B in ((part, m + 1, B_first), (1.0 - part, m, B_after)):
            if share:
                at = slice(nz, None) if age == 0 else slice(nr + (past - age) * nu, nr + (past - age + 1) * nu)
                places = [*range(nr), *range(*at.indices(nz + nu))]
                step[:, :nr, at] += self.across(B)
                cost[np.ix_(range(N), places, places)] += share * H
                linear[:, places] += share * slope
                linear[:, at] += ahead[:, None] * B[:, self.angle]
        return LateSteps(step, cost, linear)


def deviations(scene: CostedScene, effort: float = 1.0) -> Deviations:
    """The linear-quadratic problem about the cycle of a scene's goal, of inputs that act on time."""
    cycle = Cycle.find(scene)
    return of_cycle(cycle, effort)


def of_cycle(cycle: Cycle, effort: float) -> Deviations:
    """`deviations` of a cycle that is found."""
    found, n = cycle.late(0.0, 0, effort), len(cycle.rest)
    A, B = found.step[:, :, :n], found.step[:, :, n:]
    weights = found.cost[:, :n, :n], found.cost[:, n:, n:], found.cost[:, :n, n:]
    return Deviations(cycle.angle, cycle.turns, cycle.x[:-1], (A, B, *weights), found.slope[:, :n], found.slope[:, n:])


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


def _closed(scene: CostedScene, angle: int, rate: float, turns: int, steps: int) -> Array:
    """x* (steps + 1, nx) under the goal's input, closed but for the turns: Newton's method on all nodes."""
    plant, dt = scene.plant, 2 * math.pi * turns / abs(rate) / steps
    (start, u_goal), given = scene.target, (np.zeros(plant.nw), plant.nominal_parameters)
    nx, u = plant.nx, np.tile(u_goal, (steps, 1))
    x = np.tile(start, (steps + 1, 1)).astype(float)
    x[:, angle] += rate * dt * np.arange(steps + 1)
    held, round_ = HeldSteps(plant, dt, scene.substeps, dt * np.arange(steps), *given), x[-1] - x[0]
    size, miss = 1.0, np.inf
    for _ in range(NEWTON):
        now = held.slopes(x[:-1], u)
        gaps, open_ = now.end - x[1:], x[-1] - x[0] - round_
        miss = float(max(np.abs(gaps).max(), np.abs(open_).max()))
        size = max(float(np.abs(x - x[0]).max(axis=0)[np.arange(nx) != angle].max(initial=0.0)), 1.0)
        if not np.isfinite(miss):
            break
        if miss <= CLOSED * size:
            return x
        whole, pushed = np.eye(nx), np.zeros(nx)
        for A, gap in zip(now.slope[:, :, :nx], gaps):
            whole, pushed = A @ whole, A @ pushed + gap
        # no unique start along the cycle, nor among cycles of other speeds: the shortest step
        dx = np.linalg.lstsq(whole - np.eye(nx), -(open_ + pushed), rcond=1e-9)[0]
        for k in range(steps):
            x[k], dx = x[k] + dx, now.slope[k, :, :nx] @ dx + gaps[k]
        x[-1] += dx
    raise EquilibriumError(f"no cycle about the goal of scene {scene.name!r} is found", miss)
