"""The verdict of `stability.assess` on all times, where it is told what lies beyond the record.

constant, tends    intervals of rates about the eigenvalues of the limit: bounds, if the limit is what was said
persists           slow variation first, which proves a rate on the record; else averages of the triangular model over
                   windows of the record. Their interval is an estimate and no bound: it decides only where it is
                   further from zero than it is wide, twice as far where running averages do not come to rest; or
                   where smooth averages of one deviation's growth are twice as far above zero as they lie apart, and
                   it grows by half at least. Of short records of coupled oscillations that too is wrong at times
periodic           Floquet's multipliers, in `assess` itself

A deviation that grows in the record and decays later decays, and the other way round: what was found over the record
stands beside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_choice, require_number
from pliant.plants.linear.lti import LinearModel
from pliant.plants.stability.verdict import Verdict
from pliant.plants.transitions.state_matrix_path import Model

from .long_run import Spectrum
from .slow_dichotomy import SlowDichotomy, slow_dichotomy
from .spectrum import BEYOND, spectrum
from .triangular_flow import triangular_flow

APART, UNRESTED = 1.0, 2.0  # widths of an estimated interval from zero, from which on it decides
SMOOTH = 2 / 3  # of the record: windows of smooth averages
TURNED = 0.4  # ln of the growth over a record, that a deviation of several states shows by turning alone
AVERAGES = "averages of that deviation's growth go on to lie where those of the record do"
SLOWLY = "A goes on to vary as slowly beside the gaps between its roots as in the record"


def repeated(owner: str, model: Any, beyond: str, periodic: bool | None, limit: Any, within: float) -> bool | None:
    """Whether the nominal counts as a period, of what lies beyond it. ValueError for what does not go together."""
    require_choice(owner, "beyond", beyond, BEYOND)
    within = require_number(f"{owner}.within", within, least=0.0, unit="1/s")
    if isinstance(model, LinearModel):
        raise ValueError(f"{owner}.beyond = {beyond!r} of a LinearModel, must be None: it has no record that ends")
    if (limit is not None or within) and beyond != "tends":
        raise ValueError(f"{owner}.limit, within belong to beyond = 'tends', must be None and 0")
    if periodic is not None and periodic != (beyond == "periodic"):
        raise ValueError(f"{owner}.periodic = {periodic!r} does not go with beyond = {beyond!r}, must be None")
    return True if beyond == "periodic" else None if beyond == "persists" else False


def in_the_long_run(
    found: Verdict, model: Model, beyond: str, states: Sequence[str] | None, limit: Any = None, within: float = 0.0
) -> Verdict:
    """The same evidence, with the answer about all times: what was found over the record alone is among the reasons."""
    over = f"over the record alone: {found.verdict}" + (f" by {found.method}" if found.method else "")
    if beyond == "persists":
        slow = slow_dichotomy(model, states=states)
        if slow.verdict in ("stable", "unstable"):
            return _decided(found, slow.verdict, -slow.rate, np.nan, slow.why, SLOWLY, over, slow)
    try:
        rates = spectrum(model, beyond=beyond, states=states, limit=limit, within=within)
    except ValueError as refusal:
        why = f"the long run is not known: {refusal}"
        return _decided(found, "undecided", np.nan, np.nan, why, "", over, None)
    low, high = (float(v) for v in rates.intervals[0]) if len(rates.intervals) else (-np.inf, -np.inf)
    bound, verdict = -high if np.isfinite(high) else np.nan, rates.verdict
    if verdict == "drift":
        verdict = "undecided"
    why = rates.why
    if beyond == "persists":
        bound, why = np.nan, f"estimated from averages over the record: {rates.why}"
        apart = (low if verdict == "unstable" else -high) / max(high - low, 1e-300)
        if verdict != "undecided" and apart <= (APART if rates.regular else UNRESTED):
            verdict, why = "undecided", f"the estimate is too near to zero beside what is open in it: {rates.why}"
        if verdict == "undecided" and (grows := _grows(model, states)) is not None:
            least, most = grows
            why = "estimated from one deviation's growth: its smooth averages over two thirds of the record lie "
            why += f"between {least:.4g} and {most:.4g} 1/s; {rates.why}"
            return _decided(found, "unstable", -(least + most) / 2, np.nan, why, AVERAGES, over, rates)
    rate = float(rates.exponents[0]) if len(rates.exponents) else -np.inf
    return _decided(found, verdict, -rate, bound, why, rates.assumption, over, rates)


def _grows(model: Model, states: Sequence[str] | None) -> tuple[float, float] | None:
    """Between which rates [1/s] the deviation that the triangular model leads with grows, by smooth averages; None if
    they are not UNRESTED times as far above zero as they lie apart.

    It is a deviation of the model itself, so that no other needs to stand apart from it. Where the mean is zero,
    averages over windows at different times lie on both sides of it. Of more states than one, turning from one
    direction to another grows as well, once: less than TURNED, or than the deviation wanders about its mean, is none.
    """
    flow = triangular_flow(model, states)
    rates = flow.smooth(SMOOTH * float(flow.t[-1] - flow.t[0]))[:, :1]
    least, most = float(rates.min(initial=np.inf)), float(rates.max(initial=-np.inf))
    if flow.logs.shape[1] > 1:
        mean = (least + most) / 2 * (flow.t - flow.t[0])
        if mean[-1] < max(TURNED, float(np.ptp(flow.logs[:, 0] - mean))):
            return None
    return (least, most) if least > UNRESTED * (most - least) else None


def _decided(
    found: Verdict,
    verdict: str,
    margin: float,
    bound: float,
    why: str,
    provided: str,
    over: str,
    evidence: Spectrum | SlowDichotomy | None,
) -> Verdict:
    reasons = {**found.reasons, **({found.method: found.why} if found.method else {})}
    if verdict == "undecided":
        reasons["exponents"] = why
    else:
        reasons.pop("exponents", None)
    kind = {"stable": "decays", "unstable": "exponential"}.get(verdict, "unknown")
    method = "" if verdict == "undecided" else "exponents"
    return replace(
        found,
        verdict=verdict,
        method=method,
        margin=margin,
        margin_bound=bound,
        why=f"{why}; {over}",
        reasons=reasons,
        evidence={**found.evidence, **({} if evidence is None else {"exponents": evidence})},
        growth=kind,
        drifting=(),
        provided=provided if method else "",
    )
