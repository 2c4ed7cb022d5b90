"""Weights by name of states, outputs and inputs as the matrices of a quadratic cost of a linear model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.core.argument_gates import require_by_name, require_finite
from pliant.plants.linear.quadratic_cost import quadratic_cost

if TYPE_CHECKING:
    from pliant.plants.linear.lti import LinearModel

Array = np.ndarray


def weight_matrices(owner: str, model: LinearModel, Q: Any, R: Any) -> tuple[Array, Array, Array]:
    """Q (nx, nx), R (nu, nu), N (nx, nu) from arrays or names, as in `quadratic_cost`; arrays are taken as they are.

    ValueError unless every input has its weight > 0, and every other is >= 0.
    """
    nx, nu = len(model.states), len(model.inputs)
    N = np.zeros((nx, nu))
    if isinstance(R, Mapping):
        given = require_by_name(f"{owner}.R", R, model.input_names, "input")
        weight = np.array([given.get(name, 0.0) for name in model.input_names])
        for name, value in zip(model.input_names, weight):
            if not value > 0:
                raise ValueError(f"{owner}.R[{name!r}] = {value:g} must be > 0")
        R = np.diag(weight)
    R = require_finite(f"{owner}.R", R, (nu, nu))
    if not isinstance(Q, Mapping):
        return require_finite(f"{owner}.Q", Q, (nx, nx)), R, N
    Q = require_by_name(f"{owner}.Q", Q, model.state_names + model.output_names, "state or output", "nonnegative")
    cost = quadratic_cost(model, Q, {}, weighed=f"{owner}.Q: state or output")
    return cost.Q, R + cost.R, cost.N
