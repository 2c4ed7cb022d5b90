"""Linear loops: a controller's state-space form, the loop that it closes around a linear model, and its poles.

Controller  s[k+1] = A s + B y,  u = -(C s + D y): deviations from its reference, no limits; ds/dt where dt is None
Loop        L from what enters the plant to what the controller would give in its place, u = -L u: the transfer matrix
            whose S = (I + L)^-1 and T = L S tell the margins. "output" breaks it at what the controller reads.

A sampled controller reads before it acts: the feedthrough of what it reads is then that of the input held before, which
is a state of the loop.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.plants.core.errors import PliantError
from pliant.plants.core.parameters import require_choice, require_finite
from pliant.plants.core.signals import rows_by_name
from pliant.plants.linear.lti import LinearModel

Array = np.ndarray
NO_LIMIT = "this controller has no linear form: give LQR, Feedback, LQG, a LinearLaw, or what `linearised` makes of it"


@dataclass(frozen=True, eq=False)
class LinearLaw:
    """u = -(C s + D y), ds/dt = A s + B y or s[k+1] = A s + B y."""

    A: Array  # (m, m)
    B: Array  # (m, ny)
    C: Array  # (nu, m)
    D: Array  # (nu, ny)
    reads: tuple[str, ...]
    dt: float | None
    delay: int = 0  # periods that readings take to arrive

    @property
    def poles(self) -> Array:
        """Its own eigenvalues."""
        return np.linalg.eigvals(self.A).astype(complex)


class Loop(NamedTuple):
    """L: dx/dt = A x + B e, out = C x + D e (x[k+1] = .. where dt is given), closed by e = -out."""

    A: Array
    B: Array
    C: Array
    D: Array
    dt: float | None
    channels: tuple[str, ...]

    def closed(self) -> Array:
        """A of the loop closed by e = -out."""
        return self.A - self.B @ np.linalg.solve(np.eye(len(self.D)) + self.D, self.C)

    def at(self, omega: Array) -> Array:
        """L (k, n, n) at frequencies omega (k,) [rad/s]."""
        omega = np.atleast_1d(np.asarray(omega, dtype=float))
        s = 1j * omega if self.dt is None else np.exp(1j * omega * self.dt)
        shifted = s[:, None, None] * np.eye(len(self.A)) - self.A
        return (
            self.C @ np.linalg.solve(shifted, np.broadcast_to(self.B.astype(complex), (len(s), *self.B.shape))) + self.D
        )


def law_of(controller: Any) -> LinearLaw:
    """The linear form of a LinearLaw, LQG, LQR (integrals included), Feedback, or anything with K (nu, len(reads))."""
    if isinstance(controller, LinearLaw):
        return controller
    if isinstance(controller, LQG):
        return _lqg(controller)
    K = getattr(controller, "K", None)
    if K is None or np.ndim(K) != 2:  # none, or one for each time
        raise PliantError(f"{type(controller).__name__}: {NO_LIMIT}")
    K = require_finite(f"{type(controller).__name__}.K", K, (-1, -1))
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
    """States: the prediction before each sample, then the input held before it."""
    step, L = controller.filter.steps[-1], controller.filter.gains[-1].L
    K = _state_gain(controller)
    n, nu = len(step.A), len(K)
    wide = np.zeros((nu, n))
    wide[:, : K.shape[1]] = K
    keep = np.eye(n) - L @ step.C
    estimate = np.hstack([keep, -L @ step.D])  # of [prediction; held input], then L y
    go = step.A - step.B @ wide
    A = np.vstack([go @ estimate, -wide @ estimate])
    B = np.vstack([go @ L, -wide @ L])
    return LinearLaw(A, B, wide @ estimate, wide @ L, controller.reads, controller.dt, controller.filter.delay)


def _state_gain(controller: LQG) -> Array:
    """K (nu, nx) of the estimate, where the law inside has no states of its own."""
    law = law_of(controller.law)
    if len(law.A):
        raise PliantError("the law inside an LQG has integrals: its loop is not given in linear form")
    return law.D if controller._rows is None else law.D @ controller._rows[0]


def plant_of(model: LinearModel, law: LinearLaw) -> tuple[Array, Array, Array, Array]:
    """(A, B, C, D) from the inputs to what the law reads, sampled where it is.

    The input held before, where it is read, and readings under way join the states.
    """
    if model.dt is not None and model.dt != law.dt:
        raise ValueError(f"model.dt = {model.dt} must be the controller's, {law.dt}, or None")
    if law.dt is not None and model.dt is None:
        model = model.discretize(law.dt)
    nx = len(model.states)
    _, C, D, _ = rows_by_name(model, law.reads)
    A, B, nu = model.A, model.B, model.B.shape[1]
    if law.dt is None:
        return A, B, C, D
    if D.any():
        A = np.block([[A, np.zeros((nx, nu))], [np.zeros((nu, nx + nu))]])
        B, C, D = np.vstack([B, np.eye(nu)]), np.hstack([C, D]), np.zeros_like(D)
    for _ in range(law.delay):
        ny = len(C)
        A = np.block([[A, np.zeros((len(A), ny))], [C, np.zeros((ny, ny))]])
        B, C = np.vstack([B, np.zeros((ny, nu))]), np.hstack([np.zeros((ny, C.shape[1])), np.eye(ny)])
    return A, B, C, D


def loop(model: LinearModel, controller: Any, *, at: str = "input") -> Loop:
    """The loop of a controller around a model of the plant, broken at the plant's inputs or at what is read.

    ValueError where the model lacks what the controller reads, PliantError for controllers without a linear form.
    """
    require_choice("loop", "at", at, ("input", "output"))
    law = law_of(controller)
    A, B, C, D = plant_of(model, law)
    first, second = ((A, B, C, D), (law.A, law.B, law.C, law.D))
    channels = model.input_names
    if at == "output":
        first, second, channels = second, first, law.reads
    (A1, B1, C1, D1), (A2, B2, C2, D2) = first, second
    wide = np.block([[A1, np.zeros((len(A1), len(A2)))], [B2 @ C1, A2]])
    return Loop(wide, np.vstack([B1, B2 @ D1]), np.hstack([D2 @ C1, C2]), D2 @ D1, law.dt, channels)


def closed_loops(model: LinearModel, controller: Any) -> Callable[[float], Array]:
    """gain -> A of the loop closed with `gain` times the controller's output; states: the model's, readings under way,
    then the controller's. At gain 0 its eigenvalues are the plant's and the controller's own.
    """
    law = law_of(controller)
    A, B, C, D = plant_of(model, law)
    n, m = len(A), len(law.A)
    seen, given = np.hstack([C, np.zeros((len(C), m))]), np.hstack([law.D @ C, law.C])

    def closed(gain: float) -> Array:
        u = -gain * np.linalg.solve(np.eye(len(law.D)) + gain * law.D @ D, given)
        plant = np.hstack([A, np.zeros((n, m))]) + B @ u
        own = np.hstack([np.zeros((m, n)), law.A]) + law.B @ (seen + D @ u)
        return np.vstack([plant, own])

    return closed


def closed_loop(model: LinearModel, controller: Any, gain: float = 1.0) -> Array:
    """`closed_loops` at one gain."""
    return closed_loops(model, controller)(gain)


def linearised(controller: Any, y0: Any, *, step: float = 1e-6, t: float = 0.0) -> LinearLaw:
    """The law of a controller without memory, by central differences of `act` at the reading y0 (ny,) and time t [s].

    For MPC inside its limits, policies and the like: each difference starts from `reset`. step: of each reading against
    its size, or 1. PliantError where acting twice on the same reading gives two answers.
    """
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
    D = np.column_stack(columns)
    none = np.zeros((0, 0))
    return LinearLaw(none, np.zeros((0, len(y0))), np.zeros((len(D), 0)), D, tuple(controller.reads), controller.dt)
