"""TVLQR: a regulator of the deviations from a nominal motion, by time or by phase, held at its end.

Law    u = u*_k - K_k (x - x*_k), within the limits, held over dt
Cost   J = sum_k dx'Q dx + du'R du + 2 dx'N du + dx_T'P_T dx_T   of deviations from the nominal

K_k is the discrete Riccati recursion of dx+ = A_k dx + B_k du + c_k: of a plant A_k, B_k, c_k are its own control
period, the input held, and the nominal's defect. (x*, u*) is what the law itself makes of the nominal from its start:
the nominal where that is a motion of the plant; else, for one that a rigid plant made, it holds the feedforward that
the affine terms ask for.

By time, k = t / dt. By phase, k moves on to the nearest of the next nodes, between `slowest` and `fastest` nodes a
period: a plant that lags is not pulled after a clock. After the end: the regulator about the goal, where one is given.

Guarantee   none for the plant; `funnel` tells the region in which the linear loop along the nominal stays within
            limits.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, final

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.controller import moment, reading, saturation, share
from pliant.controllers.base.goal_model import goal_model, unmoved
from pliant.controllers.base.objective import Objective
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.optimal_control.nominal_motions import chosen_nominal, nodes, nodes_of, nominal_for
from pliant.controllers.optimal_control.optimal import Motion
from pliant.controllers.optimal_control.shooting_derivatives import HeldSteps
from pliant.controllers.optimal_control.stage_derivatives import StageTerms
from pliant.controllers.riccati.node_distance import joined, measured, refined
from pliant.controllers.riccati.time_varying import TimeVaryingRegulator
from pliant.plants.core.argument_gates import (
    require_choice,
    require_count,
    require_finite,
    require_instance,
    require_number,
    require_seconds,
)
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant
from pliant.plants.linear.ltv import LTVModel

from .funnel import Funnel
from .held_goal import held_by_model, held_by_plant
from .hold_set import Hold, given_hold
from .nominal_loop import PathProgress, own_nominal
from .period_cost import law_at_goal, period_cost

INDICES = ("time", "phase")


@final
@dataclass(eq=False)
class TVLQR(OwnsArrays):
    """Made by `along`, `design` or `for_scene`."""

    dt: float  # [s]
    reads: tuple[str, ...]
    nominal: np.ndarray  # (T+1, nx) states as given
    x: np.ndarray  # (T+1, nx) x*
    u: np.ndarray  # (T+1, nu) u*, the last one for after the end
    regulator: TimeVaryingRegulator  # of deviations from the nominal
    K: np.ndarray  # (T+1, nu, nx), the last one for after the end
    limits: tuple[np.ndarray, np.ndarray]  # lowest, highest (nu,)
    last: np.ndarray  # (nx, nx) map of deviations over the last step
    handover: np.ndarray | None  # (nx,) x* at the end less the goal that is held then; None: none is held
    hold: Hold | None  # the law about that goal
    index: str = "time"  # or "phase"
    slowest: float = 0.25  # nodes that the phase moves on by in a period, at least
    fastest: float = 2.0  # at most
    start: float = 0.0  # [s] time of the first node
    drift: np.ndarray | None = None  # (nx,) d/dt of a goal that goes on moving after the end
    conserved: tuple[str, ...] = ()  # what no input changes about the goal, as the momentum of a craft with wheels
    free: tuple[str, ...] = ()  # what inputs change there and neither plant nor cost feels: left as it is

    def __post_init__(self) -> None:
        require_choice("TVLQR", "index", self.index, INDICES)
        self._gains = [np.ascontiguousarray(K) for K in self.K]
        self._offsets = list(self.u + np.einsum("kij,kj->ki", self.K, self.x))
        scale = np.sqrt(np.einsum("kii->i", self.regulator.P) / len(self.regulator.P))
        self._progress = PathProgress(self.x, scale, self.slowest, self.fastest)
        self.reset()

    @classmethod
    def along(
        cls,
        plant: Plant,
        nominal: Motion | Trajectory,
        Q: Any,
        R: Any,
        N: Any = None,
        *,
        dt: float,
        substeps: int = 10,
        end: Any = None,
        hold: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None,
        limits: Any = None,
        index: str = "time",
    ) -> TVLQR:
        """On a plant along any nominal motion in its states, whether or not it can make that.

        Q, R, N: the cost of one period, (nx, nx), (nu, nu), (nx, nu), or with a leading T. end: P_T (nx, nx), zero
        where None. hold: (K (nu, nx), x_goal, u_goal), the law after the end; None: the last gain about the last node.
        substeps: RK4 steps a period. limits: (lowest, highest), or {input: (lowest, highest)}.
        """
        dt, hold = require_seconds("TVLQR.dt", dt), given_hold(hold)
        t, x, u = nodes_of(plant, nominal, dt)
        w, p = np.zeros(plant.nw), plant.nominal_parameters
        found = HeldSteps(plant, dt, substeps, t[:-1], w, p).slopes(x[:-1], u)
        A, B = found.slope[:, :, : plant.nx], found.slope[:, :, plant.nx :]
        c = found.end - x[1:]
        regulator = riccati.dtvlqr(A, B, Q, R, N, c, end=end)
        names = tuple(s.name for s in plant.states)
        bounds = saturation("TVLQR", limits, [s.name for s in plant.inputs])
        made = cls._about(regulator, A, B, c, x, u, dt, names, hold, bounds, index, float(t[0]))
        if hold is not None:
            made.hold = held_by_plant(made.K, made.x, HeldSteps(plant, dt, substeps, t[-1:], w, p), hold, (Q, R, N))
        return made

    @classmethod
    def design(
        cls,
        ltv: LTVModel,
        Q: Any,
        R: Any,
        N: Any = None,
        *,
        end: Any = None,
        hold: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None,
        limits: Any = None,
        index: str = "time",
    ) -> TVLQR:
        """On an LTVModel with nodes dt apart: the cost is the integral of dx'Q dx + du'R du + 2 dx'N du.

        The nominal input is held at its mean between nodes. Options as in `along`. NodeWarning, and `regulator.error`,
        where the nodes are too far apart for the cost to go to be known to a thousandth (riccati/node_distance.py).
        Q (nx, nx), R (nu, nu), N (nx, nu), end (nx, nx). hold, limits: as in
        `along`. ValueError where nodes are not equally far apart.
        """
        hold = given_hold(hold)
        steps = np.diff(require_instance("TVLQR.design: ltv", ltv, LTVModel).t)
        dt = float(steps.mean())
        if np.ptp(steps) > 1e-6 * dt:
            raise ValueError(f"TVLQR.design: nodes {steps.min():.6g} to {steps.max():.6g} s apart must be equally far")
        found, u = riccati.sampled_along(ltv, Q, R, N), (ltv.u[:-1] + ltv.u[1:]) / 2
        regulator = _of_nodes(ltv, found, (Q, R, N), end)
        about = ltv.state_names, hold, saturation("TVLQR", limits, ltv.input_names), index, float(ltv.t[0])
        made = cls._about(regulator, found.A, found.B, found.c, ltv.x, u, dt, *about)
        if hold is not None:
            made.hold = held_by_model(made.K, made.x, made.u, ltv, (Q, R, N))
        return made

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        *,
        nominal: Motion | Trajectory | str | None = None,
        reserve: float = 0.1,
        effort: float = 1.0,
        index: str = "time",
    ) -> TVLQR:
        """With the scene's cost to second order along the nominal, its limits and control period.

        nominal: a motion; "plan", least effort to rest at the goal in the scene's move_time; "optimal", least cost over
        the scene's duration; "rigid", the rigid plant's motion under the scene's nominal input; None: "plan" from rest
        to rest, else "optimal". reserve: share of the limits that "plan" and "optimal" leave to the feedback. effort: a
        factor on what the inputs cost. After the end the regulator about the goal takes over.
        reserve, effort: dimensionless.
        """
        require_scene("TVLQR.for_scene", scene)
        reserve = share("TVLQR.for_scene.reserve", reserve)
        effort = require_number("TVLQR.for_scene.effort", effort, "positive")
        plant, about = scene.plant, Objective.of(scene)
        held = goal_model(scene)[0].state_names  # EquilibriumError where the goal cannot be held
        nominal = chosen_nominal("TVLQR.for_scene", scene, nominal)
        start = scene.initial[0] if isinstance(nominal, str) else nominal.x[0]  # what it conserves is told by that
        terms, given = StageTerms(about, about.residual_expression), (np.zeros(plant.nw), plant.nominal_parameters)
        K, P = law_at_goal(about, terms, scene.substeps, effort, held, start)
        along = nominal_for(scene, nominal, reserve) if isinstance(nominal, str) else nominal
        t, x, u = nodes(along, scene.dt)
        Q, R, N = period_cost(terms.values(t[:-1], x[:-1], u, *given)[1], plant.nx, scene.dt, effort)
        hold = K, about.goal_at(t[-1]), about.u_goal
        one: dict[str, Any] = {"dt": scene.dt, "substeps": scene.substeps, "limits": about.limits}
        made = cls.along(plant, along, Q, R, N, **one, end=P, hold=hold, index=index)
        made.drift = about.drift if about.drift.any() else None
        made.conserved, made.free = unmoved(scene)
        return made

    @classmethod
    def _about(
        cls,
        regulator: TimeVaryingRegulator,
        A: np.ndarray,
        B: np.ndarray,
        c: np.ndarray,
        x: np.ndarray,
        u: np.ndarray,
        dt: float,
        names: tuple[str, ...],
        hold: tuple[np.ndarray, np.ndarray, np.ndarray] | None,
        limits: tuple[np.ndarray, np.ndarray],
        index: str,
        start: float,
    ) -> TVLQR:
        """The law about its own nominal."""
        moved, fed = own_nominal(regulator, A, B, c, x, u)
        last, handover, fed[-1] = regulator.K[-1], None, fed[-2]
        if hold is not None:
            shapes = last.shape, x.shape[1:], u.shape[1:]
            held = [require_finite(f"TVLQR.hold[{i}]", *pair) for i, pair in enumerate(zip(hold, shapes))]
            handover = moved[-1] - held[1]
            last, moved[-1], fed[-1] = held
        K = np.concatenate([regulator.K, last[None]])
        last_step = A[-1] - B[-1] @ regulator.K[-1]
        return cls(dt, names, x, moved, fed, regulator, K, limits, last_step, handover, None, index, start=start)

    @cached_property
    def funnel(self) -> Funnel:
        """Where no input reaches a limit; see Funnel. By time only: the phase may jump."""
        t = self.start + self.dt * np.arange(len(self.x))
        hold = self.hold
        if hold is not None and self.drift is not None:
            hold = hold._replace(rest=hold.rest - self.dt * self.drift)
        return Funnel.about(t, self.x, self.u, self.K, self.regulator.P, self.limits, self.last, self.handover, hold)

    def cost_to_go(self, k: int, x: Any) -> float:
        """J from node k on, of the linear model without limits, from x (nx,)."""
        k = require_count("TVLQR", "k", k, -len(self.nominal), len(self.nominal) - 1)
        return self.regulator.cost_to_go(k, require_finite("TVLQR.x", x, self.x.shape[1:]) - self.nominal[k])

    @property
    def phase(self) -> float:
        """Nodes since `reset`, of the law by phase. Dimensionless, between nodes too."""
        return self._progress.phase

    def reset(self) -> None:
        """Back to the start of the nominal."""
        self._progress.reset()

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from the states y (nx,) at time t [s]."""
        y = reading("TVLQR.y", y, len(self.reads))
        t, last = moment("TVLQR", t), len(self._gains) - 1
        if self.index == "time":
            k = min(max(int((t - self.start) / self.dt + 1e-6), 0), last)
        else:
            k = self._progress.node(y)
        if k == last and self.drift is not None:
            y = y - self.drift * (t - self.start - last * self.dt)
        u = self._offsets[k] - self._gains[k].dot(y)
        return np.minimum(np.maximum(u, self.limits[0]), self.limits[1])


def _of_steps(found: riccati.SampledLTV, end: Any) -> TimeVaryingRegulator:
    terms = {"q": found.q, "s": found.s, "r": found.r}
    return riccati.dtvlqr(found.A, found.B, found.Q, found.R, found.N, found.c, end=end, **terms)


def _of_nodes(
    ltv: LTVModel, found: riccati.SampledLTV, weights: tuple[Any, Any, Any], end: Any
) -> TimeVaryingRegulator:
    """With what the distance of the nodes leaves unknown."""
    regulator = _of_steps(found, end)

    def other() -> np.ndarray:
        return _of_steps(joined(riccati.sampled_along(refined(ltv), *weights)), end).root

    return regulator._replace(error=measured(ltv, "TVLQR.design", regulator.root, other, 1, ltv.A))
