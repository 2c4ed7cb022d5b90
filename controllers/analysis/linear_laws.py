"""Controllers in state-space form: s[k+1] = A s + B y, u = -(C s + D y), ds/dt where dt is None.

All in deviations from the controller's reference, without limits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.controllers.base.controller import Controller
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.controllers.riccati.late_inputs import past_of
from pliant.plants.core.argument_gates import (
    require_count,
    require_finite,
    require_instance,
    require_names,
    require_number,
    require_seconds,
)
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays

Array = np.ndarray
NO_LIMIT = "this controller has no linear form: give LQR, Feedback, LQG, a LinearLaw, or what `linearised` makes of it"


@dataclass(frozen=True, eq=False)
class LinearLaw(OwnsArrays):
    """u = -(C s + D y), ds/dt = A s + B y or s[k+1] = A s + B y."""

    A: Array  # (m, m)
    B: Array  # (m, ny)
    C: Array  # (nu, m)
    D: Array  # (nu, ny)
    reads: tuple[str, ...]
    dt: float | None
    delay: int = 0  # periods that readings take to arrive

    def __post_init__(self) -> None:
        reads = require_names("LinearLaw.reads", self.reads)
        A = require_finite("LinearLaw.A", self.A, (-1, -1))
        m, ny, nu = len(A), len(reads), len(require_finite("LinearLaw.C", self.C, (-1, -1)))
        values: dict[str, Any] = {"reads": reads, "delay": require_count("LinearLaw", "delay", self.delay, 0, 10_000)}
        for name, shape in (("A", (m, m)), ("B", (m, ny)), ("C", (nu, m)), ("D", (nu, ny))):
            values[name] = require_finite(f"LinearLaw.{name}", getattr(self, name), shape)
        if self.dt is not None:
            values["dt"] = require_seconds("LinearLaw.dt", self.dt)
        elif self.delay:
            raise ValueError(f"LinearLaw.delay = {self.delay} counts periods, must be 0 where dt is None")
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @property
    def poles(self) -> Array:
        """Its own eigenvalues."""
        return np.linalg.eigvals(self.A).astype(complex)


def law_of(controller: Any) -> LinearLaw:
    """The linear form of a LinearLaw, LQG, LQR (integrals included), Feedback, or anything with K (nu, len(reads))."""
    if isinstance(controller, LinearLaw):
        return controller
    if isinstance(found := getattr(controller, "linear_form", None), LinearLaw):
        return found
    if isinstance(controller, LQG):
        return _lqg(controller)
    K = getattr(controller, "K", None)
    if K is None or np.ndim(K) != 2:  # none, or one for each time
        raise PliantError(f"{type(controller).__name__}: {NO_LIMIT}")
    K = require_finite(f"{type(controller).__name__}.K", K, (-1, -1))
    if (late := getattr(controller, "K_past", None)) is not None:  # inputs on their way, the oldest first
        m, nu = late.shape[1], len(K)
        last = np.eye(m)[:, -nu:]
        return LinearLaw(np.eye(m, k=nu) - last @ late, -last @ K, late, K, tuple(controller.reads), controller.dt)
    reads, dt = tuple(controller.reads), controller.dt
    picks = np.asarray(getattr(controller, "picks", ()), dtype=int)
    n, ny = len(picks), len(reads)
    direct = np.zeros((len(K), ny))
    nx = K.shape[1] - n
    if nx > ny:
        raise PliantError(f"{type(controller).__name__}.K has {nx} columns for {ny} readings: {NO_LIMIT}")
    direct[:, :nx] = K[:, :nx]
    B = np.zeros((n, ny))
    B[np.arange(n), picks] = 1.0 if dt is None else dt
    return LinearLaw(np.zeros((n, n)) if dt is None else np.eye(n), B, K[:, nx:], direct, reads, dt)


def _lqg(controller: LQG) -> LinearLaw:
    """States: the prediction before each sample, then the inputs asked for before it, the oldest first."""
    step, L = controller.filter.steps[-1], controller.filter.gains[-1].L
    K, late = _state_gain(controller)
    n, nu, acting = len(step.A), len(K), step.B.shape[1]
    count = max(past_of(controller.filter.input_delay) + 1, late.shape[1] // nu) * nu
    wide = np.hstack([K, np.zeros((nu, n - K.shape[1] + count - late.shape[1])), late])  # of [estimate; asked]
    acts = np.zeros((acting, count))  # what acts, of the inputs asked for
    first = count - (past_of(controller.filter.input_delay) + 1) * nu
    acts[:, first : first + acting] = np.eye(acting)
    seen = np.block([[np.eye(n) - L @ step.C, -L @ step.D @ acts], [np.zeros((count, n)), np.eye(count)]])
    take = np.vstack([L, np.zeros((count, L.shape[1]))])
    later = np.eye(count, k=nu)
    last = np.eye(count)[:, -nu:]
    go = np.block([[step.A, step.B @ acts @ later], [np.zeros((count, n)), later]])
    go -= np.vstack([step.B @ acts @ last, last]) @ wide
    return LinearLaw(
        go @ seen, go @ take, wide @ seen, wide @ take, controller.reads, controller.dt, controller.filter.delay
    )


def _state_gain(controller: LQG) -> tuple[Array, Array]:
    """K (nu, nx) of the estimate and that of the inputs on their way, where the law inside has no other states."""
    law = law_of(controller.law)
    late = getattr(controller.law, "K_past", None)
    if len(law.A) and late is None:
        raise PliantError("the law inside an LQG has integrals: its loop is not given in linear form")
    D = law.D if controller._rows is None else law.D @ controller._rows[0]
    return D, np.zeros((len(D), 0)) if late is None else late


def readings_under_way(A: Array, B: Array, C: Array, periods: int) -> tuple[Array, Array, Array]:
    """A plant whose readings C x take whole periods to arrive: those under way join its states."""
    for _ in range(periods):
        ny = len(C)
        A = np.block([[A, np.zeros((len(A), ny))], [C, np.zeros((ny, ny))]])
        B, C = np.vstack([B, np.zeros((ny, B.shape[1]))]), np.hstack([np.zeros((ny, C.shape[1])), np.eye(ny)])
    return A, B, C


def closed_matrix(plant: tuple[Array, Array, Array, Array], law: LinearLaw, gain: float = 1.0) -> Array:
    """A of the loop of a plant (A, B, C, D) and `gain` times a law's output; states: the plant's, then the law's."""
    A, B, C, D = plant
    n, m = len(A), len(law.A)
    seen, given = np.hstack([C, np.zeros((len(C), m))]), np.hstack([law.D @ C, law.C])
    u = -gain * np.linalg.solve(np.eye(len(law.D)) + gain * law.D @ D, given)
    own = np.hstack([np.zeros((m, n)), law.A]) + law.B @ (seen + D @ u)
    return np.vstack([np.hstack([A, np.zeros((n, m))]) + B @ u, own])


def linearised(controller: Any, y0: Any, *, step: float = 1e-6, t: float = 0.0) -> LinearLaw:
    """The law of a controller without memory, by central differences of `act` at the reading y0 (ny,) and time t [s].

    For MPC inside its limits, policies and the like: each difference starts from `reset`. step: of each reading against
    its size, or 1. PliantError where acting twice on the same reading gives two answers.
    """
    require_instance("linearised.controller", controller, Controller)
    step, t = require_number("linearised.step", step, "positive"), require_number("linearised.t", t, unit="s")
    y0 = require_finite("linearised.y0", y0, (len(controller.reads),))

    def fresh(y: Array) -> Array:
        controller.reset()
        return np.array(controller.act(t, y), dtype=float)

    first = fresh(y0)
    again = np.asarray(controller.act(t, y0), dtype=float)
    if np.abs(again - first).max() > 1e-9 * max(1.0, np.abs(first).max()):
        raise PliantError(f"{type(controller).__name__} acts differently on the same reading: {NO_LIMIT}")
    columns = []
    for i, h in enumerate(step * np.maximum(np.abs(y0), 1.0)):
        e = h * np.eye(len(y0))[i]
        columns.append((fresh(y0 - e) - fresh(y0 + e)) / (2 * h))
    controller.reset()
    D = np.reshape(columns, (len(y0), first.size)).T  # of a law that reads nothing (nu, 0)
    none = np.zeros((0, 0))
    return LinearLaw(none, np.zeros((0, len(y0))), np.zeros((len(D), 0)), D, tuple(controller.reads), controller.dt)
