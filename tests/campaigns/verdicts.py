"""Verdicts on systems whose answer is known: a seeded campaign.

    python tests/campaigns/verdicts.py

The systems and what is true of them are tests/cases/known_systems.py. Counted are wrong verdicts, errors that are
reported too small, and the share that stays undecided of the systems that stand off their boundary by more than three
times the true error of the data.
"""

from __future__ import annotations

import time
from typing import Any

import by_seed
import numpy as np
from known_systems import FAMILIES, System, system
from scipy.optimize import linear_sum_assignment

from pliant.plants.stability import Verdict, assess

EXACT = 1e-9  # of the truth


def judged(s: System, v: Verdict) -> dict[str, Any]:
    """wrong: the verdict; short: how far the reported errors fall short; stands: off its boundary."""
    size = s.truth.real if s.line else np.abs(s.truth)
    edge = 0.0 if s.line else 1.0
    rim = float(size.max()) - edge
    slack = EXACT * (s.size if s.line else max(1.0, float(np.abs(s.truth).max())))
    on = s.exact or abs(rim) < slack
    wrong = (v.verdict == "stable" and (on or rim > 0)) or (v.verdict == "unstable" and (on or rim < 0))
    if "floquet" in v.evidence:
        cycle = v.evidence["floquet"]
        lam, error = cycle.multipliers, cycle.error
        cost = np.maximum(np.abs(lam[:, None] - s.truth[None, :]) - error[:, None] - slack, 0.0)
        rows, columns = linear_sum_assignment(np.where(np.isfinite(cost), cost, 0.0))
        short = float(cost[rows, columns].max())
        true = float(np.abs(lam[np.abs(lam).argmax()] - s.truth).min())
        told = float(error[np.abs(lam).argmax()])
        if v.verdict == "marginal":
            near = cycle.on_circle
            wrong |= not near.any() or rim > float(error[near].max()) + slack
    else:
        lam = v.evidence["eigenvalues"]
        found = lam.real if s.line else np.abs(lam)
        short, true, told = 0.0, abs(float(found.max()) - float(size.max())), np.nan
        if v.verdict == "marginal":
            wrong |= not on and abs(rim) > 1e-4 * s.size
    stands = not on and abs(rim) > 3 * true
    bound = v.margin_bound
    if np.isfinite(bound) and "growth" not in v.method:
        rate = rim if s.line else np.log(max(float(size.max()), 1e-300))
        if not s.line:
            rate /= s.options["period"] if s.options else s.model.dt
        short = max(short, 0.0 if rate <= -bound + 1e-8 * (abs(rate) + abs(bound)) + slack * 10 * abs(bound) else 1.0)
    return {
        "verdict": v.verdict,
        "wrong": bool(wrong),
        "short": float(short),
        "stands": bool(stands),
        "open": v.verdict in ("undecided", "marginal", "drift", "bounded"),
        "rim": float(rim),
        "true": float(true),
        "told": float(told),
    }


def run(seed: int) -> dict[str, Any]:
    s = system(seed)
    began = time.perf_counter()
    v = assess(s.model, thorough=False, **s.options)
    row = {"seed": seed, "family": s.family, "wave": s.wave, "nodes": s.nodes, "exact": bool(s.exact)}
    return {**row, **judged(s, v), "seconds": round(time.perf_counter() - began, 4)}


def summary(rows: list[dict[str, Any]]) -> str:
    stand = [r for r in rows if r["stands"]]
    left = [r for r in stand if r["open"]]
    short = [r for r in rows if r["short"] > 0]
    wrong = [r for r in rows if r["wrong"]]
    text = f"{len(rows)} systems: {len(wrong)} wrong verdicts, {len(short)} errors too small, undecided "
    text += f"{len(left)} of {len(stand)} that stand off ({100 * len(left) / max(len(stand), 1):.2f} %)"
    for name in FAMILIES:
        own = [r for r in stand if r["family"] == name]
        text += f"\n  {name}: {sum(r['open'] for r in own)} of {len(own)} undecided"
        text += f", {sum(r['wrong'] for r in rows if r['family'] == name)} wrong"
        text += f", {sum(r['short'] > 0 for r in rows if r['family'] == name)} short"
    return text


if __name__ == "__main__":
    by_seed.main(__doc__, 4000, run, summary, lambda row: row["wrong"] or row["short"] > 0)
