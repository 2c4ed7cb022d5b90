"""What `choose` claims, on 120 random scenes, against models that are on no ladder.

    python tests/campaigns/effectivity.py --seeds 0:120 --jobs 2

It is `pliant study effectivity`, whose rows it keeps in build/effectivity.jsonl: stopped, it goes on. Exit status 1
where "met" was wrong or `choose` crashed, or where a claimed share is missed.
"""

import argparse
import sys
from pathlib import Path

from pliant.studies.effectivity import effectivity

LEAST = {"within 0.5 to 2": 0.95, "within 0.8 to 1.25": 0.75, "decided": 0.95}


def faults(numbers):
    """What of the claims does not hold, in words."""
    found = [f"{name}: {numbers[name]}" for name in ("wrongly met", "crashed", "false refusals") if numbers[name]]
    return found + [f"{n}: {numbers[n]}, least {v}" for n, v in LEAST.items() if not (numbers[n] or 0.0) >= v]


if __name__ == "__main__":
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--seeds", default="0:120")
    ask.add_argument("--jobs", type=int, default=1)
    ask.add_argument("--out", type=Path, default=Path("build") / "effectivity.jsonl")
    given = ask.parse_args()
    first, end = (int(part) for part in given.seeds.split(":"))
    given.out.parent.mkdir(parents=True, exist_ok=True)
    tell = lambda share, doing: print(f"\r{100 * share:3.0f} %, {doing} ", end="", file=sys.stderr, flush=True)  # noqa: E731
    tally = effectivity(range(first, end), jobs=given.jobs, kept=given.out, progress=tell).tally
    print(file=sys.stderr)
    for name, value in tally.lines():
        print(f"{name}: {value}")
    missed = faults(tally.numbers)
    for fault in missed:
        print(f"FAULT {fault}")
    sys.exit(bool(missed))
