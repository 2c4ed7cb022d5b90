"""Tube MPC: limits kept although the machine is another and is disturbed, by what its error may take.

    x_{k+1} = A_k x_k + B_k u_k + c_k + w_k,   w_k in W_k,   readings x^_k = x_k + e_k,   |e_k| <= noise

At every sample an MPC plans from the reading, each limit of a period to come moved in by how far the error of that plan
can reach by then (`error_bounds`). Where no such plan is found, the last one goes on under its ancillary law,

    u = v - K (x^ - z),

v and z the plan's inputs and states; K keeps errors small against the limits (`tube_designs`). After "Systems with
persistent disturbances: predictive control with restricted constraints" (Chisci, Rossiter and Zappa 2001), where plans
start at the measured state, and "Robust model predictive control of constrained linear systems with bounded
disturbances" (Mayne, Seron and Rakovic 2005).

Guarantee   a theorem for the linear model above, along a nominal too, with every w in W and every e in the box: where
            one plan keeps its tightened limits (the act is no violation of `record`), inputs and bounded signals keep
            theirs for the `horizon` periods after it, whatever is planned in between. Where `lasting()` is true they do
            for ever: the next such plan always exists. Signals with feedthrough count with the input of their period.
            With `delay` the same of that model with the delay it was told (`late_tubes`), with no other. Not of the
            nonlinear plant. `for_scene` measures W at corners of what is uncertain: that
            other machines, starts and motions stay within it is not shown, nor is it that a first plan is found.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, final

import numpy as np

from pliant.controllers.base.controller import moment, reading
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.base.solver_record import Record
from pliant.controllers.mpc.constraints import Step
from pliant.controllers.mpc.mpc import MPC
from pliant.plants.core.argument_gates import require_count, require_instance
from pliant.plants.core.signals import OwnsArrays

from .disturbance_set import DisturbanceSet
from .error_bounds import Course, Tightening
from .lasting_plans import lasts, out_of_reach
from .late_tubes import asked_instead, on_their_way, periods_of, whole_periods
from .scene_tubes import ROUNDS, tubes_of
from .tightened_steps import largest_share
from .tube_designs import Tubes, about_point, along_nominal, chosen

if TYPE_CHECKING:
    from pliant.plants.core.trajectory import Trajectory
    from pliant.plants.linear.lti import LinearModel
    from pliant.plants.linear.ltv import LTVModel

Array = np.ndarray
Bounds = Mapping[str, tuple[float, float]] | None
ROUNDING = 1e-7  # of a limit's range: excess that is none


@final
@dataclass(eq=False)
class TubeMPC(OwnsArrays):
    """Made by `design`, `along` or `for_scene`. It reads the states of its model.

    Example
    -------
    >>> tubes = TubeMPC.for_scene(scene)
    >>> tubes.share[0] < 1, tubes.dt, len(tubes.reads)
    (True, 0.02, 6)
    >>> tubes.reset()
    >>> tubes.act(0.0, np.zeros(6)).shape, tubes.record.violations
    ((1,), 0)
    """

    mpc: MPC = field(repr=False)  # whose limits are tightened
    course: Course = field(repr=False)  # the model with both laws, along its time
    disturbances: DisturbanceSet = field(repr=False)
    taken: Tightening = field(repr=False)  # of the limits, by the error
    price: float  # of inputs, in the cost of the ancillary law
    c: Array = field(repr=False)  # (.., nx) affine term of the course
    origin: tuple[Array, Array, Array] = field(
        repr=False
    )  # x, u and bounded signals (.., n) that the course counts from, by time
    begins: float = 0.0  # [s] time 0 of the course
    outside: float | None = None  # `for_scene`: what the corners' last motions ask for beyond the set, of a range

    def __post_init__(self) -> None:
        self._kept: tuple[int, Step, Array, Array | None] | None = None  # when, program, what was known, z: of a plan
        self._still: dict[int, tuple[Array, ...]] = {}  # `out_of_reach`, by time

    @classmethod
    def design(
        cls,
        model: LinearModel,
        Q: Any,
        R: Any,
        disturbances: DisturbanceSet,
        *,
        horizon: int = 20,
        dt: float | None = None,
        limits: Any = None,
        bounds: Bounds = None,
        terminal: int = 0,
        penalty: float | None = None,
        start: Any = None,
        delay: int = 0,
        before: Any = None,
    ) -> TubeMPC:
        """On a linear model about a rest; Q, R, horizon, limits, bounds, terminal, penalty, start as MPC.design.

        disturbances: what is added to the model's states (nx,) in each period, in their units. InfeasibleError where
        its effect takes a limit's whole range. delay: whole periods after which an input acts, of a continuous model;
        before (nu,): what acts until the first does, u0 where None.

        Example
        -------
        >>> from pliant.plants import LinearModel
        >>> cart = LinearModel.from_matrices([[0, 1], [0, 0]], [[0], [1]], states=["p", "v"], inputs=["a"])
        >>> wind = DisturbanceSet.box([0.0, 0.02])
        >>> law = TubeMPC.design(cart, np.eye(2), [[1]], wind, dt=0.1, limits=(-1, 1), bounds={"v": (-1, 1)})
        >>> law.act(0.0, np.array([1.0, 0.0])).shape
        (1,)
        """
        require_instance("TubeMPC.design: disturbances", disturbances, DisturbanceSet)
        late = periods_of(model, delay), before
        tubes = about_point(model, Q, R, horizon, dt, (limits, None, bounds, terminal, penalty), start, late)
        return cls._of(tubes, disturbances, len(disturbances.points))

    @classmethod
    def along(
        cls,
        ltv: LTVModel,
        Q: Any,
        R: Any,
        disturbances: DisturbanceSet,
        *,
        horizon: int = 20,
        limits: Any = None,
        bounds: Bounds = None,
        terminal: int = 0,
        penalty: float | None = None,
    ) -> TubeMPC:
        """Along a nominal motion; Q, R, horizon, limits, bounds, terminal, penalty: MPC.along's.

        disturbances: as in `design`, period k from node k of the nominal to the next, in the states' units.

        Example
        -------
        >>> ltv = scene.plant.linearize_along(scene.plant.simulate(scene.initial[0], None, scene.times))
        >>> quiet = DisturbanceSet.box(np.full(6, 1e-6))
        >>> TubeMPC.along(ltv, np.eye(6), [[1.0]], quiet, limits=(-40.0, 40.0)).dt
        0.02
        """
        require_instance("TubeMPC.along: disturbances", disturbances, DisturbanceSet)
        tubes = along_nominal(ltv, Q, R, horizon, (limits, None, bounds, terminal, penalty))
        return cls._of(tubes, disturbances, max(len(ltv.t), len(disturbances.points)))

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        horizon: int = 20,
        *,
        nominal: Trajectory | None = None,
        ranges: Mapping[str, tuple[float, float]] | None = None,
        noise: Mapping[str, float] | None = None,
        terminal: int = 0,
        rounds: int = ROUNDS,
        delay: int = 0,
    ) -> TubeMPC:
        """About a scene's goal or along a nominal, with its cost, limits, bounds and period.

        ranges: smallest and largest factor by name of parameter; +-30 % of what the plant calls uncertain where None.
        noise: largest error by name of reading [its unit]; None: three permille of what each reading does on the way.
        The set is what the model does not foretell where the law is played at the corners of the ranges, of the
        scene's starts and of its gusts (`corner_runs`), with the law of the former round, `rounds` times. PliantError
        where the goal moves and no nominal is given, or a corner runs away; InfeasibleError as in `design`. delay: as
        there, about a goal alone; what acts first is the input of the scene's start, and the corners are played late.

        Example
        -------
        >>> TubeMPC.for_scene(scene, ranges={"payload.mass": (0.7, 1.3)}).outside < 0.01
        True
        """
        require_scene("TubeMPC.for_scene", scene)
        require_count("TubeMPC", "rounds", rounds, 1, 20)
        limited = terminal, rounds, whole_periods(delay)
        tubes, disturbances, outside = tubes_of(scene, horizon, nominal, ranges, noise, *limited)
        made = cls._of(tubes, disturbances, max(len(disturbances.points), len(tubes.origin[0])))
        made.outside = outside
        return made

    @classmethod
    def _of(cls, tubes: Tubes, disturbances: DisturbanceSet, times: int) -> TubeMPC:
        found = chosen("TubeMPC", tubes, disturbances, times)
        course, taken, price = found[1:]
        return cls(MPC(**found.made), course, disturbances, taken, price, tubes.c, tubes.origin, tubes.made["start"])

    @property
    def dt(self) -> float:
        """[s]"""
        return self.mpc.dt

    @property
    def reads(self) -> tuple[str, ...]:
        """The model's states."""
        return self.mpc.reads

    @property
    def record(self) -> Record:
        """Of the acts since `reset`: `violations` are those for which no plan within the tightened limits was found, or
        where a signal that no plan moves in time is outside of them."""
        return self.mpc.record

    @property
    def share(self) -> tuple[float, str]:
        """The most that the error takes of a limit's range, dimensionless, and of which signal."""
        return largest_share(self.taken, self.mpc.limits)

    def lasting(self) -> bool:
        """Whether a plan that keeps its tightened limits always leaves one to the next sample, by linear programs.

        Example
        -------
        >>> law = TubeMPC.for_scene(scene, horizon=10, terminal=0)
        >>> law.lasting()
        False
        """
        mpc = self.mpc
        n = self.taken.u_high.shape[1] - 2
        return lasts(self.course, self.taken, mpc.limits, self.c, self.origin, n, mpc.horizon)

    def reset(self) -> None:
        """Forget the plan and the record."""
        self.mpc.reset()
        self._kept = None

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from the states y (nx,) at time t [s]."""
        mpc, record = self.mpc, self.mpc.record
        before = record.violations + record.failures
        y = reading("TubeMPC.y", y, len(self.reads))
        seen = np.concatenate([y, on_their_way(mpc)])
        u = mpc.act(t, y)
        at = int((moment("TubeMPC", t) - self.begins) / mpc.dt + 0.5)
        if record.violations + record.failures == before and mpc.plan.step is not None and _leaves(self, at, seen):
            self._kept = at, mpc.plan.step, mpc.plan.known.copy(), mpc.plan.z
            return u
        if self._kept is None or not 0 < at - self._kept[0] < mpc.horizon:
            return u
        v, z, K = _planned(self, at)
        u = np.minimum(np.maximum(v - K @ (seen - z), mpc.limits.low), mpc.limits.high)
        asked_instead(mpc, u)
        return u


def _leaves(law: TubeMPC, at: int, seen: Array) -> bool:
    """Whether what no plan of period `at` moves stays within the tightened limits; where not, that is recorded."""
    step, limits = law.mpc.plan.step, law.mpc.limits
    assert step is not None
    k = min(max(at, 0), len(law.taken.u_high) - 1)
    if k not in law._still:
        law._still[k] = out_of_reach(step, law.course, law.taken, limits, law.c, law.origin, k)
    F, low, high, place = law._still[k]
    if not len(F):
        return True
    rows = F @ (seen - law.origin[0][min(k, len(law.origin[0]) - 1)])
    beyond, scale = np.maximum(rows - high, low - rows), limits.ceiling[place] - limits.floor[place]
    if (beyond <= ROUNDING * np.where(np.isfinite(scale), scale, 1.0)).all():
        return True
    worst = np.zeros(len(law.record.names))
    np.maximum.at(worst, place, beyond)
    law.record.violate(worst)
    return False


def _planned(law: TubeMPC, at: int) -> tuple[Array, Array, Array]:
    """Input (nu,) and state (nz,) that the last plan that keeps its limits has at period `at`, and K there."""
    assert law._kept is not None
    first, step, known, free = law._kept
    G, M, fixed = step.plan
    v = G @ known + fixed + (0.0 if free is None else M @ free)
    z, age = known[: law.course.A.shape[-1]].copy(), at - first
    for j in range(age):
        x0, u0, _ = (part[min(first + j, len(part) - 1)] for part in law.origin)
        x1 = law.origin[0][min(first + j + 1, len(law.origin[0]) - 1)]
        A, B = law.course.at(first + j)[:2]
        z = x1 + A @ (z - x0) + B @ (v[j] - u0) + law.c[min(first + j, len(law.c) - 1)]
    return v[age], z, law.course.at(at)[4]
