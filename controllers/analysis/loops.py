"""Linear loops: the loop that a controller closes around a linear model, and its poles.

Loop        L from what enters the plant to what the controller would give in its place, u = -L u: the transfer matrix
            whose S = (I + L)^-1 and T = L S tell the margins. "output" breaks it at what the controller reads.

A sampled controller reads before it acts: the feedthrough of what it reads is then that of the input held before, which
is a state of the loop.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from pliant.plants.core.argument_gates import real_array, require_choice, require_instance, require_number, shown
from pliant.plants.core.signals import rows_by_name
from pliant.plants.linear.conserved import conserved, free, moved
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

from .late_loops import LateLoop
from .linear_laws import Array, LinearLaw, closed_matrix, law_of, readings_under_way
from .linear_laws import linearised as linearised  # under its old name too
from .users_laws import users_law


class Loop(NamedTuple):
    """L: dx/dt = A x + B e, out = C x + D e (x[k+1] = .. where dt is given), closed by e = -out."""

    A: Array
    B: Array
    C: Array
    D: Array
    dt: float | None
    channels: tuple[str, ...]
    conserved: tuple[str, ...] = ()  # what no input of the plant changes: not among the states
    late: LateLoop | None = None  # the same with one channel late by any time, where a continuous model is sampled
    free: tuple[str, ...] = ()  # what inputs change and neither plant nor controller feels: not among the states

    def closed(self) -> Array:
        """A of the loop closed by e = -out."""
        return self.A - self.B @ np.linalg.solve(np.eye(len(self.D)) + self.D, self.C)

    def at(self, omega: Array) -> Array:
        """L (k, n, n) at frequencies omega (k,) [rad/s]."""
        omega = np.atleast_1d(real_array("Loop.at: omega", omega))
        if omega.ndim != 1 or not np.isfinite(omega).all():
            raise ValueError(f"Loop.at: omega of shape {omega.shape} must be (k,) finite frequencies [rad/s]")
        s = 1j * omega if self.dt is None else np.exp(1j * omega * self.dt)
        shifted = s[:, None, None] * np.eye(len(self.A)) - self.A
        return (
            self.C @ np.linalg.solve(shifted, np.broadcast_to(self.B.astype(complex), (len(s), *self.B.shape))) + self.D
        )


def felt_by(law: LinearLaw, model: LinearModel) -> Array:
    """(m, nx): all that a law makes of the states of a model."""
    return np.vstack([law.B, law.D]) @ rows_by_name(model, law.reads).C


def plant_of(model: LinearModel, law: LinearLaw) -> tuple[Array, Array, Array, Array]:
    """(A, B, C, D) from the inputs to what the law reads, sampled where it is.

    The input held before, where it is read, and readings under way join the states; what the model conserves, and what
    neither it nor the law feels, is not among them (see `conserved`).
    """
    model = moved(model, felt_by(law, model))
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
    A, B, C = readings_under_way(A, B, C, law.delay)
    return A, B, C, np.zeros((len(C), nu)) if law.delay else D


def loop(
    model: LinearModel | LTVModel,
    controller: Any,
    *,
    at: str = "input",
    reads: Sequence[str] | None = None,
    dt: float | None = None,
) -> Loop:
    """The loop of a controller around a model of the plant, broken at the plant's inputs or at what is read.

    controller: one of Pliant's, a gain K (nu, len(reads)) of u = -K y, a function u = law(y), or a python-control
    StateSpace or TransferFunction, u = -K(s) y. `reads` and `dt` are those of gains and functions; a system's inputs
    may be named by its labels.

    ValueError where the model varies in time or lacks what the controller reads, PliantError for controllers without a
    linear form. K is (nu, len(reads)); dt: period [s] of a gain, None: the model's.

    Example
    -------
    >>> from pliant.plants import LinearModel
    >>> motor = LinearModel.from_matrices([[0.0, 1.0], [0.0, -1.0]], [[0.0], [1.0]])
    >>> loop(motor, [[4.0, 2.0]]).dt
    """
    if not isinstance(model, LinearModel):
        raise ValueError(f"loop.model = {shown(model)} must be a LinearModel: a loop has margins at rest")
    require_choice("loop", "at", at, ("input", "output"))
    law = law_of(users_law(controller, model, reads, dt))
    A, B, C, D = plant_of(model, law)
    first, second = ((A, B, C, D), (law.A, law.B, law.C, law.D))
    channels = model.input_names
    if at == "output":
        first, second, channels = second, first, law.reads
    (A1, B1, C1, D1), (A2, B2, C2, D2) = first, second
    wide = np.block([[A1, np.zeros((len(A1), len(A2)))], [B2 @ C1, A2]])
    late = None if law.dt is None or model.dt is not None else LateLoop(moved(model, felt_by(law, model)), law, at)
    return Loop(
        wide,
        np.vstack([B1, B2 @ D1]),
        np.hstack([D2 @ C1, C2]),
        D2 @ D1,
        law.dt,
        channels,
        conserved(model).names,
        late,
        free(model, felt_by(law, model)),
    )


def closed_loops(model: LinearModel, controller: Any) -> Callable[[float], Array]:
    """gain -> A of the loop closed with `gain` times the controller's output; states: the model's, readings under way,
    then the controller's. At gain 0 its eigenvalues are the plant's and the controller's own.
    """
    require_instance("closed_loops.model", model, LinearModel)
    law = law_of(controller)
    plant = plant_of(model, law)
    return lambda gain: closed_matrix(plant, law, gain)


def closed_loop(model: LinearModel, controller: Any, gain: float = 1.0) -> Array:
    """`closed_loops` at one gain."""
    return closed_loops(model, controller)(require_number("closed_loop.gain", gain))
