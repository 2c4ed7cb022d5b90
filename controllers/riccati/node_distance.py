"""How far the nodes of an LTVModel leave the cost to go P unknown, measured: half of the nodes against all of them.

Between nodes the model is a cubic spline, and each interval one Magnus step, both of fourth order: without every other
node both errors are some 16 times as large, so that what P changes by is an estimate of its error on the safe side -
as far as the nodes show how the model varies. What passes between two of them unseen, no estimate knows.

    tvlqr   P of all nodes against P of half of them
    held    P with the input held, against that of half the nodes with two steps in each interval: of the steps' error
            it shows 15/16, no more

Measured where there are few intervals, where the nodes left out are not where the others put them, and where a step
turns the fastest pole far: nodes that show well how A varies may be too far apart for a step of it.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from pliant.plants.core.errors import PliantError
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.splines.cubic_spline import CubicSpline

from .ltv_discretisation import SampledLTV

Array = np.ndarray
KNOWN = 1e-3  # of P, against the largest of its diagonal: error that is not warned of
FEW = 8  # intervals, which have not the order of many: it is measured, whatever the values
MISSED = 0.03  # of an entry's range: how far half of the nodes may miss the others before it is measured
TURN = 0.35  # [rad] of the fastest pole within an interval, before it is measured
POLES = 9  # nodes at which poles are looked at
SAFE = 3.0  # on the difference, where nodes are few or do not tell of each other, or it is no more than the error
LARGEST = 0.3  # error that is told: what changes by more has no order, and may be off by any multiple of it
ORDER = 4
ROUNDING = 1e-9  # of an entry: what does not vary
FIELDS = ("t", "A", "B", "E", "C", "D", "F", "c", "x", "u", "w", "y")


class NodeWarning(UserWarning):
    """The nodes of a nominal are too far apart for the cost to go, and the gains, to be known well."""


def doubtful(model: LTVModel, rates: Array) -> bool | None:
    """Whether the error is to be measured, where the motion and the cost to go follow rates (nt, n, n) [1/s].

    None where A and B do not vary by more than rounding: no node is needed. c moves no gain.
    """
    values = _varying(model)
    if not values.shape[1]:
        return None
    if len(model.t) - 1 <= FEW:
        return True
    h = np.diff(model.t)
    looked = np.unique(np.linspace(0, len(rates) - 1, POLES).astype(int))
    if np.abs(np.linalg.eigvals(rates[looked])).max() * h.max() > TURN:
        return True
    return not _told_by_others(h, values)


def _told_by_others(h: Array, values: Array) -> bool:
    """Whether the nodes left out lie where their neighbours put them, h apart, or bend away from there evenly."""
    left, right, far = h[0:-1:2], h[1::2], values[2::2]
    before, at = values[0:-2:2], values[1:-1:2]
    n = min(len(far), len(before), len(at))
    missed = at[:n] - before[:n] - (left / (left + right))[:n, None] * (far[:n] - before[:n])
    bend = np.abs(np.diff(missed, axis=0)).max(axis=0, initial=0.0)  # what is left of the chord, but for its own change
    return bool((bend <= MISSED * np.ptp(values, axis=0)).all())


def _varying(model: LTVModel) -> Array:
    """The entries (nt, k) of A and B that vary by more than rounding."""
    values = np.concatenate([M.reshape(len(model.t), -1) for M in (model.A, model.B)], axis=1)
    return values[:, np.ptp(values, axis=0) > ROUNDING * np.abs(values).max(axis=0)]


def halved(model: LTVModel) -> LTVModel:
    """Of every other node and the last."""
    return _at(model, np.unique(np.append(np.arange(0, len(model.t), 2), len(model.t) - 1)))


def refined(model: LTVModel) -> LTVModel:
    """Half of the nodes told at all of them and half way between."""

    coarse, t = halved(model), np.insert(model.t, np.arange(1, len(model.t)), (model.t[1:] + model.t[:-1]) / 2)
    values = {name: getattr(coarse, name) for name in FIELDS[1:]}
    told: dict[str, Any] = {
        name: CubicSpline(coarse.t, v)(t) if v.size else np.zeros((len(t), *v.shape[1:])) for name, v in values.items()
    }
    return replace(model, t=t, **told)


def joined(step: SampledLTV) -> SampledLTV:
    """Two steps at a time, the input held over both."""
    first, second = (_whole(step, k) for k in (0, 1))
    F, M = second[0] @ first[0], first[1] + first[0].transpose(0, 2, 1) @ second[1] @ first[0]
    x, u = slice(0, step.A.shape[-1]), slice(step.A.shape[-1], -1)
    dynamics = F[:, x, x], F[:, x, u], F[:, x, -1]
    return SampledLTV(*dynamics, M[:, x, x], M[:, u, u], M[:, x, u], M[:, x, -1], M[:, u, -1], M[:, -1, -1])


def measured(
    model: LTVModel, solve: str, roots: Array, coarse: Callable[[], Array], every: int, rates: Array
) -> float | None:
    """The error of P, [[P, p], [p', r]] = S S' at the nodes, S = roots (nt, n, n), against the largest of its diagonal.

    coarse(): S of half the nodes, at each `every`-th and the last; where that is 1, its steps are as short. Zero where
    the model is constant, infinity where nothing tells, or it would be more than LARGEST, None where it was not
    measured (`doubtful`, by `rates`). Warns of more than KNOWN.
    """
    asked = doubtful(model, rates)
    if not asked:
        return 0.0 if asked is None else None
    found, nodes = float("inf"), len(model.t)
    if nodes > 2:
        kept = np.unique(np.append(np.arange(0, nodes, every), nodes - 1))
        try:
            ordered = every > 1 and nodes - 1 > FEW and _told_by_others(np.diff(model.t), _varying(model))
            found = _apart(roots[kept], coarse()) * (1.0 if ordered else SAFE)
        except PliantError:  # half of the nodes are too far apart to be solved: how far all of them are is not told
            found = float("inf")
        if found > LARGEST:
            found = float("inf")
    if found > KNOWN:
        share = f"known only to about {100 * found:.2g} %" if np.isfinite(found) else "not known"
        more = min(max(2.0, (found / KNOWN) ** (1 / ORDER)), 8.0)
        take = np.ceil((nodes - 1) * more)
        warnings.warn(
            f"{solve}: {nodes - 1} intervals between {model.t[0]:.4g} and {model.t[-1]:.4g} s leave the cost to go and "
            f"the gains {share}, by what half of the nodes make of them: take {take:.0f} or more",
            NodeWarning,
            stacklevel=4,
        )
    return found


def _apart(roots: Array, others: Array) -> float:
    whole, other = ((S @ S.transpose(0, 2, 1))[:, :-1, :-1] for S in (roots, others))
    size = np.sqrt(np.maximum(np.diagonal(whole, axis1=1, axis2=2), 0.0)).max(axis=0)  # at the end it may be nothing
    unit = size[:, None] * size
    return float((np.abs(whole - other) / np.where(unit > 0, unit, np.inf)).max(initial=0.0))


def _at(model: LTVModel, nodes: Array) -> LTVModel:
    return replace(model, **{name: getattr(model, name)[nodes] for name in FIELDS})


def _whole(step: SampledLTV, k: int) -> tuple[Array, Array]:
    """F and M of [x; u; 1] of every other step."""
    A, B, c, Q, R, N, q, s, r = (part[k::2] for part in step)
    T, nx, nu = B.shape
    F, M = np.zeros((T, nx + nu + 1, nx + nu + 1)), np.zeros((T, nx + nu + 1, nx + nu + 1))
    x, u = slice(0, nx), slice(nx, nx + nu)
    F[:, x, x], F[:, x, u], F[:, x, -1], F[:, u, u], F[:, -1, -1] = A, B, c, np.eye(nu), 1.0
    M[:, x, x], M[:, u, u], M[:, -1, -1] = Q, R, r
    M[:, x, u], M[:, u, x] = N, N.transpose(0, 2, 1)
    M[:, x, -1], M[:, -1, x], M[:, u, -1], M[:, -1, u] = q, q, s, s
    return F, M
