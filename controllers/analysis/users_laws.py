"""What a user brings as a controller, as a linear law: a gain, a function of the readings, a python-control system.

Each closes the loop by negative feedback, u = -K y, as python-control's `feedback` does; a function gives u itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pliant.controllers.base.controller import Controller
from pliant.plants.core.argument_gates import require_finite, require_names, require_seconds, shown
from pliant.plants.linear.lti import LinearModel

from .linear_laws import Array, LinearLaw

STEP = 1e-6  # of each reading against its size, or 1, where a function is differentiated


def users_law(controller: Any, model: LinearModel, reads: Sequence[str] | None, dt: float | None) -> Any:
    """A LinearLaw of a gain (nu, len(reads)), a function u = law(y) about the model's point, or a python-control
    StateSpace or TransferFunction; what is a controller already comes back as it is.

    reads: names of the model's states or outputs. None: a system's own input labels, else all states where there are
    as many columns. dt [s] of gains and functions; a system has its own.
    """
    if isinstance(controller, (LinearLaw, Controller)) or hasattr(controller, "linear_form"):
        return _alone(controller, reads, dt)
    own = tuple(reads) if reads is not None else None
    if hasattr(controller, "input_labels") and hasattr(controller, "dt"):
        if dt is not None:
            raise ValueError(f"loop.dt = {dt!r} must be None: a system has its own")
        return _system(controller, model, own)
    dt = None if dt is None else require_seconds("loop.dt", dt)
    if callable(controller):
        if own is None:
            raise ValueError(
                f"loop.controller = {shown(controller)}: loop.reads = None must name what a function reads"
            )
        return _function(controller, model, require_names("loop.reads", own), dt)
    if isinstance(controller, (np.ndarray, list, tuple)):
        K = require_finite("loop.controller", controller, (-1, -1))
        names = _named(model, own, K.shape[1], ())
        return _static(_fits(K, model), names, dt)
    return _alone(controller, reads, dt)


def _alone(controller: Any, reads: Any, dt: Any) -> Any:
    if reads is not None or dt is not None:
        raise ValueError(f"loop: {type(controller).__name__} has its own reads and dt, give neither")
    return controller


def _system(system: Any, model: LinearModel, reads: tuple[str, ...] | None) -> LinearLaw:
    import control

    try:
        found = control.ss(system)
    except (NotImplementedError, TypeError, ValueError) as error:
        raise ValueError(
            f"loop.controller: python-control makes no states of this {type(system).__name__}: {error}; give a "
            "StateSpace"
        ) from None
    if found.dt is True:
        raise ValueError("loop: controller.dt = True must be 0, None or a sampling time in seconds")
    names = _named(model, reads, found.ninputs, tuple(system.input_labels))
    D = _fits(np.asarray(found.D), model)
    return LinearLaw(found.A, found.B, found.C, D, names, found.dt or None)


def _function(law: Callable[[Array], Any], model: LinearModel, reads: tuple[str, ...], dt: float | None) -> LinearLaw:
    known = dict(zip(model.state_names + model.output_names, np.concatenate([model.x0, model.y0])))
    missing = [name for name in reads if name not in known]
    if missing:
        raise ValueError(f"loop.reads = {missing[0]!r} must be one of {', '.join(known)}")
    y0 = np.array([known[name] for name in reads])
    nu, columns = len(model.input_names), []
    for i, h in enumerate(STEP * np.maximum(np.abs(y0), 1.0)):
        e = h * np.eye(len(y0))[i]
        low, high = (np.asarray(require_finite("loop: law(y)", np.atleast_1d(law(y)), (nu,))) for y in (y0 - e, y0 + e))
        columns.append((low - high) / (2 * h))
    return _static(np.column_stack(columns), reads, dt)


def _named(model: LinearModel, reads: tuple[str, ...] | None, columns: int, labels: tuple[str, ...]) -> tuple[str, ...]:
    """What is read, one name for each column."""
    known = model.state_names + model.output_names
    if reads is None and set(labels) <= set(known) and labels:
        reads = labels
    if reads is None and columns == len(model.state_names) and not set(labels) & set(known):
        reads = model.state_names
    if reads is None:
        raise ValueError(f"loop.reads = None must name {columns} of {', '.join(known)}")
    names = require_names("loop.reads", reads)
    if len(names) != columns:
        raise ValueError(f"loop.reads = {names} must be {columns} names, one for each column of the controller")
    return names


def _fits(K: Array, model: LinearModel) -> Array:
    if len(K) != len(model.input_names):
        raise ValueError(
            f"loop.controller = {shown(K)} has {len(K)} rows, must have {len(model.input_names)}, one for each input"
        )
    return K


def _static(K: Array, reads: tuple[str, ...], dt: float | None) -> LinearLaw:
    return LinearLaw(np.zeros((0, 0)), np.zeros((0, K.shape[1])), np.zeros((len(K), 0)), K, reads, dt)
