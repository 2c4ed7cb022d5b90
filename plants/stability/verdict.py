"""The verdict on a model's stability: the answer, and what each method said of it; that on a constant model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear.lti import LinearModel

from .eigenvalue_bounds import EPS, bounds
from .frozen_time import said_coordinates
from .state_matrix_path import kept, scaling

METHODS = ("eigenvalues", "floquet", "slow_variation", "lyapunov", "growth", "frozen_time")
CLEAR = 1e-4  # error from which on "cannot be told from the boundary" is no finding: of a multiplier, or of |A|
CANCELLED = 16  # times the rounding of a term: sums of as many
GROWTH = ("decays", "bounded", "polynomial", "exponential", "unknown")


@dataclass(frozen=True, eq=False)
class Verdict(OwnsArrays):
    """The answer, the method that gave it, and what every other method said or why it was not used."""

    verdict: str  # stable | unstable | marginal | undecided
    method: str  # the deciding method, "" where undecided
    margin: float  # decay rate [1/s] of the slowest deviation; below zero: growth. An estimate
    critical_times: tuple[float, ...]  # [s] where frozen roots cross the axis, or windows begin or cease to grow
    why: str
    reasons: Mapping[str, str]  # of every method but the deciding one
    evidence: Mapping[str, Any] = field(repr=False)  # the results by method
    coordinates: str = ""  # in which the frozen-time roots were taken
    margin_bound: float = np.nan  # [1/s] guaranteed: whatever the data allow, none decays slower; NaN: none
    growth: str = "unknown"  # of GROWTH: how the deviation that lasts longest behaves

    @property
    def stable(self) -> bool:
        return self.verdict == "stable"

    def rows(self) -> list[tuple[str, str, str]]:
        """Method, role ("decides", "beside", "not used") and words: the verdict's table."""
        found = []
        for name in METHODS:
            role = "decides" if name == self.method else "beside" if name in self.evidence else "not used"
            found.append((name, role, self.why if name == self.method else self.reasons.get(name, "")))
        return found

    def __str__(self) -> str:
        head = f"{self.verdict} by {self.method}" if self.method else self.verdict
        lines = [f"{head}: {self.why}", *(f"  {name}, {role}: {text}" for name, role, text in self.rows())]
        if self.critical_times:
            lines.append("  critical times [s]: " + ", ".join(f"{t:.4g}" for t in self.critical_times[:12]))
        return "\n".join(lines)

    def to_json(self) -> dict[str, Any]:
        return {
            "verdict": self.verdict,
            "method": self.method,
            "margin": self.margin if np.isfinite(self.margin) else None,
            "margin_bound": self.margin_bound if np.isfinite(self.margin_bound) else None,
            "growth": self.growth,
            "critical_times": list(self.critical_times),
            "why": self.why,
            "reasons": dict(self.reasons),
            "coordinates": self.coordinates,
        }


def of_constant(
    model: LinearModel, states: Sequence[str] | None, coordinates: str | None, spread: np.ndarray | None = None
) -> Verdict:
    """The verdict on a LinearModel, continuous or sampled: its eigenvalues decide, rounding considered.

    `spread` (nx, nx): what else its entries may be off.
    """
    keep = kept(model, states)
    A = model.A[np.ix_(keep, keep)]
    scale = scaling(A[None])
    D = cancelled(A, [model.states[k].unit for k in keep]) * scale / scale[:, None]
    A = A * scale / scale[:, None]
    line = model.dt is None
    D = D + rounding(A)
    if spread is not None:
        D = D + spread[np.ix_(keep, keep)] * scale / scale[:, None]
    b = bounds(A, D, line=line)

    def rate(size: float) -> float:
        return size if line else float(np.log(max(size, 1e-300)) / model.dt) if size < np.inf else np.inf

    sizes = b.values.real if line else np.abs(b.values)
    edge, unit = 1.0, 1.0
    if line:  # the Perron root of |A|, which no scaling of states changes
        edge, unit = 0.0, float(np.abs(np.linalg.eigvals(np.abs(A))).max(initial=0.0))
    near = np.abs(sizes - edge) <= b.errors
    found = rate(float(sizes.max(initial=-np.inf if line else 0.0)))
    power = 0
    if b.outside:
        verdict, kind, words = "unstable", "exponential", f"the fastest grows at {found:.4g} 1/s"
    elif b.inside and (spread is None or not spread.any() or b.most - sizes.max() <= 0.1 * abs(sizes.max() - edge)):
        verdict, kind, words = "stable", "decays", f"the slowest decays at {-found:.4g} 1/s"
    else:
        error = float(b.errors[near].max(initial=0.0))
        verdict = "marginal" if near.any() and error <= CLEAR * unit else "undecided"
        power = degree(A, b.values, b.errors, near)
        kind = "unknown" if verdict == "undecided" else "polynomial" if power else "bounded"
        where = "on the imaginary axis" if line else "on the unit circle"
        words = f"{int(near.sum())} of {len(sizes)} eigenvalues {where}, the others decay; not to be told from it to "
        words += f"within {error:.2g}" + (" 1/s" if line else "")
        if power:
            words += f"; they share directions: deviations may grow like t^{power}, a power of time and no exponential"
        found = found if verdict == "undecided" else 0.0
    reasons = dict.fromkeys(METHODS[1:], "the model is constant: its eigenvalues decide")
    evidence: dict[str, Any] = {"eigenvalues": b.values}
    said, decided = coordinates or said_coordinates(model, states), "" if verdict == "undecided" else "eigenvalues"
    if not decided:
        reasons["eigenvalues"] = words
    return Verdict(verdict, decided, 0.0 - found, (), words, reasons, evidence, said, -rate(b.most), kind)


def rounding(A: np.ndarray) -> np.ndarray:
    """What rounding leaves open (n, n) in a matrix that came out of a computation; zeros are taken as meant."""
    size = np.abs(A)
    row, column = size.sum(axis=1, keepdims=True), size.sum(axis=0, keepdims=True)
    return EPS * (2 * len(A) * size + 4 * np.minimum(row, column)) * (size > 0)


def cancelled(A: np.ndarray, units: Sequence[str]) -> np.ndarray:
    """What is open (n, n) in entries that are left where larger ones cancel: rounding of the largest entry of their row
    among states of the same unit, which no choice of units changes. Zeros, and states without a unit, leave nothing.
    """
    size, D = np.abs(A), np.zeros(A.shape)
    for unit in {unit for unit in units if unit}:
        own = [k for k, name in enumerate(units) if name == unit]
        D[:, own] = CANCELLED * EPS * size[:, own].max(axis=1, keepdims=True)
    return D * (size > 0)


def degree(M: np.ndarray, values: np.ndarray, errors: np.ndarray, near: np.ndarray) -> int:
    """The power of time with which motions of the eigenvalues `near` the boundary may grow: 0 where each has its own
    direction. Equal ones are as many as M - mean has fewer directions that it sends to zero.
    """
    size = max(float(np.abs(M).sum(axis=1).max(initial=0.0)), 1e-300)
    rest, found = list(np.flatnonzero(near)), 0
    while rest:
        k = rest[0]
        same = [j for j in rest if abs(values[j] - values[k]) <= errors[j] + errors[k] + 64 * EPS * size]
        rest = [j for j in rest if j not in same]
        if len(same) > 1:
            mean = values[same].mean()
            least = np.linalg.svd(M - mean * np.eye(len(M)), compute_uv=False)[-len(same) :]
            zero = 1e3 * EPS * size + 2 * float(np.abs(values[same] - mean).max())
            found = max(found, int((least > zero).sum()))
    return found
