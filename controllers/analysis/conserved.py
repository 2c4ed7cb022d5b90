"""Quantities that no input changes: w'x with w'A = 0 and w'B = 0, as the total momentum of a craft turned by wheels.

Each leaves an eigenvalue at rest that no loop moves. It is no failure of a loop: the motion stays where w'x has the
value that it began with, and what a loop does there is that of the model restricted to w'x = 0.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pliant.plants.core.signals import Signal
from pliant.plants.linear.lti import LinearModel

Array = np.ndarray
NOTHING = 1e-11  # singular value of [A, B], rows and columns scaled to one, that is none
SCALINGS = 20  # of rows and columns in turn


class Conserved(NamedTuple):
    """Of a linear model: w (k, nx); x = up z, (nx, nx - k), has w'x = 0, and z = down x; the states in each w."""

    quantities: Array
    up: Array
    down: Array
    names: tuple[str, ...]


def conserved(model: LinearModel) -> Conserved:
    """The conserved quantities of a model, by the left null space of [A, B] ([A - 1, B] where it is sampled)."""
    still = np.zeros(len(model.A)) if model.dt is None else np.ones(len(model.A))
    M = np.hstack([model.A - np.diag(still), model.B])
    row, column = np.ones(len(M)), np.ones(M.shape[1])
    for _ in range(SCALINGS):
        size = np.abs(M * row[:, None] * column)
        row /= np.sqrt(_or_one(size.max(axis=1, initial=0.0)))
        column /= np.sqrt(_or_one(size.max(axis=0, initial=0.0)))
    left, sizes, _ = np.linalg.svd(M * row[:, None] * column)
    sizes = np.append(sizes, np.zeros(len(M) - len(sizes)))
    own, rest = left[:, sizes <= NOTHING].T, left[:, sizes > NOTHING]  # in states that are scaled by `row`
    names = tuple(_words(v, row, model.state_names) for v in _sparse(own))
    return Conserved(own * row, rest / row[:, None], rest.T * row, names)


def moved(model: LinearModel) -> LinearModel:
    """What inputs can move: the model itself, or where it conserves something its restriction to w'x = 0.

    The states of that are combinations of the model's, which are outputs of it, by their names.
    """
    found = conserved(model)
    if not found.names:
        return model
    up, down, nx = found.up, found.down, len(model.A)
    own = [i for i, s in enumerate(model.outputs) if s.name not in model.state_names]
    return replace(
        model,
        A=down @ model.A @ up,
        B=down @ model.B,
        E=down @ model.E,
        C=np.vstack([up, model.C[own] @ up]),
        D=np.vstack([np.zeros((nx, model.B.shape[1])), model.D[own]]),
        F=np.vstack([np.zeros((nx, model.E.shape[1])), model.F[own]]),
        states=tuple(Signal(f"free{k + 1}", "1") for k in range(up.shape[1])),
        outputs=(*model.states, *(model.outputs[i] for i in own)),
        x0=down @ model.x0,
        y0=np.concatenate([model.x0, model.y0[own]]),
        f0=down @ model.f0,
    )


def _or_one(size: Array) -> Array:
    return np.where(size > 0, size, 1.0)


def _sparse(w: Array) -> Array:
    """Another base of the rows of w, each with a one where the others have none."""
    base = w.copy()
    for k in range(len(base)):
        pivot = int(np.argmax(np.abs(base[k])))
        base[k] /= base[k, pivot]
        for j in range(len(base)):
            if j != k:
                base[j] -= base[j, pivot] * base[k]
    return base


def _words(own: Array, row: Array, names: tuple[str, ...]) -> str:
    """A sum of the states that take part, by their scaled share, in their own units."""
    most = int(np.argmax(np.abs(own)))
    part = [most, *(i for i in np.flatnonzero(np.abs(own) > 1e-9 * abs(own[most])) if i != most)]
    others = [f"{own[i] * row[i] / (own[most] * row[most]):+.3g} {names[i]}" for i in part[1:]]
    return " ".join([names[most], *others])
