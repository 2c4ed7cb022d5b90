"""Verdicts on systems made to mislead them: a seeded campaign.

    python tests/campaigns/unseen.py

The systems are tests/cases/unseen_systems.py. Counted are verdicts against the truth, bounds that the truth exceeds,
multipliers further off than their error, and growth further off than what the data leave open.
"""

from __future__ import annotations

import time
from typing import Any

import by_seed
import numpy as np
from unseen_systems import KINDS, Unseen, unseen

from pliant.plants.rigorous.proof import GROWN
from pliant.plants.stability import Verdict, assess
from pliant.plants.transitions.state_matrix_path import as_pieces, paths_of, scaling
from pliant.plants.transitions.transition_error import transition


def faults(s: Unseen, v: Verdict) -> list[str]:
    """What is not true of the verdict."""
    found, decided, rate = [], v.verdict in ("stable", "unstable"), s.rate
    if rate is not None and decided and (v.verdict == "stable") != (rate < 0):
        found.append(f"{v.verdict} at a rate of {rate:.3g} 1/s")
    if rate is not None and v.method in ("eigenvalues", "floquet"):
        near = 1e-9 * (1 + abs(rate))
        if decided and np.isfinite(v.margin_bound) and rate > near - v.margin_bound:
            found.append(f"{rate:.6g} 1/s is faster than the bound {-v.margin_bound:.6g} 1/s")
        if decided and abs(v.margin + rate) > 1e-3 * abs(rate) + near:
            found.append(f"{-v.margin:.6g} 1/s for {rate:.6g} 1/s")
    if s.multipliers is not None and "floquet" in v.evidence:
        cycle, most = v.evidence["floquet"], max(1.0, float(np.abs(s.multipliers).max()))
        apart = np.abs(cycle.multipliers[:, None] - s.multipliers).min(axis=1)
        if (apart > cycle.error + 1e-10 * most).any():
            found.append(f"multipliers off by {apart.max():.2g}")
    if s.Phi is not None and "growth" in v.evidence:
        found += _of_record(s, v)
    return found


def _of_record(s: Unseen, v: Verdict) -> list[str]:
    """Against the transition over the record, in the coordinates of the verdict."""
    grown, found = v.evidence["growth"], []
    Phi = s.Phi * grown.scale / grown.scale[:, None]
    even, span = scaling((Phi - np.diag(np.diagonal(Phi)))[None]), grown.t[-1] - grown.t[0]
    total, least = (float(np.linalg.norm(Phi * u / u[:, None], 2)) for u in (np.ones(len(Phi)), even))
    open_ = float(np.linalg.norm(transition(*paths_of(as_pieces(s.model), None), 1e-6).D, 2))
    if abs(grown.total - total) > open_ + 1e-5 * total + 1e-12:
        found.append(f"growth {grown.total:.6g} +- {open_:.2g} for {total:.6g}")
    if v.method == "growth" and np.isfinite(v.margin_bound) and np.log(total) > 1e-8 - v.margin_bound * span:
        found.append(f"growth {total:.6g} beyond its bound")
    if v.verdict == "stable" and v.method != "slow_variation" and total >= 1:
        found.append(f"stable, and ends {total:.3g} times as large")
    if v.verdict == "bounded" and min(total, least) > GROWN * (1 + 1e-9):
        found.append(f"bounded, and ends {least:.3g} times as large")
    if v.verdict == "unstable" and total < GROWN:
        found.append(f"unstable, and ends {total:.3g} times as large")
    return found


def run(seed: int) -> dict[str, Any]:
    kind, s = unseen(seed)
    began = time.process_time()
    v = assess(s.model, **s.options)
    row = {"seed": seed, "kind": kind, "verdict": v.verdict, "faults": faults(s, v)}
    return {**row, "seconds": round(time.process_time() - began, 4)}


def summary(rows: list[dict[str, Any]]) -> str:
    text = f"{len(rows)} systems: {sum(bool(r['faults']) for r in rows)} with faults"
    for kind in (make.__name__ for make in KINDS):
        own = [r["verdict"] for r in rows if r["kind"] == kind]
        text += f"\n  {kind}: " + ", ".join(f"{own.count(v)} {v}" for v in sorted(set(own)))
    return text


if __name__ == "__main__":
    by_seed.main(__doc__, 510, run, summary, lambda row: bool(row["faults"]))
