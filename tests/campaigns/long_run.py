"""The long run of systems whose rate for ever is known: a seeded campaign.

    python tests/campaigns/long_run.py

The systems are tests/cases/long_run_systems.py: of the kinds that a record alone leaves undecided. Counted are wrong
answers (of `assess` told what lies beyond the record, of intervals or of slow variation decided against the truth) and
the share of each kind that `assess` decides.
"""

from __future__ import annotations

import time
from typing import Any

import by_seed
from long_run_systems import FAMILIES, long_run

from pliant.plants.exponents import slow_dichotomy, spectrum
from pliant.plants.stability import assess

EXACT = 1e-7  # [1/s]


def run(seed: int) -> dict[str, Any]:
    s = long_run(seed)
    began = time.perf_counter()
    found, slow = spectrum(s.model, **s.options), slow_dichotomy(s.model) if not s.options else None
    seconds = time.perf_counter() - began
    judged = assess(s.model, thorough=False, **{"beyond": "persists", **s.options})
    tried = (judged.verdict, slow.verdict if slow else "undecided", found.verdict)
    said = [v for v in tried if v in ("stable", "unstable")]
    true = "drift" if s.truth == 0 else "unstable" if s.truth > 0 else "stable"
    low, high = found.intervals[0]
    outside = not low - EXACT <= s.truth <= high + EXACT
    return {
        "seed": seed,
        "family": s.family,
        "truth": s.truth,
        "low": float(low),
        "high": float(high),
        "verdict": found.verdict,
        "slow": slow.verdict if slow else "",
        "wrong": any(v != true for v in said),
        "outside": bool(outside),
        "decided": judged.verdict in ("stable", "unstable"),
        "seconds": round(seconds, 4),
    }


def summary(rows: list[dict[str, Any]]) -> str:
    text = f"{len(rows)} systems: {sum(r['wrong'] for r in rows)} wrong"
    for name in FAMILIES:
        own = [r for r in rows if r["family"] == name]
        share = 100 * sum(r["decided"] for r in own) / max(len(own), 1)
        text += f"\n  {name}: {share:.1f} % of {len(own)} decided, {sum(r['wrong'] for r in own)} wrong, "
        text += f"{sum(r['slow'] not in ('', 'undecided') for r in own)} by slow variation, "
        text += f"{sum(r['outside'] for r in own)} with the truth outside the interval of the fastest"
    return text


if __name__ == "__main__":
    by_seed.main(__doc__, 1000, run, summary, lambda row: row["wrong"])
