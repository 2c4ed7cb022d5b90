"""LQR about an equilibrium: continuous or sampled design, integral action, limits on the inputs.

Cost   J = int (x - x0)' Q (x - x0) + (u - u0)' R (u - u0) [+ sum of weight_i (int y_i - y0_i)^2] dt
Law    u = u0 - K_x (x - x0) - K_i xi, within the limits; xi integrates the named outputs' errors
       and stands still while a limit is reached and going on would push further past it.
Delay  inputs that act late join the states, exactly, whole periods and parts of one: u = .. - K_past [u_{k-M} - u0; ..;
       u_{k-1} - u0], see `riccati.late_inputs`

Guarantee   where dt is None, without limits and with all states read, the loop of the linear model is stable, with
            gain margins of 1/2 to infinity and 60 degrees of phase at each input (Safonov and Athans 1977). Sampled:
            stable in the model, no margins. With a delay that is known: as without. With a range: stable in the
            model at each of 17 delays of it that stay, else there is no law. Against other parameters, limits and
            delays that were not told: none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.controller import moment, reading, saturation
from pliant.controllers.base.goal_model import goal_model, require_held, unmoved
from pliant.controllers.base.inputs_on_their_way import OnTheirWay
from pliant.controllers.base.joint_reference import values_of
from pliant.controllers.base.quadratic_weights import weight_matrices
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.riccati.algebraic import with_integrals
from pliant.controllers.riccati.late_inputs import delay_range, late_lqr
from pliant.controllers.riccati.steerable import Steerable, steerable
from pliant.plants.core.argument_gates import (
    require_by_name,
    require_finite,
    require_instance,
    require_names,
    require_number,
    require_seconds,
)
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.dynamics.plant import Plant
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.quadratic_cost import signal_rows


@final
@dataclass(eq=False)
class LQR(OwnsArrays):
    """Made by `design`, `for_plant` or `for_scene`. It reads the states of its model, then the integrated outputs."""

    K: np.ndarray  # (nu, nx + ni)
    P: np.ndarray  # (nx + ni, nx + ni)
    poles: np.ndarray  # of the closed loop: [1/s], or in the z plane where dt is given; see `conserved`, `free`
    x0: np.ndarray  # (nx,)
    u0: np.ndarray  # (nu,)
    target: np.ndarray  # (ni,) values that the integrated signals are brought to
    reads: tuple[str, ...]
    picks: np.ndarray  # (ni,) places of the integrated signals in y
    limits: tuple[np.ndarray, np.ndarray]  # lowest, highest (nu,)
    dt: float | None  # [s]
    drift: np.ndarray | None = None  # (nx,) d(x0)/dt of a goal that moves steadily, from x0 at t = 0
    conserved: tuple[str, ...] = ()  # what no input changes, as the momentum of a craft with wheels: not in the poles
    free: tuple[str, ...] = ()  # what only inputs change and neither cost nor plant feels: left as it is, no pole
    part: Steerable | None = None  # what of the states is steered
    K_past: np.ndarray | None = None  # (nu, M nu) of the inputs on their way, the oldest first; P then holds them too
    before: np.ndarray | None = None  # (nu,) what acts until the first act's input does; u0 where None
    delay: tuple[float, float] = (0.0, 0.0)  # shortest and longest [periods]
    xi: np.ndarray = field(init=False)  # (ni,) integrals since `reset` [unit s]

    def __post_init__(self) -> None:
        self.reset()

    @classmethod
    def design(
        cls,
        model: LinearModel,
        Q: Any,
        R: Any,
        *,
        reads: Sequence[str] | None = None,
        dt: float | None = None,
        integral: Mapping[str, float] | None = None,
        limits: Any = None,
        start: Any = None,
        delay: Any = 0.0,
        before: Any = None,
    ) -> LQR:
        """Design on a continuous-time linear model, taken to be about an equilibrium.

        Q: (nx, nx), or weights by name of state or output: {"theta1": 100.0, "tip_x": 10.0}, the rest zero.
        R: (nu, nu), or a weight for every input by name.
        reads: names under which the plant knows the model's states, where they differ.
        dt [s]: None designs for continuous time; else for an input held over dt, with the same cost,
        integrated exactly. integral: weights by name of the outputs (or states) to integrate, each at most
        as many as can be steered. limits: (lowest, highest), or {input: (lowest, highest)}.
        start: states (nx,) where the motion begins; what is conserved and weighed must have the goal's value there.
        delay: after how many periods an input acts, 1.5 say, or (shortest, longest) where only a range is known: then
        one law for all of it, PliantError where none was found. before (nu,): what acts until the first one does.
        UncontrollableError names modes that do not decay and are not reached, or not seen by the cost; what is
        conserved and not weighed is none of them (see `controllers.riccati.steerable`).
        """
        require_instance("LQR.design: model", model, LinearModel)
        dt = None if dt is None else require_seconds("LQR.dt", dt)
        if model.dt is not None:
            raise ValueError(f"LQR.design: model.dt = {model.dt} must be None; riccati.dlqr takes sampled ones")
        late = delay_range("LQR", delay)
        if late[1] and (dt is None or integral):
            raise ValueError(f"LQR.delay = {delay!r} must be 0 without dt, and with integral: they count on time")
        Q, R, N = weight_matrices("LQR", model, Q, R)
        known = model.state_names + model.output_names
        given = {} if integral is None else integral
        wanted = require_by_name("LQR.integral", given, known, "state or output", "positive")
        Ci, Di, target = signal_rows(model, tuple(wanted), "LQR.integral: state or output")
        weight = np.diag(list(wanted.values())) if wanted else np.zeros((0, 0))
        off = None if start is None else require_finite("LQR.start", start, model.x0.shape) - model.x0
        part = steerable(model.A, model.B, Q, N, model.state_names, seen=Ci, start=off)
        found, K_past = _regulator(part, (model.A, model.B, Q, R, N), (Ci, Di, weight), dt, tuple(wanted), late)
        own = require_names("LQR.reads", reads) if reads is not None else model.state_names
        if len(own) != len(model.states):
            raise ValueError(f"LQR.reads = {own} must be {len(model.states)} names, one for each state of the model")
        return cls(
            *found,
            x0=model.x0,
            u0=model.u0,
            target=target,
            reads=own + tuple(n for n in wanted if n not in model.state_names),
            picks=_picks(model, tuple(wanted)),
            limits=saturation("LQR", limits, model.input_names),
            dt=dt,
            conserved=part.conserved,
            free=part.free,
            part=part,
            K_past=K_past,
            before=None if before is None else require_finite("LQR.before", before, model.u0.shape),
            delay=late,
        )

    @classmethod
    def for_plant(
        cls,
        plant: Plant,
        x0: Any,
        u0: Any,
        Q: Any,
        R: Any,
        *,
        reads: Sequence[str] | None = None,
        dt: float | None = None,
        integral: Mapping[str, float] | None = None,
        limits: Any = None,
    ) -> LQR:
        """`design` (Q, R, integral, limits) about an equilibrium (x0, u0); EquilibriumError where it is none."""
        require_instance("LQR.for_plant: plant", plant, Plant)
        x0 = require_finite("LQR.x0", x0, (plant.nx,))
        model = plant.linearize(x0, None if u0 is None else require_finite("LQR.u0", u0, (plant.nu,)))
        require_held(model)
        return cls.design(model, Q, R, reads=reads, dt=dt, integral=integral, limits=limits)

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        *,
        effort: float = 1.0,
        integral: Mapping[str, float] | None = None,
        delay: float | tuple[float, float] = 0.0,
    ) -> LQR:
        """`design` about a scene's goal, moving or not, with its cost, limits and control period.

        delay [periods]: as in `design`; what acts first is the input of the scene's start.
        effort: a factor on what the inputs cost. EquilibriumError where the goal cannot be held. integral:
        weights by name [1/(unit s)^2].
        """
        require_scene("LQR.for_scene", scene)
        effort = require_number("LQR.for_scene.effort", effort, "positive")
        model, drift = goal_model(scene)
        R, high = {name: effort * value for name, value in scene.effort}, np.array(scene.limits, dtype=float)
        start = values_of(scene.plant, *scene.initial, model.state_names)
        options: dict[str, Any] = {"dt": scene.dt, "integral": integral, "limits": (-high, high), "start": start}
        options |= {"delay": delay, "before": np.clip(scene.initial[1], -high, high)}
        made = cls.design(model, dict(scene.weights), R, **options)
        made.conserved, made.free = unmoved(scene)
        made.drift = drift if drift.any() else None
        return made

    def reset(self) -> None:
        """Set the integrals to zero, and forget the inputs on their way."""
        self.xi = np.zeros(len(self.target))
        self._last: float | None = None
        self._past = OnTheirWay(self._begun(), len(self.u0))

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from y (len(reads),) at time t [s]; the integrals move on by dt, or by the time passed.

        ValueError where t runs backwards.
        """
        y = reading("LQR.y", y, len(self.reads))
        if self.drift is not None:
            y = y.copy()
            y[: len(self.x0)] -= self.drift * moment("LQR", t)
        if self.K_past is not None:
            u = self.u0 - self.K.dot(y - self.x0) - self.K_past.dot(self._past.values)
            u = np.minimum(np.maximum(u, self.limits[0]), self.limits[1])
            self._past.push(u - self.u0)
            return u
        if not len(self.target):
            u = self.u0 - self.K.dot(y - self.x0)
            return np.minimum(np.maximum(u, self.limits[0]), self.limits[1])
        error = y[self.picks] - self.target
        if self.dt is None:
            t = moment("LQR", t)
            last = t if self._last is None else self._last
            if not t >= last:
                raise ValueError(f"LQR.t = {t!r} must be >= {last!r}, the time of the last act; `reset` starts again")
            self._integrate(y, (t - last) * error)
            self._last = t
        u = self._free(y)
        if self.dt is not None:
            self._integrate(y, self.dt * error)
        return np.minimum(np.maximum(u, self.limits[0]), self.limits[1])

    def cost_to_go(self, x: Any, xi: Any = None) -> float:
        """The cost from x (nx,) and integrals xi (ni,) (None: zero) at the start on, linear and without limits."""
        x = require_finite("LQR.x", x, self.x0.shape)
        xi = np.zeros(len(self.target)) if xi is None else require_finite("LQR.xi", xi, self.target.shape)
        off = x - self.x0
        if self.part is not None and not self.part.same(off):
            return np.inf  # what is conserved and weighed has not the goal's value
        error = np.concatenate([off, xi, self._begun()])
        return float(error @ self.P @ error)

    def _begun(self) -> np.ndarray:
        """(M nu,) inputs on their way before the first act, less u0."""
        first = np.zeros(len(self.u0)) if self.before is None else self.before - self.u0
        return np.tile(first, 0 if self.K_past is None else self.K_past.shape[1] // len(self.u0))

    def _free(self, y: np.ndarray) -> np.ndarray:
        """u without limits."""
        nx = len(self.x0)
        return self.u0 - self.K[:, :nx] @ (y[:nx] - self.x0) - self.K[:, nx:] @ self.xi

    def _integrate(self, y: np.ndarray, change: np.ndarray) -> None:
        """Add `change` (ni,) to the integrals, but not what would push an input further past its limit."""
        push = -self.K[:, len(self.x0) :] * change
        u = self._free(y) + push.sum(axis=1)
        excess = u - np.minimum(np.maximum(u, self.limits[0]), self.limits[1])
        self.xi = self.xi + np.where(excess @ push > 0, 0.0, change)


def _regulator(
    part: Steerable,
    whole: tuple[np.ndarray, ...],
    integrated: tuple[np.ndarray, np.ndarray, np.ndarray],
    dt: float | None,
    wanted: tuple[str, ...],
    late: tuple[float, float],
) -> tuple[riccati.Regulator, np.ndarray | None]:
    """K, P of all states, poles, and the gain of the inputs on their way. whole: A, B, Q, R, N of continuous time;
    integrated: C, D of the signals `wanted` and their weights."""
    A, B, Q, R, N = whole
    C, D, weight = integrated
    ni, nx, nu = len(wanted), len(part.names), B.shape[1]
    (A, B), (Q, N), C = part.system(A, B), part.weights(Q, N), C @ part.up
    if dt is not None:
        A, B, Q, R, N = riccati.sampled(A, B, Q, R, N, dt=dt)
        weight = dt * weight
    A, B = with_integrals(A, B, C, D, dt)
    N = np.vstack([N, np.zeros((ni, nu))])
    Q = np.block([[Q, np.zeros((nx, ni))], [np.zeros((ni, nx)), weight]])
    known = part.names + tuple(f"integral of {name}" for name in wanted)
    if dt is None:
        found = riccati.lqr(A, B, Q, R, N, names=known)
    else:
        found = riccati.dlqr(A, B, Q, R, N, names=known, dt=dt)
    found = riccati.Regulator(part.gain(found.K), part.cost(found.P), found.poles)
    if dt is None or not late[1]:
        return found, None
    if late[0] < late[1] and (part.conserved or part.free):
        raise ValueError(f"LQR.delay = {late} must be one number where something is conserved or free")
    made = late_lqr(*whole, dt=dt, delays=late, on_time=found)
    K, K_past = np.hsplit(made.K, [len(whole[0])])
    return riccati.Regulator(K, made.P, made.poles), K_past


def _picks(model: LinearModel, wanted: tuple[str, ...]) -> np.ndarray:
    """Where in y = [states, outputs that are not states] the integrated signals are."""
    order = model.state_names + tuple(n for n in wanted if n not in model.state_names)
    return np.array([order.index(name) for name in wanted], dtype=int)
