"""Which law lasts on a scene: no failed run in any column, and what it costs there.

Its cost is told by the largest of its medians over the columns, over the bound; where a scene has no bound it is not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from pliant.studies.closed_loop.scores import Row

from .tasks import CASES

FROM_SENSORS = ("LQG", "robust LQG", "multi-model, sensors")  # what the plant's sensors read, with their noise
FROM_JOINTS = ("PD", "PD, shaped", "computed torque")  # joints' positions and rates; all others read states
WANTED = 1.5


def lasting(rows: Sequence[Row], scene: str, controllers: Sequence[str]) -> tuple[str, float] | None:
    """(the cheapest of the controllers that fails in no run of any column, its largest median over the bound, NaN where
    there is no bound); None where all fail somewhere, or were not played."""
    found = []
    for name in controllers:
        own = {row.case: row for row in rows if (row.scene, row.controller) == (scene, name)}
        if any(case not in own or not own[case].runs or own[case].failures for case in CASES):
            continue
        medians = [m for case in CASES if (m := own[case].ratio_median) is not None]
        found.append((name, max(medians) if len(medians) == len(CASES) else math.nan))
    return min(found, key=lambda pair: math.inf if math.isnan(pair[1]) else pair[1], default=None)


def what_lasts(rows: Sequence[Row]) -> list[str]:
    """A section of the page: a line a scene."""
    names = [law for law in dict.fromkeys(row.controller for row in rows) if ", seed " not in law]
    states = [name for name in names if name not in (*FROM_SENSORS, *FROM_JOINTS)]
    kinds = (states, [n for n in names if n in FROM_SENSORS], [n for n in names if n in FROM_JOINTS])
    text = ["| scene | from states | from sensors | from joints' positions and rates |", "|---|---|---|---|"]
    for scene in dict.fromkeys(row.scene for row in rows):
        cells = [_told(lasting(rows, scene, kind)) for kind in kinds]
        text.append(f"| {scene} | {' | '.join(cells)} |")
    about = (
        "What lasts: of the laws that fail in no run of any column the cheapest, and the largest of its medians over\n"
        f"the columns, over the bound. Wanted is {WANTED:g} or less.\n"
    )
    return [about, "\n".join(text) + "\n"]


def _told(found: tuple[str, float] | None) -> str:
    if found is None:
        return "none"
    name, ratio = found
    return f"{name}, no bound known" if math.isnan(ratio) else f"{name}, {ratio:.3f}"
