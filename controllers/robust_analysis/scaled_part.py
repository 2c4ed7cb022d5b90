"""One part of a box of parameters in which a sampled loop is shown to be stable by scalings, rest included.

A(delta) over the part is a linear fractional form of its parameters, and what that lacks a full block beside them:

    A(delta) = A_f(delta) + r Delta,   |Delta| <= 1,   r = twice the |A - A_f| that was measured at most

in coordinates in which the middle's own modes fall. D and G scalings that hold at all frequencies show that no member
has an eigenvalue on the circle, and the middle is stable. That costs as much as some hundred looks at norms, and holds
for parts many times as large: real parameters count as real.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import NamedTuple

import numpy as np

from pliant.controllers.uncertain_blocks.blocks import Block
from pliant.controllers.uncertain_blocks.fractional_form import FractionalForm, check_points, fitted
from pliant.controllers.uncertain_blocks.over_frequencies import bound

from .modal_norms import Norms, lyapunov_norms, modal_norms

Array = np.ndarray
TWICE = 2.0
ROWS = 20
ALIKE, SHARE = 0.6, 0.5


class Scaled(NamedTuple):
    """Whether it is shown; |rest|/|A| in the coordinates of the middle's modes; what looking for scalings cost beside
    that of ROWS rows, 0 where a rest too large for the middle alone makes it idle."""

    holds: bool
    left: float
    cost: float


def holds_by_scalings(at: Callable[[Array], Array], centre: Array, half: Array) -> Scaled:
    """Of all of centre +- half."""
    corners = [at(centre + half * d) for d in product((-1.0, 1.0), repeat=len(half))]
    every = np.array([at(centre), *corners])
    norms = modal_norms(every, ALIKE) or lyapunov_norms(every[:1], SHARE)
    if norms is None:
        return Scaled(False, 0.0, 0.0)

    def seen(delta: Array) -> Array:
        return norms.T @ at(centre + half * delta) @ norms.inverse

    try:
        form = fitted(seen, len(half), 1.0)
    except ValueError:  # a parameter that hardly counts in this part
        return Scaled(False, 0.0, 0.0)
    rest = max(float(np.linalg.norm(seen(d) - form.at(d), 2)) for d in check_points(len(half)))
    if TWICE * rest * _resolvent(every[0], norms) >= 1:
        return Scaled(False, rest, 0.0)  # in the middle alone
    n, r = len(form.A), float(np.sqrt(TWICE * rest))
    whole = FractionalForm(
        form.A,
        np.hstack([form.B, r * np.eye(n)]),
        np.vstack([form.C, r * np.eye(n)]),
        np.block([[form.D, np.zeros((len(form.D), n))], [np.zeros((n, len(form.D) + n))]]),
        (*form.blocks, Block("full", n)),
        form.dt,
    )
    cost = (len(whole.D) / ROWS) ** 4
    return Scaled(bound(whole, 1.0, 1.0).beta <= 1, rest / float(np.linalg.norm(form.A, 2)), cost)


def _resolvent(A: Array, norms: Norms) -> float:
    """|(z - A)^-1| at some points of the circle, the largest, in the norms' coordinates."""
    own = norms.T @ A @ norms.inverse
    turns = np.concatenate([np.angle(np.linalg.eigvals(A)), [0.0, np.pi]])
    z = np.exp(1j * turns)[:, None, None]
    return float(1 / np.linalg.svd(z * np.eye(len(A)) - own, compute_uv=False)[:, -1].min())
