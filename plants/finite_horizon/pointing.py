"""Pointing budget of a motion: absolute, mean and relative performance error over windows, of noise and of limits.

With e(t) the error of an output about its nominal and a window of length D, as ECSS-E-ST-60-10C defines them,

APE   e(t)                       absolute performance error
MPE   the mean of e over D       mean performance error
RPE   e(t) less that mean        relative performance error

White noise and a start that is not known make e a zero-mean Gaussian: its standard deviations follow from covariances,
the RPE's averaged over the window as in ESSB-HB-E-003 (mean of e^2 = MPE^2 + RPE^2). Disturbances within limits make it
at most so large, by the adjoint. A budget at a confidence adds both: n sigma + the most.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_instance, require_mapping, require_number
from pliant.plants.core.signals import OwnsArrays, Signal, names
from pliant.plants.linear.ltv import LTVModel

from .asked import asked, not_negative, said
from .stretches import Stretches

Array = np.ndarray
POINTS = 16  # times of a window at which bounded disturbances are looked at


@dataclass(frozen=True, eq=False)
class PointingBudget(OwnsArrays):
    """Errors of outputs (nz) in their units over windows (nw) that follow one another, of the linear model.

    sigma: standard deviations of noise and start; most: what disturbances within their limits, held over each stretch
    of the fastest mode's half radian, do at most, at the ends of a window and 14 times between.
    """

    outputs: tuple[Signal, ...]
    window: float  # [s]
    windows: Array = field(repr=False)  # (nw, 2) [s] starts and ends
    ape_sigma: Array = field(repr=False)  # (nw, nz) the largest within each window
    mpe_sigma: Array = field(repr=False)  # (nw, nz)
    rpe_sigma: Array = field(repr=False)  # (nw, nz) the root of the mean variance within each window
    ape_most: Array = field(repr=False)  # (nw, nz)
    mpe_most: Array = field(repr=False)  # (nw, nz)
    rpe_most: Array = field(repr=False)  # (nw, nz)
    confidence: float  # that each axis keeps the budget, where what is random is Gaussian

    @property
    def factor(self) -> float:
        """n of n sigma: 3 at 0.9973."""
        from scipy.special import ndtri

        return float(ndtri((1 + self.confidence) / 2))

    @property
    def ape(self) -> Array:
        """(nw, nz) n sigma + the most that bounded disturbances do."""
        return self.factor * self.ape_sigma + self.ape_most

    @property
    def mpe(self) -> Array:
        """(nw, nz)"""
        return self.factor * self.mpe_sigma + self.mpe_most

    @property
    def rpe(self) -> Array:
        """(nw, nz)"""
        return self.factor * self.rpe_sigma + self.rpe_most

    @property
    def words(self) -> str:
        """The budget of the worst window of each output."""
        own = (
            f"{s.name}: APE {said(self.ape[:, i].max(), s.unit)}, MPE {said(self.mpe[:, i].max(), s.unit)}, "
            f"RPE {said(self.rpe[:, i].max(), s.unit)}"
            for i, s in enumerate(self.outputs)
        )
        return f"over {self.window:.4g} s, at {self.confidence:.4%} confidence: " + "; ".join(own)


def pointing_budget(
    model: LTVModel,
    outputs: Sequence[str],
    window: float,
    *,
    noise: Mapping[str, float] | None = None,
    start: Mapping[str, float] | None = None,
    limits: Mapping[str, float] | None = None,
    confidence: float = 0.9973,
) -> PointingBudget:
    """The budget of `outputs` (or states) over windows of `window` [s] from the start on; a rest is left out.

    noise: of disturbances or inputs by name, the root of their power spectral density, two-sided [unit sqrt(s)]; start:
    standard deviations of states by name; limits: the largest absolute value of disturbances or inputs by name. Those
    that are not named are zero. ValueError for names that the model does not have, where nothing is named, for a window
    longer than the motion, and for noise that an output feels without delay: its variance is not finite.

    Sources: ECSS-E-ST-60-10C (2008), annex A; ESSB-HB-E-003, "ESA pointing error engineering handbook" (2011).

    Example
    -------
    >>> along = craft.linearize_along(slew)
    >>> told = pointing_budget(along, ["attitude_x"], 10.0, noise={"disturbance_x": 1e-4}, limits={"torque_x": 1e-3})
    >>> print(told.words, told.rpe.max(axis=0))
    """
    model = require_instance("pointing_budget.model", model, LTVModel)
    pushing = (*names(model.disturbances), *names(model.inputs))
    noise, limits = (
        require_mapping(f"pointing_budget.{word}", {} if given is None else given, pushing, "disturbance or input")
        for word, given in (("noise", noise), ("limits", limits))
    )
    known = names(model.states)
    start = require_mapping("pointing_budget.start", {} if start is None else start, known, "state")
    window = require_number("pointing_budget.window", window, unit="s")
    confidence = require_number("pointing_budget.confidence", confidence, "positive")
    if not confidence < 1:
        raise ValueError(f"pointing_budget.confidence = {confidence:g} must be > 0 and < 1")
    span = float(model.t[-1] - model.t[0])
    if not 0 < window <= span * (1 + 1e-9):
        raise ValueError(f"pointing_budget.window = {window:.6g} must be > 0 and at most {span:.6g} s")
    if not (noise or start or limits):
        raise ValueError("pointing_budget: noise, start and limits name nothing, one of them must")
    who = tuple(dict.fromkeys((*noise, *limits))) or pushing[:1]
    of = asked(model, outputs, who, None, None)
    root = np.array([not_negative("pointing_budget.noise", n, noise.get(n, 0.0)) for n in who])
    most = np.array([not_negative("pointing_budget.limits", n, limits.get(n, 0.0)) for n in who])
    P0 = np.diag([not_negative("pointing_budget.start", n, start.get(n, 0.0)) ** 2 for n in known])
    known_w = (*names(model.disturbances), *names(model.inputs))
    columns = [known_w.index(n) for n in who]
    E = np.concatenate([model.E, model.B], axis=-1)[..., columns]
    F = np.concatenate([of.rows.F, of.rows.D], axis=-1)[..., columns]
    if np.abs(F[..., root > 0]).max(initial=0.0) > 0:
        raise ValueError("pointing_budget.noise: an output feels some of it without delay, its variance is not finite")
    summed, nz, n = _with_integrals(model, of.rows.C, of.outputs), len(of.outputs), len(known)
    seen = np.concatenate([of.rows.C, np.zeros((len(model.t), nz, nz))], axis=-1)
    on = Stretches(summed, np.concatenate([E, F], axis=1), seen, F)
    count = int(span / window * (1 + 1e-9))
    at = np.array([np.abs(on.t - (on.t[0] + k * window)).argmin() for k in range(count + 1)])
    noisy = Stretches(summed, np.concatenate([E, F], axis=1) * root, seen, F)
    found = [_random(noisy, at, P0, n), _bounded(on, at, most, n)]
    ape, mpe, rpe = (np.array(v) for v in zip(*found, strict=True))
    ends = np.stack([on.t[at[:-1]], on.t[at[1:]]], axis=1)
    sizes = ape[0], mpe[0], rpe[0], ape[1], mpe[1], rpe[1]
    return PointingBudget(of.outputs, window, ends, *sizes, confidence)


def _with_integrals(model: LTVModel, C: Array, outputs: Sequence[Signal]) -> LTVModel:
    """With the integrals of outputs as further states."""
    nt, n, nz = len(model.t), model.A.shape[-1], len(outputs)
    A = np.zeros((nt, n + nz, n + nz))
    A[:, :n, :n], A[:, n:, :n] = model.A, C
    more = tuple(Signal(f"integral_of_{s.name}", f"{s.unit} s".strip()) for s in outputs)
    wide: dict[str, Any] = {
        k: np.concatenate([v, np.zeros((nt, nz, v.shape[-1]))], axis=1) for k, v in (("B", model.B), ("E", model.E))
    }
    C = np.concatenate([model.C, np.zeros((nt, model.C.shape[1], nz))], axis=-1)
    rows: dict[str, Any] = {
        k: np.concatenate([v, np.zeros((nt, nz))], axis=1) for k, v in (("c", model.c), ("x", model.x))
    }
    return dataclasses.replace(model, A=A, C=C, states=(*model.states, *more), **wide, **rows)


def _random(on: Stretches, at: Array, P0: Array, n: int) -> tuple[Array, Array, Array]:
    """Standard deviations (nw, nz) of APE, MPE and RPE."""
    (Phi, _), step, sees = on.held, on.gramians, on.nodes[1][..., :n]
    P = np.zeros((on.n, on.n))
    P[:n, :n] = P0
    absolute, mean, relative = (np.zeros((len(at) - 1, on.nz)) for _ in range(3))
    for w, (first, last) in enumerate(pairwise(at)):
        P[n:], P[:, n:] = 0.0, 0.0  # the integrals begin with the window
        variance = [_seen(sees[first], P[:n, :n])]
        for k in range(first, last):
            P = Phi[k] @ P @ Phi[k].T + step[k]
            variance.append(_seen(sees[k + 1], P[:n, :n]))
        length = on.t[last] - on.t[first]
        square = np.diagonal(P[n:, n:]) / length**2
        absolute[w], mean[w] = np.max(variance, axis=0), square
        relative[w] = np.trapezoid(variance, on.t[first : last + 1], axis=0) / length - square
    return np.sqrt(absolute), np.sqrt(mean), np.sqrt(np.maximum(relative, 0.0))


def _seen(sees: Array, P: Array) -> Array:
    return np.maximum(np.einsum("ij,jk,ik->i", sees, P, sees), 0.0)


def _bounded(on: Stretches, at: Array, limits: Array, n: int) -> tuple[Array, Array, Array]:
    """The most (nw, nz) of APE, MPE and RPE at some times of each window, of |w| <= limits held over each stretch."""
    (Phi, Gamma), (_, C, F), nz = on.held, on.nodes, on.nz
    absolute, mean, relative = (np.zeros((len(at) - 1, nz)) for _ in range(3))
    if not limits.any():
        return absolute, mean, relative
    for w, (first, last) in enumerate(pairwise(at)):
        some = np.unique(np.linspace(first, last, POINTS).round().astype(int))[::-1]
        length, count = on.t[last] - on.t[first], len(some)
        rows = np.zeros((2 * count + 1, nz, on.n))  # e at those times, less the mean; and the mean
        rows[count:, np.arange(nz), n + np.arange(nz)] = -1.0 / length
        total = np.zeros((2 * count + 1, nz, on.nw))
        for k in range(last, -1, -1):
            for j in np.flatnonzero(some == k):
                rows[[j, count + j]] += C[k]
                total[[j, count + j]] += np.abs(F[k])
            if k == first:
                rows[..., n:] = 0.0
            if k:
                total += np.abs(rows @ Gamma[k - 1])
                rows = rows @ Phi[k - 1]
        reach = total @ limits
        absolute[w], mean[w] = reach[:count].max(axis=0), reach[-1]
        relative[w] = reach[count:-1].max(axis=0)
    return absolute, mean, relative
