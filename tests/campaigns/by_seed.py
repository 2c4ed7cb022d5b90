"""What campaigns by seed share: they show how far they are, are stopped at any time, and go on where they were.

python tests/campaigns/verdicts.py --count 4000 --jobs 2 --out build/verdicts.jsonl

Whoever imports this finds tests/cases too, as pytest does.
"""

import argparse
import json
import multiprocessing
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

CASES = str(Path(__file__).resolve().parents[1] / "cases")
if CASES not in sys.path:
    sys.path.append(CASES)
Row = dict[str, Any]


def main(
    about: str,
    count: int,
    run: Callable[[int], Row],
    summary: Callable[[list[Row]], str],
    faulty: Callable[[Row], bool],
) -> None:
    """Run `count` seeds, one row of JSON each in a file, print the summary, and exit with 1 where a row is faulty."""
    ask = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--count", type=int, default=count)
    ask.add_argument("--first", type=int, default=0)
    ask.add_argument("--jobs", type=int, default=1)
    ask.add_argument("--out", type=Path, default=Path("build") / f"{Path(sys.argv[0]).stem}.jsonl")
    given = ask.parse_args()
    given.out.parent.mkdir(parents=True, exist_ok=True)
    rows = [json.loads(line) for line in given.out.read_text().splitlines()] if given.out.exists() else []
    wanted = range(given.first, given.first + given.count)
    rows = [r for r in rows if r["seed"] in wanted]
    done = {r["seed"] for r in rows}
    seeds = [k for k in wanted if k not in done]
    began = told = time.perf_counter()
    with given.out.open("a") as file, multiprocessing.get_context("forkserver").Pool(given.jobs) as pool:
        for k, row in enumerate(pool.imap(run, seeds) if given.jobs > 1 else map(run, seeds), start=1):
            rows.append(row)
            file.write(json.dumps(row) + "\n")
            file.flush()
            if k % 50 == 0 or k == len(seeds) or time.perf_counter() - told > 10:
                told = time.perf_counter()
                left = (time.perf_counter() - began) / k * (len(seeds) - k)
                print(f"\r{k} of {len(seeds)}, {left:.0f} s left ", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    print(summary(rows))
    sys.exit(any(faulty(r) for r in rows))
