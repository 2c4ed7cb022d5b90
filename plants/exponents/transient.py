"""How far deviations grow before a long-run rate shows: the largest |Phi(t, t0)| over a record, or of a constant model.

Sizes are those of the states as they are: in scaled coordinates growth by a large coupling would not be seen. A stable
exponent says nothing of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear import magnus
from pliant.plants.linear.lti import LinearModel
from pliant.plants.stability.transition_growth import chain
from pliant.plants.transitions.state_matrix_path import Model, kept, scaling

TIMES, TURNS, DECAYED = 400, 30.0, 30.0  # of a constant model: times, slowest decays and longest periods looked at


@dataclass(frozen=True, eq=False)
class Transient(OwnsArrays):
    """The most that a deviation of size 1 at the start has grown by."""

    factor: float  # [1]
    time: float  # [s] when
    direction: np.ndarray  # (n,) of the deviation at the start, of size 1


def transient(model: Model, states: Sequence[str] | None = None) -> Transient:
    """Over the record; of a LinearModel until its slowest decay has halved it forty times."""
    if isinstance(model, LinearModel):
        keep = kept(model, states)
        A = model.A[np.ix_(keep, keep)]
        lam = np.linalg.eigvals(A)
        even = scaling(A[None])
        size = max(float(np.linalg.norm(A * even / even[:, None])), 1e-9)
        slow = np.abs(lam.real)[np.abs(lam.real) > 1e-6 * size]
        span = DECAYED / float(slow.min(initial=size))
        h = min(span / TIMES, 0.2 / size)
        step, scale = magnus.expm(A[None] * h)[0], np.ones(len(A))
        count = min(int(np.ceil(span / h)), 20 * TIMES)
        t, steps = h * np.arange(count + 1), np.broadcast_to(step, (count, *A.shape))
        return grown(t, steps, scale)
    return grown(*chain(model, states))


def grown(t: np.ndarray, steps: np.ndarray, scale: np.ndarray) -> Transient:
    """From transitions (nt-1, n, n) between the times t (nt,), in x / scale (n,)."""
    n = steps.shape[-1]
    total, power, best = np.eye(n), 0.0, (0.0, 0.0, np.eye(n))
    for k, step in enumerate(steps):
        total = step @ total
        within = float(np.abs(total).max())
        if within > 1e100 or 0 < within < 1e-100:
            total, power = total / within, power + float(np.log(within))
        real = total * scale[:, None] / scale
        bound = float(np.log(max(float(np.linalg.norm(real)), 1e-300))) + power
        if bound <= best[0]:  # Frobenius' norm is never less
            continue
        size = float(np.log(max(float(np.linalg.norm(real, 2)), 1e-300))) + power
        if size > best[0]:
            best = (size, float(t[k + 1] - t[0]), real)
    _, _, right = np.linalg.svd(best[2])
    return Transient(float(np.exp(min(best[0], 700.0))), best[1], right[0] if n else np.zeros(0))
