"""What a loop from the inputs to the joints that they drive sees of a plant: inertia, closed-loop modes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import rows_by_name

if TYPE_CHECKING:
    from pliant.plants.dynamics.plant import Plant
    from pliant.plants.linear.lti import LinearModel


def rows(model: LinearModel, names: tuple[str, ...]) -> np.ndarray:
    """(n, nx): the named states or outputs of a linear model from its state."""
    return rows_by_name(model, names).C


def rigid_inertia(plant: Plant, x0: Any, u0: Any, rates: tuple[str, ...]) -> np.ndarray:
    """J (nu, nu): inputs [their unit] over accelerations of the joints, of the cheapest variant at x0, symmetric.

    PliantError where the inputs do not move the joints one by one.
    """
    moved = accelerations(plant, dict(zip((s.name for s in plant.states), np.asarray(x0, dtype=float))), u0, rates)
    inertia = np.linalg.inv(moved)
    return (inertia + inertia.T) / 2


def accelerations(plant: Plant, at: Mapping[str, float], u0: Any, rates: tuple[str, ...]) -> np.ndarray:
    """(nu, nu): of the joints for a unit of each input, of the cheapest variant where its states are `at`, else zero.

    PliantError where the inputs do not move the joints one by one.
    """
    rigid = plant.ladder()[0]
    model = rigid.linearize(np.array([at.get(s.name, 0.0) for s in rigid.states]), u0)
    moved = rows(model, rates) @ model.B
    if not np.linalg.cond(moved) < 1e10:
        raise PliantError(f"the inputs {model.input_names} do not move {rates} one by one: accelerations {moved}")
    return moved


def rigid_state(plant: Plant, x0: Any) -> np.ndarray:
    """The state of the cheapest variant where the plant's is x0 (nx,), zero in what it lacks."""
    at = dict(zip((s.name for s in plant.states), np.asarray(x0, dtype=float)))
    return np.array([at.get(s.name, 0.0) for s in plant.ladder()[0].states])


def sharing(model: LinearModel, rates: tuple[str, ...]) -> np.ndarray:
    """(nu, n): the least inputs that accelerate one of n joints by one, the others by nothing.

    PliantError where the inputs do not.
    """
    moved = rows(model, rates) @ model.B
    if len(moved) > moved.shape[1] or not np.linalg.cond(moved) < 1e10:
        raise PliantError(f"the inputs {model.input_names} do not move {rates} one by one: accelerations {moved}")
    return np.linalg.pinv(moved)


def loop_eigenvalues(model: LinearModel, K: np.ndarray, reads: tuple[str, ...], dt: float | None) -> np.ndarray:
    """[1/s] of u = -K y with y = `reads`, continuous or held over each dt [s]."""
    S = rows(model, reads)
    if dt is None:
        return np.linalg.eigvals(model.A - model.B @ K @ S)
    sampled = model.discretize(dt)
    values = np.linalg.eigvals(sampled.A - sampled.B @ K @ S).astype(complex)
    return np.log(values[values != 0]) / dt
