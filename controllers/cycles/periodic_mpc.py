"""Predictive control of a machine that runs in a cycle: what the limits leave of the periodic regulator.

    min  |z|^2   s.t. inputs and bounded signals within their limits, mu_j = -K_j xi_j - k_j + S_j^(-1/2) z_j

xi, mu count from the cycle by time, from where the machine stands on it by its angle: what it gains or loses in angle
over the horizon is one of the predicted states, so that the bounded signals are those of the angle that it will have.
The cost to go past the horizon is that of the periodic regulator (PeriodicLQR) at that node, so that z = 0 is the
optimum without limits, and the first input then the regulator's, to rounding. The program is that of the nearest node.
Signals' limits are soft, as in MPC. Where the solver fails the regulator goes on within the limits; that is recorded.

Guarantee   where no limit is active, that of PeriodicLQR. None beyond: the horizon's end has no terminal set.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Self, final

import numpy as np

from pliant.controllers.base.controller import moment, reading
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.base.solver_record import Record
from pliant.controllers.mpc.condensed_prediction import Laws, Prediction, predict
from pliant.controllers.mpc.constraints import Limits, Step, Window, build, soft_names
from pliant.controllers.mpc.design import limits_of, penalty_at
from pliant.controllers.mpc.exact_penalty import WithoutExcess, kept
from pliant.controllers.riccati.late_inputs import delay_range, past_of, periods_of
from pliant.plants.core.argument_gates import require_count, require_number
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear.quadratic_cost import signal_rows

from .by_angle import ByAngle
from .cycle import Cycle
from .periodic_lqr import PeriodicLQR

Array = np.ndarray
POINTS = 3  # nodes at which the penalty is found


@final
class PeriodicMPC(OwnsArrays):
    """Made by `for_scene`. It reads the plant's states.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> law = PeriodicMPC.for_scene(scenes.get("slider-crank-run"), horizon=5)
    >>> law.act(0.0, np.array([0.0, 0.0, 0.0, 15.08, 0.0, 0.0])).shape
    (1,)
    """

    def __init__(
        self, law: PeriodicLQR, nodes: ByAngle, steps: tuple[Step, ...], limits: Limits, names: tuple[str, ...]
    ) -> None:
        """law: without limits; steps: by node, in time, of `limits`; names: of the soft ones."""
        self.law, self.limits, self.record = law, limits, Record(names)
        self._nodes, self._steps, self._firm = nodes, steps, WithoutExcess()
        self.horizon = len(steps[0].plan[0])
        self.penalty = steps[0].solver.penalty  # of a soft limit exceeded by half its range
        self.reset()

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        horizon: int = 20,
        *,
        effort: float = 1.0,
        delay: float | tuple[float, float] = 0.0,
        bounds: Mapping[str, tuple[float, float]] | None = None,
        penalty: float | None = None,
    ) -> Self:
        """About the cycle of a scene's goal, with its cost, limits and bounds.

        horizon: control periods. effort, delay [periods]: as of PeriodicLQR.for_scene; of a range the prediction is
        that of the middle. bounds: (lowest, highest) of states or outputs by name, the scene's where None. penalty:
        cost of exceeding a bound by half its range at one step; None: bounds are exceeded only where no plan over the
        horizon is found that keeps them. EquilibriumError where the goal is no cycle.
        """
        require_scene("PeriodicMPC.for_scene", scene)
        horizon = require_count("PeriodicMPC", "horizon", horizon, 1, 1000)
        effort = require_number("PeriodicMPC.for_scene.effort", effort, "positive")
        penalty = None if penalty is None else require_number("PeriodicMPC.penalty", penalty, "positive")
        late = delay_range("PeriodicMPC", delay)
        known = {name: (-value, value) for name, value in scene.bounds} if bounds is None else bounds
        cycle, high = Cycle.find(scene), np.array(scene.limits, dtype=float)
        law = PeriodicLQR.about(cycle, effort, late)
        limits = limits_of(scene.plant.linearize(cycle.x[0], cycle.u), (-high, high), None, known, scene.dt)
        steps = _programs(cycle, law, sum(late) / 2, horizon, limits, penalty)
        nodes = ByAngle(cycle.x[:-1, cycle.angle])
        return cls(law, nodes, steps, limits, soft_names(limits, horizon, horizon))

    @property
    def dt(self) -> float:
        """[s]"""
        return self.law.dt

    @property
    def reads(self) -> tuple[str, ...]:
        """The plant's states."""
        return self.law.reads

    def reset(self) -> None:
        """Forget the inputs on their way, the last active set and the record."""
        self.record.clear()
        self.law.reset()
        self._firm.forget()
        for step in self._steps:
            step.solver.forget()

    def act(self, t: float, y: Array) -> Array:
        """u (nu,) from the states y (nx,)."""
        y = reading("PeriodicMPC.y", y, len(self.reads))
        moment("PeriodicMPC", t)
        u, off = self.law.unlimited(y)
        at = self._nodes.nearest(y[self.law.angle])
        step, m = self._steps[at], len(self._steps[at].low)
        rows = step.G[:m] @ off
        lower, upper = step.low - rows, step.high - rows
        self.record.calls += 1
        if m and (upper.min() < 0.0 or lower.max() > 0.0):
            self.record.limited += 1
            z = step.solver.solve(lower, upper)
            if z is None:
                self.record.failures += 1
            else:
                if step.solver.violated:
                    z, _ = kept(self._firm, at, step, z, (lower, upper), self.record)
                u = u + step.first @ z
        u = np.minimum(np.maximum(u, self.limits.low), self.limits.high)
        self.law.asked(u)
        return u


def _programs(
    cycle: Cycle, law: PeriodicLQR, delay: float, horizon: int, limits: Limits, penalty: float | None
) -> tuple[Step, ...]:
    """One program for each node, in time, of deviations [by time from the node; inputs on their way]."""
    A, B, found = _by_time(cycle, law, delay)
    scene, N, nz = cycle.scene, cycle.steps, A.shape[1]
    models = [scene.plant.linearize(x, cycle.u) for x in cycle.x[:-1]]
    rows = [signal_rows(model, limits.bounded, "PeriodicMPC.bounds: state or output") for model in models]
    C, D, z = (np.array([row[i] for row in rows]) for i in range(3))
    C = np.concatenate([C, np.zeros((N, C.shape[1], nz - C.shape[2]))], axis=2)
    if (acts := past_of(delay)) > 0:  # what acts at a sample was asked for so many periods ago
        at = nz - acts * D.shape[2]
        C[:, :, at : at + D.shape[2]] += D
        D = np.zeros_like(D)
    none, u = np.zeros((horizon, nz)), np.tile(cycle.u, (horizon, 1))

    def motion(k: int) -> tuple[Prediction, Window]:
        one = np.arange(k, k + horizon) % N
        on = np.arange(k, k + horizon + 1) % N
        made = predict(A[one], B[one], none, Laws(*(part[one] for part in found)), horizon)
        return made, Window(u, np.zeros(nz), z[on], C[on], D[on], direct=np.asarray(D.any(axis=(0, 2))))

    if penalty is None:
        penalty = 0.0
        for k in np.linspace(0, N, POINTS, endpoint=False).astype(int):
            made, window = motion(k)
            hard = build(made, window, limits, horizon, None, hard=True)
            penalty = max(penalty, penalty_at(hard, A[k], B[k], window, limits, found.root[k:]))
    return tuple(build(*motion(k), limits, horizon, penalty) for k in range(N))


def _by_time(cycle: Cycle, law: PeriodicLQR, delay: float) -> tuple[Array, Array, Laws]:
    """A (N, nz, nz), B (N, nz, nu) of the whole state and the inputs on their way, and the law of PeriodicLQR in it."""
    plant, made, past = cycle.scene.plant, law.regulator, past_of(law.delay[1])
    nx, nu, N, rest = plant.nx, plant.nu, cycle.steps, cycle.rest
    moved, first, after = cycle.late_slopes(delay)
    nz, (m, _) = nx + past * nu, periods_of(delay)
    A, B = np.zeros((N, nz, nz)), np.zeros((N, nz, nu))
    A[:, :nx, :nx] = moved
    A[:, nx:, nx:] = np.eye(past * nu, k=nu)
    for one, age in ((first, m + 1), (after, m)):
        if age == 0:
            B[:, :nx] += one
        elif one.any():
            at = nz - age * nu
            A[:, :nx, at : at + nu] += one
    if past:
        B[:, nz - nu :] = np.eye(nu)
    flow = np.roll(cycle.flow, 1, axis=0)  # where the steps begin
    across = np.zeros((N, nz - 1, nz))
    across[:, :, [*rest, *range(nx, nz)]] = np.eye(nz - 1)
    across[:, : nx - 1, cycle.angle] = -flow[:, rest] / flow[:, cycle.angle, None]
    root = np.linalg.cholesky((made.S + made.S.transpose(0, 2, 1)) / 2).transpose(0, 2, 1)
    return A, B, Laws(made.K @ across, made.k, root, made.P, made.p)
