"""Nonlinear model predictive control by the real-time iteration (Diehl, Bock, Schloeder, "A real-time iteration scheme
for nonlinear optimization in optimal feedback control", 2005).

min  sum_k dt |r(x_k, u_k)|^2 + (x_N - goal)'P (x_N - goal)     over a horizon of N control periods
     x_{k+1} = F(x_k, u_k), limits of the inputs, bounds of named signals at a price

One Gauss-Newton step a sample. Before the measurement, `prepare`: the plan of the last sample, a period on, is
linearised and condensed. With it, `feedback`: one quadratic program in the inputs, whose first is applied. Where that
has no solution the plan's own next input is applied and the failure recorded.

The program is condensed: for the two-link arm of 12 states over 30 periods that and DAQP take 0.19 ms together, a tenth
of it after the measurement, where HPIPM takes 0.6 ms on the stages as they are. Measured with both in one process.
Of more than 150 inputs (`condensing.LONG`) it is condensed only where a limit or a bound binds, else solved stage by
stage: the published arm of three joints over 125 periods takes 5.3 ms of processor time a period so, in place of 8.3.

Guarantee   none: one iteration a period, no terminal set; a delay is taken for known, of a range a quarter of it.
            Told a delay that is longer than the true one a loop is lost sooner than told a shorter one.
"""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass
from time import perf_counter
from typing import Any, NamedTuple, Self, final

import numpy as np

from pliant.controllers.base.controller import moment, reading
from pliant.controllers.base.objective import Objective
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.base.solver_record import Record
from pliant.controllers.linear_quadratic.state_ahead import StateAhead
from pliant.controllers.riccati.late_inputs import delay_range
from pliant.plants.core.argument_gates import as_tuple, require_count, require_finite, require_instance, require_number
from pliant.plants.core.errors import IntegrationError, PliantError
from pliant.plants.core.signals import owned, sealed

from .gauss_newton import converge
from .horizon import Horizon
from .horizon_qp import HorizonProgram
from .terminal_cost import MovingEnd, end_of, fewest_substeps

Array = np.ndarray
ROUGH = 1e-6  # share of gaps in a plan's cost
FIRST = 1e-3  # of half an input's range: change that a first plan may still see
VIOLATED = 1e-6  # of half a bound's range: excess that is none
WITHIN = 0.25  # of a range of delays: where in it the plan is for


@dataclass
class IterationRecord(Record):
    """A `Record` with what a real-time iteration adds. An act without a solution takes the shifted plan's input."""

    in_a_row: int = 0  # failures, up to now
    why: str = ""  # the solver's word on the last of them
    damped: int = 0  # acts whose plan was rough: its change was kept near the regulator's
    iterations: int = 0  # most changes of the active set in one act
    preparation: float = 0.0  # [s] of the last act
    feedback: float = 0.0  # [s]

    def clear(self) -> None:
        """As new."""
        super().clear()
        self.in_a_row = self.damped = self.iterations = 0
        self.why, self.preparation, self.feedback = "", 0.0, 0.0


class Converged(NamedTuple):
    """The solution of the horizon's problem from one state."""

    x: Array  # (N+1, nx)
    u: Array  # (N, nu)
    cost: float
    iterations: int
    change: float  # of the last step, the largest of an input over its scale


@final
class NMPC:
    """Reads the plant's states. `objective`: what is charged, the limits and the bounds (soft)."""

    def __init__(
        self,
        objective: Objective,
        horizon: int,
        *,
        substeps: int | None = None,
        terminal: Any = "riccati",
        penalty: float = 1e3,
        starts: tuple[Array, ...] = (),
        first_steps: int = 20,
        iteration_limit: int = 1000,
        delay: float | tuple[float, float] = 0.0,
        before: Any = None,
    ) -> None:
        """horizon: control periods; substeps: RK4 steps in each, None for the fewest that are stable and fine enough.

        terminal: "riccati", the cost-to-go of the regulator about the goal; P (nx, nx) >= 0; a `MovingEnd`, as a cycle
        has (`periodic_nmpc`); or None, which warns where the horizon is short. penalty: cost of leaving a bound by half
        its range at one node, linear. starts: states (nx,) that the choice of substeps is to serve. first_steps: Gauss-
        Newton steps, at most, on the first plan after `reset`. iteration_limit: of the quadratic program's active-set
        changes. delay: after how many periods an input acts, 1.5 say; the plan begins at the state that the plant's own
        steps take the reading to by then, of a range (shortest, longest) after a quarter of it. before (nu,): what acts
        until the first input does; the goal's where None.
        """
        require_instance("NMPC.objective", objective, Objective)
        horizon = require_count("NMPC", "horizon", horizon, 1, 10_000)
        first_steps = require_count("NMPC", "first_steps", first_steps, 1, 1000)
        iteration_limit = require_count("NMPC", "iteration_limit", iteration_limit, 0, 1_000_000)
        substeps = None if substeps is None else require_count("NMPC", "substeps", substeps, 1, 100_000)
        penalty = require_number("NMPC.penalty", penalty, "positive")
        listed = (
            tuple(starts) if isinstance(starts, np.ndarray) and starts.ndim == 2 else as_tuple("NMPC.starts", starts)
        )
        states = (objective.plant.nx,)
        starts = tuple(require_finite(f"NMPC.starts[{i}]", x, states) for i, x in enumerate(listed))
        low, high = delay_range("NMPC", delay)
        late = low + WITHIN * (high - low)
        first = objective.u_goal if before is None else require_finite("NMPC.before", before, (objective.plant.nu,))
        self._made = (substeps, terminal, penalty, starts, first_steps, iteration_limit, late, first)
        if not np.linalg.eigvalsh(objective.quadratic()[1]).min() > 0:
            names = ", ".join(s.name for s in objective.plant.inputs)
            raise ValueError(f"NMPC.objective.effort = {dict(objective.effort)} must price every input: {names}")
        self.objective, self.first_steps = objective, first_steps
        self.record = IterationRecord(tuple(objective.bounds))
        self.substeps = fewest_substeps(objective, *starts) if substeps is None else substeps
        self.end = terminal if isinstance(terminal, MovingEnd) else None
        P, self.law = (None, None) if self.end else end_of(objective, terminal, self.substeps, horizon)
        self.horizon = Horizon(objective, horizon, self.substeps, P, self.law, self.end)
        self._program = HorizonProgram(self.horizon, penalty, iteration_limit)
        self.delay = late
        self._ahead = StateAhead(objective.plant, objective.dt, late, self.substeps, first) if late else None
        self.reset()

    @classmethod
    def for_scene(cls, scene: CostedScene, horizon: int = 30, **options: Any) -> Self:
        """On the scene's plant, cost, limits and bounds; its start decides on the substeps. Options as above."""
        require_scene("NMPC.for_scene", scene)
        high = np.array(scene.limits, dtype=float)
        given = {"starts": (scene.initial[0],), "before": np.clip(scene.initial[1], -high, high)}
        return cls(Objective.of(scene), horizon, **{**given, **options})

    @property
    def dt(self) -> float:
        """Control period [s]."""
        return self.objective.dt

    @property
    def reads(self) -> tuple[str, ...]:
        """The plant's states."""
        return tuple(s.name for s in self.objective.plant.states)

    def reset(self) -> None:
        """Forget plan and record; the next `act` makes a first plan, which takes several times as long."""
        self.record.clear()
        self._program.solver.forget()
        self.horizon.forget()
        if self._ahead is not None:
            self._ahead.reset()
        self._ready = False
        self._taken: tuple[Array, Array, Array] | None = None  # (y, e, d) of the last feedback

    def act(self, t: float, y: Array) -> Array:
        """u (nu,) at time t [s] from the states y (nx,); then prepares for t + dt."""
        if not self._ready:
            self.start(t, y)
        u = self.feedback(y)
        self.prepare()
        return u

    def start(self, t: float, y: Array) -> None:
        """The first plan from about y (nx,) at t [s], by up to `first_steps` Gauss-Newton steps, and its preparation.

        May be called before the first measurement, with the state that is expected.
        """
        y = self._met(y)
        plan = self.horizon
        plan.t = moment("NMPC", t) + self.delay * self.dt
        self._line(y)
        _, change = converge(self._program, y, self.first_steps, 1e-6)
        plan.hold(change > FIRST)
        self._program.linearize()
        self._ready = True

    def feedback(self, y: Array) -> Array:
        """u (nu,) from the states y (nx,), on what `prepare` (or `start`) has ready."""
        begin = perf_counter()
        if not self._ready:
            raise PliantError("NMPC.feedback has no plan yet: start(t, y) makes the first")
        y = self._met(y)
        plan, program, record = self.horizon, self._program, self.record
        e = y - plan.x[0]
        d = program.solve(e)
        record.calls += 1
        record.iterations = max(record.iterations, program.solver.iterations)
        if d is None:
            record.failures += 1
            record.in_a_row += 1
            record.why = program.why
            d = np.zeros(plan.u.size)
        else:
            record.in_a_row = 0
            record.limited += program.solver.limited
            if program.solver.violation > VIOLATED:
                record.violate(program.excess)
        self._taken = y.copy(), e, d
        u = plan.u[0] + d[: len(plan.u[0])]
        np.minimum(np.maximum(u, program.lowest, out=u), program.highest, out=u)
        if self._ahead is not None:
            self._ahead.remember(u.copy())
        record.feedback = perf_counter() - begin
        return u

    def prepare(self) -> None:
        """Take up the step of the last `feedback`, move on by a period and linearise."""
        begin = perf_counter()
        plan, goal = self.horizon, self.objective
        if self._taken is None:
            raise PliantError("NMPC.prepare follows a feedback(y)")
        y, e, d = self._taken
        self._taken = None
        if self._program.sound:
            plan.move(e, d)
            # u + (limit - u) may round past the limit
            np.clip(plan.u, self._program.lowest, self._program.highest, out=plan.u)
        else:
            plan.x[:] = y  # the plan was no motion: begin again from what was measured, with its inputs
        tail = plan.u[-1] if self.law is None else goal.u_goal - self.law.K @ (plan.x[-1] - plan.goal)
        tail = self.end.tail(plan.x[-1]) if self.end else tail
        plan.shift(np.minimum(np.maximum(tail, self._program.lowest), self._program.highest))
        self._program.linearize(close=True)
        self.record.damped += plan.damping > 0
        plan.hold(not plan.roughness <= ROUGH or self.record.in_a_row > 0)
        self.record.preparation = perf_counter() - begin

    def iterate(self, x: Array, *, t: float = 0.0, tolerance: float = 1e-9, limit: int = 100) -> Converged:
        """Gauss-Newton steps from the present plan (after `reset`: from a line to the goal) until inputs change by
        less than `tolerance` of half their range. PliantError where they do not within `limit` steps. x (nx,), t [s].
        """
        x = require_finite("NMPC.x", x, (self.objective.plant.nx,))
        tolerance = require_number("NMPC.tolerance", tolerance, "positive")
        limit = require_count("NMPC", "limit", limit, 1, 1_000_000)
        plan = self.horizon
        plan.t = moment("NMPC", t)
        if not self._ready:
            self._line(x)
        self._ready = True
        steps, change = converge(self._program, x, limit, tolerance)
        if not change <= tolerance:
            raise PliantError(
                f"NMPC.iterate: inputs still change by {change:.2g} of half their range after {steps} steps, must be "
                f"{tolerance:g}: {self._program.why or 'start nearer, or allow more steps'}"
            )
        return Converged(plan.x.copy(), plan.u.copy(), plan.cost(), steps, change)

    def _met(self, y: Array) -> Array:
        """The state (nx,) that the next input meets. IntegrationError where the plant diverges on the way."""
        y = reading("NMPC.y", y, self.objective.plant.nx)
        x = y if self._ahead is None else self._ahead(y)
        if not np.isfinite(x).all():
            raise IntegrationError(f"NMPC: the model diverges within {self.delay:g} periods from {y}", 0.0, y, self.dt)
        return x

    def _line(self, x: Array) -> None:
        """A first guess: the straight line from x to the goal, under the goal's input; or that of an end that moves."""
        plan, goal = self.horizon, self.objective
        line = x + np.linspace(0.0, 1.0, plan.N + 1)[:, None] * (plan.goal - x), goal.u_goal
        plan.x[:], plan.u[:] = line if self.end is None else self.end.guess(x, plan.N)

    def __copy__(self) -> Self:
        return deepcopy(self)  # plan and workspace are not to be shared

    def __reduce__(self) -> tuple[Any, ...]:
        """A copy goes on as the original would, and apart from it."""
        plan = self.horizon
        near, taken = self._program.solver.near, (self._taken, self._ahead)
        state = plan.t, plan.x, plan.u, plan.damped, plan.damping, near, self._ready, *taken
        return _remade, sealed((self.objective, plan.N, self._made, self.record, state))


def _remade(
    objective: Objective, horizon: int, made: tuple[Any, ...], record: IterationRecord, state: tuple[Any, ...]
) -> NMPC:
    """Another with the same design and state: its plan is linearised again."""
    made, state = owned((made, state))
    names = ("substeps", "terminal", "penalty", "starts", "first_steps", "iteration_limit", "delay", "before")
    found = NMPC(objective, horizon, **dict(zip(names, made)))
    plan, found.record = found.horizon, record
    plan.t, plan.x[:], plan.u[:], plan.damping, damping, found._program.solver.near, found._ready, found._taken = state[
        :8
    ]
    found._ahead = state[8]
    if found._ready:
        found._program.linearize()
        plan.damping = damping
    return found
