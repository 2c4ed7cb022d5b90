"""Published laws of the two carts beside Pliant's: `PYTHONPATH=benchmarks python -m cases.two_carts`.

Writes docs/scoreboard/two-carts.md, .json and .png, or into the folder named by --out.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
from pathlib import Path

from pliant.plants.files.atomic_files import write_text
from pliant.studies.common import machine
from pliant.studies.common.atomic_files import write_json
from pliant.studies.figures.style import save
from pliant.studies.two_carts import PUBLISHED
from pliant.studies.two_carts.comparison import OWN, compared, markdown, picture

COMMAND = "PYTHONPATH=benchmarks python -m cases.two_carts"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[2] / "docs" / "scoreboard")
    out = parser.parse_args().out
    rows = compared()
    write_json(
        out / "two-carts.json",
        {
            "command": COMMAND,
            "machine": machine.describe(),
            "rows": [{**dataclasses.asdict(row), "met": row.merit.meets} for row in rows],
        },
    )
    write_text(out / "two-carts.md", markdown(rows, COMMAND))
    save(picture(rows, [*(p.law for p in PUBLISHED), *(own.law for own in OWN)]), out / "two-carts.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
