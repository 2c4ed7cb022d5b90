"""Weights by name of states, outputs and inputs as the matrices of a quadratic cost of a linear model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.core.parameters import require_finite
from pliant.plants.core.signals import index

if TYPE_CHECKING:
    from pliant.plants.linear.lti import LinearModel

Array = np.ndarray


def weight_matrices(owner: str, model: LinearModel, Q: Any, R: Any) -> tuple[Array, Array, Array]:
    """Q (nx, nx), R (nu, nu), N (nx, nu) from arrays or names; a weight on an output is one on C x + D u."""
    nx, nu = len(model.states), len(model.inputs)
    N = np.zeros((nx, nu))
    if isinstance(R, Mapping):
        weight = np.zeros(nu)
        for name, value in R.items():
            weight[index(model.inputs, name, f"{owner}.R: input")] = value
        for name, value in zip(model.input_names, weight):
            if not value > 0:
                raise ValueError(f"{owner}.R[{name!r}] = {value:g} must be > 0")
        R = np.diag(weight)
    R = require_finite(f"{owner}.R", R, (nu, nu)).copy()
    if not isinstance(Q, Mapping):
        return require_finite(f"{owner}.Q", Q, (nx, nx)), R, N
    total = np.zeros((nx, nx))
    for name, value in Q.items():
        if not 0 <= value < np.inf:
            raise ValueError(f"{owner}.Q[{name!r}] = {value!r} must be >= 0")
        (c,), (d,), _ = signal_rows(model, [name], f"{owner}.Q: state or output")
        total += value * np.outer(c, c)
        N += value * np.outer(c, d)
        R += value * np.outer(d, d)
    return total, R, N


def signal_rows(model: LinearModel, wanted: Iterable[str], kind: str) -> tuple[Array, Array, Array]:
    """C (n, nx), D (n, nu) and values at the model's point (n,) of states or outputs C x + D u by name."""
    nx, nu = len(model.states), len(model.inputs)
    at = [index(model.states + model.outputs, name, kind) for name in wanted]
    C, D = np.vstack([np.eye(nx), model.C]), np.vstack([np.zeros((nx, nu)), model.D])
    return C[at], D[at], np.concatenate([model.x0, model.y0])[at]
