"""Model predictive control of linear models: what the limits leave of an optimal plan, anew at every sample.

    min  sum_j xi_j'Q xi_j + mu_j'R mu_j + 2 xi_j'N mu_j + xi_n'P xi_n + penalty * (excess over soft limits)
    s.t. xi_{j+1} = A_j xi_j + B_j mu_j + c_j; inputs and their changes within limits; bounded signals softly so

xi, mu count from a goal, a nominal motion or an estimated steady target. P is the cost to go without limits, so that
without active limits the first input is that of LQR or of its time-varying kin, to rounding. Inputs obey their limits
exactly; the limits of signals are soft, so that there always is a plan, and what the plan exceeds them by is recorded.
Should the solver fail, that is recorded, and the last plan goes on; past its end, the unlimited law within the limits.
`design` and `ltv_design` build everything; an act is one product, and a solve where the unlimited plan breaks one.

Guarantee   where no limit is active, that of the LQR of its model and of the delay that it was told; none with other
            parameters or delays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import TYPE_CHECKING, Any, Self, final

import numpy as np

from pliant.controllers.base.controller import moment, reading
from pliant.controllers.base.goal_model import unmoved
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.base.solver_record import Record
from pliant.plants.core.argument_gates import require_by_name, require_instance
from pliant.plants.core.signals import owned, sealed
from pliant.plants.core.trajectory import Trajectory

from .constraints import Limits, Step
from .design import regulator
from .exact_penalty import WithoutExcess, kept
from .fallback_plan import LastPlan
from .knowledge import Knowledge
from .ltv_design import about_goal, follower
from .offset_free import Estimator
from .steady_target import Target

if TYPE_CHECKING:
    from pliant.plants.linear.lti import LinearModel
    from pliant.plants.linear.ltv import LTVModel

NEVER = -2  # a time index whose neighbour does not exist


@final
class MPC:
    """Made by `design`, `along` or `for_scene`. It reads the states of its model, or outputs where it estimates."""

    def __init__(
        self,
        steps: Sequence[Step],
        limits: Limits,
        reads: tuple[str, ...],
        dt: float,
        start: float,
        origin: tuple[np.ndarray, np.ndarray, np.ndarray],
        names: tuple[str, ...] = (),
        estimator: Estimator | None = None,
        target: Target | None = None,
        tracked: Mapping[str, float] | None = None,
        exact: bool = False,
        left: tuple[tuple[str, ...], tuple[str, ...]] = ((), ()),
        late: tuple[tuple[float, float], np.ndarray] | None = None,
    ) -> None:
        """steps: one, or one for each time from `start` [s] on, the last of which stays. origin: the model's x0, u0,
        and the readings there. tracked: signals, and their values at the origin, which are brought to `aim`. exact:
        whether a plan that exceeds a soft limit is made again with hard ones. late: the inputs' (shortest, longest)
        delay [periods], and those on their way at the start (M nu,).
        """
        self._made = steps, limits, reads, dt, start, origin, names, estimator, target, tracked, exact, left, late
        self.delay = (0.0, 0.0) if late is None else late[0]
        self.conserved, self.free = left  # in words: what no input changes, what only inputs do and nothing feels
        self.dt, self.reads, self.limits, self.record = dt, reads, limits, Record(names)
        self.tracked, self.horizon = dict(tracked or {}), len(steps[0].plan[0])
        self.penalty = max(step.solver.penalty for step in steps)  # of a soft limit exceeded by half its range
        self.origin, self.exact, self._firm = origin, exact, WithoutExcess() if exact else None
        self._steps, self._start, self._latest = tuple(steps), start, len(steps) - 1
        self._drift: np.ndarray | None = None  # (len(reads),) [1/s] of a goal that moves, from t = 0 on
        self._ny, m, size = len(reads), len(steps[0].low), steps[0].G.shape[1]
        self._d, self._lower, self._upper = np.empty(m + len(limits.low)), np.empty(m), np.empty(m)
        self._rows, self._free, self._limits = self._d[:m], self._d[m:], m > 0
        wanted = estimator is not None or limits.remembers or late is not None  # else a reading is all there is to know
        known = origin, limits, estimator, target, self.tracked, None if late is None else late[1]
        self._knowledge = Knowledge(size, *known) if wanted else None
        self._low, self._high, self._clips = limits.low, limits.high, bool(np.isfinite([limits.low, limits.high]).any())
        self.plan, self._shift = LastPlan(self.horizon, size), np.zeros(m)
        self.reset()

    @classmethod
    def design(
        cls,
        model: LinearModel,
        Q: Any,
        R: Any,
        *,
        N: Any = None,
        P: Any = None,
        horizon: int = 20,
        dt: float | None = None,
        limits: Any = None,
        rates: Any = None,
        bounds: Mapping[str, tuple[float, float]] | None = None,
        blocks: Sequence[int] | None = None,
        terminal: int = 0,
        penalty: float | None = None,
        reads: Sequence[str] | None = None,
        track: Sequence[str] = (),
        disturbance: str | None = None,
        time: float = 0.2,
        noise: float | Mapping[str, float] = 1e-2,
        start: Any = None,
        delay: Any = 0.0,
        before: Any = None,
    ) -> Self:
        """On a linear model about an equilibrium.

        model: continuous, then dt [s] is needed and the cost is integrated exactly over each step, as in LQR.design;
        or sampled, then Q, R, N are weights of a step. Q, R: arrays or by name as there, N (nx, nu); P (nx, nx):
        terminal weight, None: cost to go of the unlimited problem. limits: of the inputs, as in LQR.design. rates:
        largest |du/dt|, a number, (nu,) or by name. bounds: (lowest, highest) of states or outputs by name, soft.
        blocks: lengths of the pieces on which inputs are constant, which add up to the horizon. terminal: steps past
        the horizon on which the limits are looked at, softly, under the unlimited law: enough are its output admissible
        set ("Linear Systems with State and Control Constraints", Gilbert and Tan 1991). penalty: cost of exceeding a
        bound by half its range (by itself where it has one side) at one step; None: bounds are exceeded only where no
        plan over the horizon keeps all of them (exact_penalty.py).

        track: states or outputs brought without steady error to their values at the model's point, or to what `aim`
        says, by an estimate of a `disturbance` of the "states" (the default), "inputs" or "outputs" (offset_free.py);
        `reads` names the states or, for the last two, measured outputs. time [s] of the estimate; noise: deviation of
        readings where that of inputs, and of drifts over `time`, is one unit; or by name (see `offset_free.Sizes`).
        What is conserved or free is left as in LQR.design, `start` (nx,) as there (of a continuous model, P None).
        delay [periods] of the inputs, or (shortest, longest), and before (nu,): as there; a continuous model, P and
        track left out.
        """
        weights, limited, offset = (Q, R, N, P), (limits, rates, bounds, terminal, penalty), (track, disturbance, time)
        return cls(
            **regulator(model, weights, horizon, dt, limited, blocks, reads, (*offset, noise), start, (delay, before))
        )

    @classmethod
    def along(
        cls,
        ltv: LTVModel,
        Q: Any,
        R: Any,
        *,
        P: Any = None,
        horizon: int = 20,
        limits: Any = None,
        rates: Any = None,
        bounds: Mapping[str, tuple[float, float]] | None = None,
        blocks: Sequence[int] | None = None,
        terminal: int = 0,
        penalty: float | None = None,
        reads: Sequence[str] | None = None,
    ) -> Self:
        """Along a nominal with nodes dt apart, past whose end the last node stays, which should be an equilibrium.

        The cost is the sum over steps of dt times the rate x'Qx + u'Ru of deviations from the nominal; P (nx, nx)
        weighs the state at the end of the last step's horizon, None: the cost to go there. Q, R, limits, rates,
        bounds, blocks, terminal and penalty as in `design`."""
        return cls(**follower(ltv, (Q, R, P), horizon, (limits, rates, bounds, terminal, penalty), blocks, reads))

    @classmethod
    def for_scene(
        cls, scene: CostedScene, horizon: int = 20, *, nominal: Trajectory | None = None, **options: Any
    ) -> Self:
        """About a scene's goal (ValueError: it moves, outputs are read) or along a nominal; options go first."""
        Q, R = dict(require_scene("MPC.for_scene", scene).weights), dict(scene.effort)
        bounds = {name: (-value, value) for name, value in scene.bounds}
        given: dict[str, Any] = {"horizon": horizon, "limits": _both(scene.limits), "bounds": bounds} | options
        if nominal is not None:
            require_instance("MPC.for_scene: nominal", nominal, Trajectory)
            return cls.along(scene.plant.linearize_along(nominal), Q, R, **given)
        return _about_goal(cls, scene, Q, R, given)

    def reset(self) -> None:
        """Forget the last input (then u0, or the limit next to it), the plan, the disturbance and the record."""
        self.record.clear()
        kept: list[Any] = [*(step.solver for step in self._steps), self.plan]
        for one in kept if self._firm is None else [*kept, self._firm]:
            one.forget()
        if self._knowledge is not None:
            self._knowledge.reset()
        self._at, self._multipliers = NEVER, np.zeros(len(self._shift))

    def aim(self, values: Mapping[str, float]) -> None:
        """Bring tracked signals to other values, each in its own unit; they start at the model's point."""
        if (known := self._knowledge) is not None:
            known.aim(require_by_name("MPC.aim: values", values, tuple(self.tracked), "tracked signal"))

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from y (len(reads),) at time t [s]."""
        y = reading("MPC.y", y, self._ny)
        if self._drift is not None:
            y = y - self._drift * moment("MPC", t)
        at = min(max(int((moment("MPC", t) - self._start) / self.dt + 0.5), 0), self._latest) if self._latest else 0
        step = self._steps[at]
        known = y
        if self._knowledge is not None:
            known = self._knowledge(y)
            self.record.unreached += self._knowledge.missed
        self.record.calls += 1
        np.dot(step.G, known, out=self._d)
        lower = np.subtract(step.low, self._rows, out=self._lower)
        upper = np.subtract(step.high, self._rows, out=self._upper)
        u = step.u + self._free
        if self._limits and (upper[upper.argmin()] < 0.0 or lower[lower.argmax()] > 0.0):
            z = self._solve(step, at)
            if z is not None:
                u += step.first.dot(z)
                self.plan.keep(step, known, z)
            elif (planned := self.plan.go_on()) is not None:
                u = planned
        else:
            self.plan.keep(step, known, None)
        if self._clips:
            np.maximum(u, self._low, out=u)
            np.minimum(u, self._high, out=u)
        return u if self._knowledge is None else self._knowledge.remember(u)

    def _solve(self, step: Step, at: int) -> np.ndarray | None:
        """z, from the last active set: that of the solver itself, or of its neighbour in time moved on by one step."""
        self.record.limited += 1
        warm = None
        if self._latest and at == self._at + 1:
            warm, k = self._shift, step.stride
            warm[:-k], warm[-k:] = self._multipliers[k:], 0.0
        z = step.solver.solve(self._lower, self._upper, warm)
        if z is None:
            self.record.failures += 1
            self._at = NEVER
            return None
        self._at, self._multipliers = at, step.solver.multipliers
        if step.solver.violated:
            z, self._multipliers = kept(self._firm, at, step, z, (self._lower, self._upper), self.record)
        return z

    def __copy__(self) -> Self:
        return deepcopy(self)  # solver and estimate are not to be shared

    def __reduce__(self) -> tuple[Any, ...]:  # a copy goes on as the original would, and apart from it
        known = None if self._knowledge is None else self._knowledge.state
        made = *self._made[:-2], (self.conserved, self.free), self._made[-1]
        return _again, sealed((made, self._drift, self.record, self.plan, known, self._at, self._multipliers))


def _both(limits: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest inputs of a scene's limits."""
    high = np.array(limits, dtype=float)
    return -high, high


def _about_goal(cls: type[MPC], scene: CostedScene, Q: Any, R: Any, given: dict[str, Any]) -> MPC:
    """`design` about a scene's goal, moving or not."""
    model, drift, given["bounds"], start = about_goal(scene, given["bounds"])
    first = {"start": start, "before": np.clip(scene.initial[1], *_both(scene.limits))}
    made = cls.design(model, Q, R, dt=scene.dt, **{**first, **given})
    made.conserved, made.free = unmoved(scene)
    if drift is not None and len(made.reads) != len(drift):
        raise ValueError(f"MPC.for_scene: the goal of {scene.name!r} moves, MPC must read the states, not outputs")
    made._drift = drift
    return made


def _again(*state: Any) -> MPC:
    """With the state that another had."""
    made, drift, record, plan, known, at, multipliers = owned(state)
    controller = MPC(*made)
    controller._drift, controller.record, controller.plan = drift, record, plan
    controller._at, controller._multipliers = at, multipliers
    if controller._knowledge is not None and known is not None:
        controller._knowledge.state = known
    return controller
