"""The verdict on a model's stability: the answer, and what each method said of it; that on a constant model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from pliant.plants.core.signals import OwnsArrays
from pliant.plants.files.html_tables import VerdictTable
from pliant.plants.finite_horizon.asked import Asked, listed
from pliant.plants.finite_horizon.horizon import FiniteHorizon, numbers
from pliant.plants.linear.lti import LinearModel
from pliant.plants.rigorous.proof import Proof
from pliant.plants.transitions.eigenvalue_bounds import EPS, bounds
from pliant.plants.transitions.matrix_rounding import cancelled, rounding
from pliant.plants.transitions.state_matrix_path import CLEAR, kept, scaling, unfelt

from .floquet import Floquet
from .frozen_time import said_coordinates

METHODS = ("eigenvalues", "floquet", "slow_variation", "lyapunov", "growth", "frozen_time", "exponents")
ROUNDED = 1e-9  # of |A|, of a multiplier: an error so small is told as what it is
GROWTH = ("decays", "bounded", "polynomial", "exponential", "unknown")


@dataclass(frozen=True, eq=False)
class Verdict(OwnsArrays, VerdictTable):
    """The answer, the method that gave it, what every other method said or why it was not used, and numbers beside."""

    verdict: str  # stable | unstable | marginal | drift | bounded | undecided
    method: str  # the deciding method, "" where undecided
    margin: float  # decay rate [1/s] of the slowest deviation; below zero: growth. An estimate
    critical_times: tuple[float, ...]  # [s] where frozen roots cross the axis, or windows begin or cease to grow
    why: str
    reasons: Mapping[str, str]  # of every method but the deciding one
    evidence: Mapping[str, Any] = field(repr=False)  # the results by method
    coordinates: str = ""  # in which the frozen-time roots were taken
    margin_bound: float = np.nan  # [1/s] guaranteed: whatever the data allow, none decays slower; NaN: none
    growth: str = "unknown"  # of GROWTH: how the deviation that lasts longest behaves
    drifting: tuple[str, ...] = ()  # states that drift: none feels them, and the rest does not make them run away
    provided: str = ""  # what is taken for granted beyond the record, where the answer is about all times
    asked: Asked | None = field(default=None, repr=False)  # of which `horizon` tells; None: constant, or with jumps
    proof: Proof | None = field(default=None, repr=False)  # where `rigorous` was asked for

    @property
    def stable(self) -> bool:
        return self.verdict == "stable"

    @cached_property
    def horizon(self) -> FiniteHorizon | None:
        """Numbers of the motion before it ends, found when first asked for; None where there are none: `no_horizon`."""
        try:
            return None if self.asked is None else numbers(self.asked)
        except ValueError:
            return None

    @property
    def no_horizon(self) -> str:
        """Why there are no numbers of a motion that ends; "" where there are."""
        if self.horizon is not None:
            return ""
        if self.asked is None:
            return "no single nominal motion, or nothing that pushes or is pushed"
        try:
            numbers(self.asked)
        except ValueError as refusal:
            return str(refusal).removeprefix("finite_horizon: ")
        return ""

    @cached_property
    def sentence(self) -> str:
        """What an engineer would write into a report, in one sentence, with what it rests on."""
        return self._as_computed if self.proof is None else f"{self._as_computed[:-1]}; {self.proof.said}."

    @property
    def _as_computed(self) -> str:
        if self.horizon is None:
            known = self._in_words
            return f"{known[0].upper()}{known[1:]}: of the linear model."
        return f"{self.horizon.words}; {self._in_words}: of the linear model along the nominal, to first order."

    @property
    def _in_words(self) -> str:
        """The verdict and its rate in words; they say no more than was shown."""
        decay, bound = self.margin, self.margin_bound
        known = f", at least {bound:.3g} 1/s" if bound > 0 and decay - bound > 5e-3 * decay else ""
        if self.verdict in ("stable", "unstable"):
            at = "at an estimated" if self.provided and not np.isfinite(bound) else "at"
            what = "die out" if self.verdict == "stable" else "grow"
            later = f" in the long run, provided that {self.provided}" if self.provided else ""
            return f"deviations {what} {at} {abs(decay):.3g} 1/s{known}{later}{self._first}"
        drift = f"drift of {listed(self.drifting)}, which nothing else feels" if self.drifting else ""
        if self.verdict == "marginal":
            if self.growth == "polynomial":
                return f"{drift or 'drift'}, like a power of time, and no exponential growth"
            return "deviations neither die out nor grow"
        if self.verdict in ("drift", "bounded"):
            return f"{drift}; {self.why.split('; ')[-1]}" if self.verdict == "drift" else self.why
        return f"whether deviations die out is not shown: {self.why.split(', ')[0]}"

    @property
    def _first(self) -> str:
        """What goes before a decay that slow variation shows, whose measure is not the size of a deviation."""
        grown: Any = self.evidence.get("growth")
        if self.method != "slow_variation" or grown is None or not grown.total > 1.0:
            return ""
        return f" in the measure of slow variation, though some end {grown.total:.3g} times as large as they began"

    def rows(self) -> list[tuple[str, str, str]]:
        """Method, role ("decides", "beside", "not used") and words: the verdict's table."""
        found = []
        for name in METHODS:
            role = "decides" if name == self.method else "beside" if name in self.evidence else "not used"
            found.append((name, role, self.why if name == self.method else self.reasons.get(name, "")))
        return found

    def __str__(self) -> str:
        head = f"{self.verdict} by {self.method}" if self.method else self.verdict
        lines = [] if self.asked is None else [self.sentence]
        lines += [f"{head}: {self.why}", *(f"  {name}, {role}: {text}" for name, role, text in self.rows())]
        if self.proof is not None:
            lines.append(f"  {self.proof.said}")
        if self.critical_times:
            lines.append("  critical times [s]: " + ", ".join(f"{t:.4g}" for t in self.critical_times[:12]))
        return "\n".join(lines)

    def to_json(self) -> dict[str, Any]:
        return {
            "verdict": self.verdict,
            "sentence": self.sentence,
            "method": self.method,
            "margin": self.margin if np.isfinite(self.margin) else None,
            "margin_bound": self.margin_bound if np.isfinite(self.margin_bound) else None,
            "growth": self.growth,
            "provided": self.provided or None,
            "drifting": list(self.drifting),
            "horizon": None if self.horizon is None else self.horizon.to_json(),
            "critical_times": list(self.critical_times),
            "why": self.why,
            "reasons": dict(self.reasons),
            "coordinates": self.coordinates,
            "proof": None if self.proof is None else self.proof.to_json(),
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
        words = f"{int(near.sum())} of {len(sizes)} eigenvalues {where}, the others decay; not to be told from it "
        words += f"to within {error:.2g}{' 1/s' if line else ''}" if error > ROUNDED * unit else "but by rounding"
        if power:
            words += f"; they share directions: deviations may grow like t^{power}, a power of time and no exponential"
        found = found if verdict == "undecided" else 0.0
    reasons = dict.fromkeys(METHODS[1:], "the model is constant: its eigenvalues decide")
    evidence: dict[str, Any] = {"eigenvalues": b.values}
    said, decided = coordinates or said_coordinates(model, states), "" if verdict == "undecided" else "eigenvalues"
    if not decided:
        reasons["eigenvalues"] = words
    drifting = unfelt(model, states) if kind == "polynomial" else ()
    return Verdict(verdict, decided, 0.0 - found, (), words, reasons, evidence, said, -rate(b.most), kind, drifting)


def of_periodic(
    cycle_of: Any, states: Sequence[str] | None, cycle: Floquet, evidence: dict[str, Any], said: dict[str, str]
) -> Verdict:
    """The verdict of Floquet's multipliers."""
    sizes, verdict = np.abs(cycle.multipliers), cycle.verdict
    margin = 0.0 if verdict == "marginal" else -cycle.growth
    near = cycle.on_circle
    error = float(cycle.error[near].max(initial=0.0))
    power = degree(cycle.monodromy, cycle.multipliers, cycle.error, near) if verdict == "marginal" else 0
    words = {
        "stable": f"the largest multiplier is {sizes.max(initial=0.0):.6g}, at most {cycle.most:.6g}; the slowest mode "
        f"decays at {margin:.4g} 1/s",
        "unstable": f"{int(cycle.outside.sum())} multipliers outside the unit circle, the largest "
        f"{sizes.max(initial=0.0):.6g}, at least {cycle.least:.6g}",
        "marginal": f"{int(near.sum())} of {len(sizes)} multipliers on the unit circle, none outside; not to be told "
        f"from it {f'to within {error:.2g}' if error > ROUNDED else 'but by rounding'}",
        "undecided": f"the largest multiplier, {sizes.max(initial=0.0):.6g}, is known to "
        f"{cycle.error[sizes.argmax()]:.2g} only: more nodes in a period would help",
    }
    if power:
        words["marginal"] += f"; they share directions: deviations may grow like t^{power}, no exponential is shown"
    kinds = {"stable": "decays", "unstable": "exponential", "marginal": "polynomial" if power else "bounded"}
    decided = "" if verdict == "undecided" else "floquet"
    why = f"{words[verdict]}; period {cycle.period:.6g} s ({cycle.source})"
    bound = -cycle.growth_bound
    kind = kinds.get(verdict, "unknown")
    drifting = unfelt(cycle_of, states) if kind == "polynomial" else ()
    return made(verdict, decided, margin, why, evidence, said, bound, kind, drifting)


def made(
    verdict: str,
    method: str,
    margin: float,
    why: str,
    evidence: dict[str, Any],
    said: dict[str, str],
    bound: float = np.nan,
    kind: str = "unknown",
    drifting: tuple[str, ...] = (),
) -> Verdict:
    """The verdict on a model that varies, with what every method said."""
    frozen: Any = evidence.get("frozen_time")
    slow: Any = evidence.get("slow_variation")
    reasons = dict(said)
    if frozen is not None:
        allowed = "slow variation allows it" if slow else "not to be believed: slow variation does not allow it"
        rate = float(frozen.rightmost.max())
        where = "0 but for rounding" if abs(rate) <= frozen.threshold else f"{rate:.4g} 1/s"
        if frozen.threshold < abs(rate) <= frozen.least:
            where += f", by which deviations change by {abs(np.expm1(rate * frozen.span)):.2g} of themselves meanwhile"
        reasons["frozen_time"] = f"suggests {frozen.suggests} (rightmost {where}, in {frozen.coordinates}); {allowed}"
    for name in ("slow_variation", "lyapunov"):
        if name in evidence:
            reasons[name] = evidence[name].why
    if "growth" in evidence:
        found: Any = evidence["growth"]
        reasons["growth"] = (
            f"deviations change by a factor of up to {found.total:.4g}, "
            f"within {found.window:.3g} s of up to {found.windows.max():.4g}, as computed"
        )
    reasons.setdefault("exponents", "what lies beyond the record is not given")
    for name in METHODS:
        reasons.setdefault(name, f"not needed: {method} decides" if method else "does not apply")
    reasons.pop(method, None)
    times: tuple[float, ...] = frozen.critical_times if frozen is not None else ()
    if "growth" in evidence:
        times += evidence["growth"].critical_times
    return Verdict(
        verdict,
        method,
        float(margin),
        tuple(sorted(times)),
        why,
        reasons,
        evidence,
        frozen.coordinates if frozen is not None else "",
        float(bound),
        kind,
        drifting,
    )


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
