"""A verdict on the stability of a linear model, from every method that applies, with the reasons of those that do not.

Constant A        its eigenvalues decide
Periodic A(t)     Floquet's multipliers decide
Any other         over the time that the nominal covers, and no longer: slow variation of A (then the frozen-time roots
                  may be believed), a Lyapunov certificate, the growth of the transition matrix, in this order
Frozen-time eigenvalues alone never decide.

stable      every deviation decays; on a nominal that is not periodic: ends smaller than it began, or falls in the
            measure V of slow variation
unstable    some deviation grows; on a nominal that is not periodic: by GROWN and faster than drift does
marginal    the slowest neither decays nor grows, as far as rounding lets one tell (undamped, or free to drift)
undecided   none of these is shown
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pliant.plants.linear import modal_analysis
from pliant.plants.linear.lti import LinearModel

from .floquet import Floquet, floquet
from .frozen_time import (
    FrozenTime,
    SlowVariation,
    frozen_along,
    frozen_time,
    said_coordinates,
    slow_along,
    slow_variation,
)
from .lyapunov_certificate import Certificate, certified, lyapunov
from .periodicity import varying
from .state_matrix_path import Model, as_pieces, kept
from .transition_growth import Growth, grown, growth
from .verdict import METHODS, Verdict

GROWN = 10.0  # growth over a nominal that is not periodic from which on it counts as unstable ..
LATE = 4.0  # .. if so much of it falls into the second half: drift with time, or its square, does not pass that
POINTS, MOST_POINTS = 200, 2000  # times of a period at which growth is taken beside Floquet's answer
SOME = 64  # and times at which frozen roots are
FEW_STEPS = 256  # a certificate beside Floquet's answer is only sought with so many steps ..
OPEN_STEPS = 2048  # .. and with so many on a nominal that is not periodic


def assess(
    model: Model | LinearModel,
    *,
    period: float | None = None,
    periodic: bool | None = None,
    states: Sequence[str] | None = None,
    coordinates: str | None = None,
    window: float | None = None,
    thorough: bool = True,
) -> Verdict:
    """The verdict on a LinearModel, an LTVModel, or pieces joined by jumps.

    `period` [s] of A(t), None: found where there is one; `periodic=False`: the nominal is what it is and not repeated.
    `states` keeps only those: right where the others do not feel them. `coordinates` says in words what the states are
    measured in. `window` [s] of the growth. thorough=False stops at the method that decides.
    """
    if isinstance(model, LinearModel):
        return _constant(model, states, coordinates)
    joined = as_pieces(model)
    if len(joined.pieces) == 1 and not varying(joined.pieces[0])[0].shape[1]:
        return _constant(joined.pieces[0].at(0), states, coordinates)
    said: dict[str, str] = {"eigenvalues": "A varies"}
    evidence: dict[str, Any] = {}
    cycle = None
    if periodic is False:
        said["floquet"] = "told that the nominal is not repeated"
    elif len(joined.pieces) > 1:
        said["floquet"] = "the nominal has jumps"
    else:
        try:
            cycle = floquet(joined.pieces[0], period, states=states)
        except ValueError as refusal:
            if periodic or period is not None:
                raise
            said["floquet"] = str(refusal).removeprefix("floquet: ")
    if cycle is not None:
        evidence["floquet"] = cycle
        if thorough:
            _beside(joined, states, coordinates, window, cycle, evidence, said)
        return _periodic(cycle, evidence, said)
    evidence["slow_variation"] = slow = slow_variation(joined, states=states)
    if thorough or not slow:
        try:
            evidence["lyapunov"] = lyapunov(joined, periodic=False, states=states, most=OPEN_STEPS)
        except np.linalg.LinAlgError as failure:
            said["lyapunov"] = f"failed: {failure}"
        except ValueError as refusal:
            said["lyapunov"] = str(refusal)
        try:
            evidence["growth"] = growth(joined, window, states=states)
        except ValueError as refusal:
            if window is not None:
                raise
            said["growth"] = str(refusal).removeprefix("growth: ")
    evidence["frozen_time"] = frozen_time(
        joined, states=states, coordinates=coordinates, points=None if thorough else POINTS
    )
    return _open(evidence, said)


def _constant(model: LinearModel, states: Sequence[str] | None, coordinates: str | None) -> Verdict:
    keep = kept(model, states)
    A = model.A[np.ix_(keep, keep)]
    lam, _, _, rounding = modal_analysis.eigen(A)
    size = lam.real if model.dt is None else np.log(np.maximum(np.abs(lam), 1e-300)) / model.dt
    fuzz = rounding if model.dt is None else rounding / model.dt
    grows, stays = size > fuzz, np.abs(size) <= fuzz
    verdict = "unstable" if grows.any() else "marginal" if stays.any() else "stable"
    rate = float(size[grows].max()) if grows.any() else 0.0 if stays.any() else float(size.max(initial=-np.inf))
    words = {"unstable": f"the fastest grows at {rate:.4g} 1/s", "stable": f"the slowest decays at {-rate:.4g} 1/s"}
    count = int(stays.sum())
    words["marginal"] = f"{count} of {len(lam)} eigenvalues on the imaginary axis, the others decay"
    reasons = dict.fromkeys(METHODS[1:], "the model is constant: its eigenvalues decide")
    evidence: dict[str, Any] = {"eigenvalues": lam}
    said = coordinates or said_coordinates(model, states)
    return Verdict(verdict, "eigenvalues", -rate, (), words[verdict], reasons, evidence, said)


def _beside(
    joined: Any,
    states: Sequence[str] | None,
    coordinates: str | None,
    window: float | None,
    cycle: Floquet,
    evidence: dict[str, Any],
    said: dict[str, str],
) -> None:
    """What the other methods say of a periodic model; they do not decide."""
    path, t0 = cycle.path, cycle.path.t[0]
    few = t0 + np.linspace(0.0, cycle.period, SOME + 1)
    said_in = coordinates or said_coordinates(joined, states)
    evidence["frozen_time"] = frozen_along(path, few, said_in)
    if evidence["frozen_time"].suggests == "stable":
        evidence["slow_variation"] = slow_along(path, few)
    else:
        said["slow_variation"] = "frozen roots are not all in the left half-plane"
    steps = max(cycle.steps, POINTS)
    few = min(steps, MOST_POINTS)
    edges = t0 + np.linspace(0.0, cycle.period, few + 1)
    try:
        evidence["growth"] = grown(edges, path.between(edges, -(-steps // few)), path.scale, window)
    except ValueError as failure:
        said["growth"] = str(failure)
    if cycle.verdict != "stable":
        said["lyapunov"] = f"no certificate where Floquet says {cycle.verdict}"
        return
    found = certified(path, cycle.period, most=FEW_STEPS)
    if found:
        evidence["lyapunov"] = found
    else:
        said["lyapunov"] = f"not needed; {found.why}"


def _periodic(cycle: Floquet, evidence: dict[str, Any], said: dict[str, str]) -> Verdict:
    sizes = np.abs(cycle.multipliers)
    margin = 0.0 if cycle.verdict == "marginal" else -cycle.growth
    words = {
        "stable": f"the largest multiplier is {sizes[0]:.6g}, the slowest mode decays at {margin:.4g} 1/s",
        "unstable": f"{int(cycle.outside.sum())} multipliers outside the unit circle, the largest {sizes[0]:.6g}",
        "marginal": f"{int(cycle.on_circle.sum())} of {len(sizes)} multipliers on the unit circle, none outside",
        "undecided": f"multipliers are known to {cycle.error.max():.2g} only: more nodes in a period would help",
    }
    decided = "" if cycle.verdict == "undecided" else "floquet"
    why = f"{words[cycle.verdict]}; period {cycle.period:.6g} s ({cycle.source})"
    return _made(cycle.verdict, decided, margin, why, evidence, said)


def _open(evidence: dict[str, Any], said: dict[str, str]) -> Verdict:
    """The verdict over the span of a nominal that is not periodic."""
    slow: SlowVariation = evidence["slow_variation"]
    shown: Certificate | None = evidence.get("lyapunov")
    grown: Growth | None = evidence.get("growth")
    if slow:
        why = f"A varies slowly enough for its frozen roots to decide: {slow.why}; V proves {slow.decay:.4g} 1/s"
        return _made("stable", "slow_variation", slow.decay, why, evidence, said)
    if shown is not None and shown and shown.contraction < 1:
        duration = float(shown.t[-1] - shown.t[0])
        margin = -float(np.log(shown.contraction)) / duration
        why = f"{shown.why}; over {duration:.4g} s every deviation shrinks to {shown.contraction:.3g} of itself or less"
        return _made("stable", "lyapunov", margin, why, evidence, said)
    if grown is None:
        return _made("undecided", "", np.nan, f"no method could be used: {said['growth']}", evidence, said)
    duration = float(grown.t[-1] - grown.t[0])
    late = float(np.exp(min(grown.logs[-1] - grown.logs[grown.t <= (grown.t[0] + grown.t[-1]) / 2].max(), 700.0)))
    why = f"over {duration:.4g} s deviations change by a factor of {grown.total:.4g} at most"
    if grown.total < 1:
        return _made("stable", "growth", -grown.rate, why, evidence, said)
    if grown.total > GROWN and late > LATE:
        return _made("unstable", "growth", -grown.rate, f"{why}, of it {late:.4g} in the second half", evidence, said)
    if grown.total > GROWN:
        why += f", but only {late:.3g} in the second half, as free drift does: no exponential growth is shown"
        why += "; `states` can leave out what drifts"
    else:
        why += f": neither below 1 nor above {GROWN:g}; the nominal is too short or has no one answer"
    return _made("undecided", "", -grown.rate, why, evidence, said)


def _made(
    verdict: str, method: str, margin: float, why: str, evidence: dict[str, Any], said: dict[str, str]
) -> Verdict:
    frozen: FrozenTime | None = evidence.get("frozen_time")
    slow: SlowVariation | None = evidence.get("slow_variation")
    reasons = dict(said)
    if frozen is not None:
        allowed = "slow variation allows it" if slow else "not to be believed: slow variation does not allow it"
        rate = float(frozen.rightmost.max())
        reasons["frozen_time"] = (
            f"suggests {frozen.suggests} (rightmost {rate:.4g} 1/s, in {frozen.coordinates}); {allowed}"
        )
    for name in ("slow_variation", "lyapunov"):
        if name in evidence:
            reasons[name] = evidence[name].why
    if "growth" in evidence:
        found: Growth = evidence["growth"]
        reasons["growth"] = (
            f"deviations change by a factor of {found.total:.4g} at most, "
            f"within {found.window:.3g} s by {found.windows.max():.4g}"
        )
    for name in METHODS:
        reasons.setdefault(name, f"not needed: {method} decides" if method else "does not apply")
    reasons.pop(method, None)
    times: tuple[float, ...] = frozen.critical_times if frozen is not None else ()
    if "growth" in evidence:
        times += evidence["growth"].critical_times
    said_in = frozen.coordinates if frozen is not None else ""
    return Verdict(verdict, method, float(margin), tuple(sorted(times)), why, reasons, evidence, said_in)
