"""Lyapunov exponents and dichotomy (Sacker-Sell) intervals of a linear model, and the verdict that follows from them.

The dichotomy spectrum of dx/dt = A(t) x is the set of rates s for which A - s has no exponential dichotomy: intervals,
points for constant and periodic A. All below zero: every deviation decays, uniformly. One above: some grows. One around
zero: drift, which neither decays nor grows; its states are named. Infinity is not in a record, so `beyond` says what
the answer takes for granted after it, and the answer repeats that:

"constant"  A stays what it is at the end
"tends"     A comes to stay within `within` [1/s] of `limit`: by roughness the intervals are Re lambda +- k within,
            k the condition of the eigenvectors; points where `within` is 0
"periodic"  A repeats with its period: ln|multiplier| / period
"persists"  averages of the triangular model's diagonal over windows of `window` [s] go on to lie between the least and
            the largest of the record (Steklov averages); directions that are not separated are taken together

Source   Sacker and Sell 1978; Dieci and Van Vleck 2002, 2007; roughness: Coppel 1978. Perron 1930: where averages have
         no limit (`regular` is False) exponents below zero do not keep perturbations small; the intervals do
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.argument_gates import LEAST, require_choice, require_finite, require_number, require_seconds
from pliant.plants.linear.lti import LinearModel
from pliant.plants.stability.floquet import floquet
from pliant.plants.stability.frozen_time import model_states
from pliant.plants.stability.transition_growth import chain
from pliant.plants.stability.verdict import rounding
from pliant.plants.transitions.eigenvalue_bounds import bounds
from pliant.plants.transitions.state_matrix_path import Model, Path, as_pieces, kept, scaling

from .long_run import Spectrum, from_intervals
from .transient import grown, transient
from .triangular_flow import TriangularFlow, triangular_flow

BEYOND = ("constant", "tends", "periodic", "persists")
REST, STRAYED = 1e-2, 2.0  # of the fastest average; of how far integrals strayed over stretches a quarter as long


def spectrum(
    model: Model,
    *,
    beyond: str = "persists",
    states: Sequence[str] | None = None,
    window: float | None = None,
    settle: float | None = None,
    period: float | None = None,
    limit: Any = None,
    within: float = 0.0,
) -> Spectrum:
    """Exponents and intervals of a LinearModel, an LTVModel or pieces joined by jumps; see above for `beyond`.

    `window` [s] of averages, None: half the record; `settle` [s]: running averages are looked at from so long after the
    start, None: half the record ("persists"). `period` [s] of "periodic", None: found. `limit` (nx, nx) [1/s], None: A
    at the end, and `within` [1/s] (2-norm, of the states as they are) of "tends". ValueError for an option that belongs
    to another `beyond`. Example: `spectrum(ltv, beyond="tends", limit=A_end, within=1e-3).verdict`
    """
    require_choice("spectrum", "beyond", beyond, BEYOND)
    within = require_number("spectrum.within", within, least=0.0, unit="1/s")
    for name, value, own in (("window", window, "persists"), ("settle", settle, "persists")):
        if value is not None and beyond != own:
            raise ValueError(f"spectrum.{name} = {value!r} belongs to beyond = {own!r}, must be None")
    if period is not None and beyond != "periodic":
        raise ValueError(f"spectrum.period = {period!r} belongs to beyond = 'periodic', must be None")
    if (limit is not None or within) and beyond != "tends":
        raise ValueError("spectrum.limit, within belong to beyond = 'tends', must be None and 0")
    if isinstance(model, LinearModel):
        if model.dt is not None:
            raise ValueError(f"spectrum: model.dt = {model.dt:g} must be None (continuous time)")
        beyond = "constant" if beyond == "persists" else beyond
    if beyond in ("constant", "tends"):
        return _of_limit(model, states, limit, within, beyond)
    if beyond == "periodic":
        return _of_period(model, states, period)
    return _of_record(model, states, window, settle)


def _of_limit(model: Model, states: Sequence[str] | None, limit: Any, within: float, beyond: str) -> Spectrum:
    keep, names = kept(model, states), model_states(model)
    A = model.A if isinstance(model, LinearModel) else as_pieces(model).pieces[-1].A[-1]
    if limit is not None:
        A = require_finite("spectrum.limit", limit, A.shape)
    A = A[np.ix_(keep, keep)]
    scale = scaling(A[None])
    balanced = A * scale / scale[:, None]
    b = bounds(balanced, rounding(balanced), line=True)
    order = np.argsort(-b.values.real, kind="stable")
    lam, V, error = b.values[order], b.vectors[:, order], b.errors[order]
    reach = _reach(A, scale[:, None] * V) * within if within else 0.0
    low, high = lam.real - error - reach, lam.real + error + reach
    assumption = "A stays as it is" if isinstance(model, LinearModel) else "A stays what it is at the end of the record"
    if beyond == "tends":
        whom = "A at the end of the record" if limit is None else "the given limit"
        assumption = f"A tends to {whom}" + (f" to within {within:.4g} 1/s and stays so near" if within else "")
    own = tuple(names[k] for k in keep)
    return _made(own, lam.real, low, high, (A, lambda z: z.real), model, states, assumption)


def _reach(A: np.ndarray, V: np.ndarray) -> float:
    """How far the intervals move for a change of A of size 1: the condition of its eigenvectors, well scaled; else that
    of nothing better than the whole line."""
    size = np.linalg.norm(V, axis=0)
    if not len(A) or not (size > 0).all():
        return np.inf
    found = float(np.linalg.cond(V / size))
    return found if found < 1e12 else np.inf


def _of_period(model: Model, states: Sequence[str] | None, period: float | None) -> Spectrum:
    cycle = floquet(model, period, states=states)
    lam, T = np.abs(cycle.multipliers), cycle.period
    with np.errstate(divide="ignore"):
        rates = np.log(lam) / T
        low = np.log(np.maximum(lam - cycle.error, 0.0)) / T
        high = np.minimum(np.log(lam + cycle.error) / T, max(float(rates.max()), cycle.growth_bound))
    measure = lambda z: np.log(np.maximum(np.abs(z), 1e-300)) / T  # noqa: E731
    assumption = f"A repeats with its period of {T:.6g} s"
    return _made(cycle.states, rates, low, high, (cycle.monodromy, measure), model, states, assumption)


def _of_record(model: Model, states: Sequence[str] | None, window: float | None, settle: float | None) -> Spectrum:
    steps = chain(model, states)
    flow = triangular_flow(model, states, steps)
    span = float(flow.t[-1] - flow.t[0])
    length = span / 2 if window is None else require_seconds("spectrum.window", window, LEAST)
    wait = span / 2 if settle is None else require_seconds("spectrum.settle", settle, LEAST)
    for name, value in (("window", length), ("settle", wait)):
        if value > span * (1 + 1e-9):
            raise ValueError(f"spectrum.{name} = {value:.6g} must be > 0 and at most {span:.6g} s")
    length = min(length, span)
    keep, names = kept(model, states), model_states(model)
    mean = (flow.logs[-1] - flow.logs[0]) / span
    late = flow.averages[flow.t[1:] - flow.t[0] >= wait * (1 - 1e-12)]
    averages = np.column_stack([late.min(axis=0), late.max(axis=0)])
    groups, gaps = separated(flow, length)
    seen = flow.steklov(length)
    hidden = _hidden(model, keep, flow.scale, length)
    intervals = []
    for group in groups:
        if len(group) == 1:
            intervals.append((seen[:, group[0]].min(), seen[:, group[0]].max()))
        else:
            own, (low, high) = seen[:, list(group)], flow.block(group[0], group[-1] + 1, length)
            intervals.append((min(low, own.min()), max(high, own.max())))
    found = np.array(intervals).reshape(-1, 2) + np.array([-hidden, hidden])
    Q = flow.Q[-1] * flow.scale[:, None]
    assumption = f"averages over {length:.4g} s go on to lie between those of the record"
    named, before = tuple(names[k] for k in keep), grown(*steps)
    return from_intervals(named, mean, found, groups, gaps, Q, averages, _rests(flow), before, assumption, length)


def _rests(flow: TriangularFlow) -> bool:
    """Whether running averages hardly move any more, or whether the integrals stray from straight lines over late
    stretches hardly more than over early, shorter ones: so do sums of oscillations; Perron's stray the more, like t.
    """
    since = (flow.t - flow.t[0]) / (flow.t[-1] - flow.t[0])
    size = max(float(np.abs(flow.averages).max(initial=0.0)), 1e-300)
    half = flow.averages[since[1:] >= 0.5]
    if np.ptp(half, axis=0).max(initial=0.0) <= REST * size:
        return True

    def strays(low: float, high: float) -> np.ndarray:
        inside = (since >= low) & (since <= high)
        if inside.sum() < 4:
            return np.zeros(flow.logs.shape[1])
        t, logs = flow.t[inside], flow.logs[inside]
        line = np.polynomial.polynomial.polyfit(t - t[0], logs, 1)
        return np.asarray(np.ptp(logs - line[0] - np.outer(t - t[0], line[1]), axis=0))

    slack = 1e-9 * size * (flow.t[-1] - flow.t[0])
    pairs = (((1 / 2, 1), (1 / 8, 1 / 4)), ((1 / 4, 1 / 2), (1 / 16, 1 / 8)))
    return all(bool((strays(*late) <= STRAYED * strays(*early) + slack).all()) for late, early in pairs)


def separated(flow: TriangularFlow, window: float) -> tuple[tuple[tuple[int, ...], ...], np.ndarray]:
    """Neighbouring columns in one group where over some window the later grew as fast as the earlier (no integral
    separation), and the least differences [1/s] between the groups."""
    seen = flow.steklov(window)
    n = seen.shape[1]
    least = (seen[:, :-1] - seen[:, 1:]).min(axis=0) if n > 1 else np.zeros(0)
    cut = [k + 1 for k in range(n - 1) if (seen[:, : k + 1].min(axis=1) - seen[:, k + 1 :].max(axis=1)).min() > 0]
    edges = [0, *cut, n]
    groups = tuple(tuple(range(a, b)) for a, b in pairwise(edges) if b > a)
    return groups, least[[k - 1 for k in cut]]


def _hidden(model: Model, keep: list[int], scale: np.ndarray, window: float) -> float:
    """What A may do between its nodes, averaged [1/s] over the window where it is most: to first order."""
    most = 0.0
    for piece in as_pieces(model).pieces:
        path = Path(piece.t, piece.A[:, keep][:, :, keep], scale)
        total = np.concatenate([[0.0], np.cumsum(np.linalg.norm(path.area(), axis=(1, 2)))])
        later = np.interp(np.minimum(piece.t + window, piece.t[-1]), piece.t, total)
        most = max(most, float((later - total).max(initial=0.0)))
    return most / window


def _made(
    names: tuple[str, ...],
    rates: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    source: tuple[np.ndarray, Callable[[Any], Any]],
    model: Model,
    states: Sequence[str] | None,
    assumption: str,
) -> Spectrum:
    """From intervals (n,) of each exponent, those that overlap taken together; `source`: the matrix with the groups'
    invariant spaces, and the rate of its eigenvalues."""
    groups: list[list[int]] = []
    order = np.argsort(-rates, kind="stable")
    rates, low, high = rates[order], low[order], high[order]
    for k in range(len(rates)):
        if groups and high[k] >= low[groups[-1]].min():
            groups[-1].append(k)
        else:
            groups.append([k])
    found = np.array([(low[g].min(), high[g].max()) for g in groups]).reshape(-1, 2)
    M, measure = source
    spaces = [invariant(M, measure, rates[g].min(), rates[g].max()) for g in groups]
    V = np.concatenate([Z[:, : len(g)] for Z, g in zip(spaces, groups)], axis=1) if groups else np.zeros((0, 0))
    both = np.column_stack([rates, rates])
    about = found, tuple(map(tuple, groups)), found[:-1, 0] - found[1:, 1], V, both, True
    return from_intervals(names, rates, *about, transient(model, states), assumption, np.nan)


def invariant(M: np.ndarray, measure: Callable[[Any], Any], low: float, high: float) -> np.ndarray:
    """Orthonormal columns (n, n), the first of them a basis of the space whose rates lie within [low, high]."""
    values = measure(np.linalg.eigvals(M))
    slack = 1e-6 * max(float(np.abs(values).max(initial=0.0)), 1e-12)
    scale = scaling(M[None])
    balanced = M * scale / scale[:, None]
    inside = lambda z: bool(low - slack <= measure(z) <= high + slack)  # noqa: E731
    _, Z, _ = sla.schur(balanced.astype(complex), output="complex", sort=inside)
    real = Z * scale[:, None]
    return np.linalg.qr(real)[0]
