"""The cheapest law without a failure."""

import math

from pliant.studies.closed_loop.scores import Row
from pliant.studies.scoreboard.lasting import lasting, what_lasts
from pliant.studies.scoreboard.tasks import CASES


def rows_of(controller, ratios, failures=(0, 0, 0, 0, 0), scene="crane"):
    return [
        Row(scene, case, controller, 64, ratio_median=ratio, failures=failed)
        for case, ratio, failed in zip(CASES, ratios, failures, strict=True)
    ]


ROWS = [
    *rows_of("LQR", (1.0, 1.0, 1.0, 1.0, 1.0), (0, 0, 0, 0, 1)),
    *rows_of("MPC", (1.0, 1.0, 1.1, 1.2, 1.1)),
    *rows_of("NMPC", (1.0, 1.3, 1.0, 1.0, 1.0)),
    *rows_of("LQG", (1.4, 1.4, 1.4, 1.6, 1.4)),
    *rows_of("trained policy, seed 0", (1.0, 1.0, 1.0, 1.0, 1.0)),
    *rows_of("LQR", (None,) * 5, scene="orbit"),
    *[Row("orbit", case, "LQG", 0, reason="not played") for case in CASES],
]


def test_a_single_failure_in_one_column_counts_and_the_worst_column_tells_the_cost():
    assert lasting(ROWS, "crane", ["LQR", "MPC", "NMPC"]) == ("MPC", 1.2)
    assert lasting(ROWS, "crane", ["LQR"]) is None
    name, ratio = lasting(ROWS, "orbit", ["LQR"])
    assert name == "LQR" and math.isnan(ratio)
    assert lasting(ROWS, "orbit", ["LQG"]) is None
    assert lasting(ROWS[:-1], "orbit", ["LQG"]) is None  # a column is missing


def test_a_line_a_scene_without_single_seeds():
    page = "\n".join(what_lasts(ROWS))
    assert "| crane | MPC, 1.200 | LQG, 1.600 | none |" in page
    assert "| orbit | LQR, no bound known | none | none |" in page
