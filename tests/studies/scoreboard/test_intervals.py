"""Rows and the table over scenes from raw runs that are told in closed form."""

import numpy as np
import pytest

from pliant.studies.closed_loop.scores import Score, summarise
from pliant.studies.scoreboard.intervals import overall, profiles, with_intervals
from pliant.studies.scoreboard.raw_runs import gathered

ACT = np.array([1000.0])
COSTS = {"LQR": [2.0, 2.0, 4.0, 8.0], "ours": [1.0, 1.0, 2.0, 40.0]}
BEST = (1.0, 1.0, 1.0, None)


def scores(costs):
    return [Score(c, "left" if c > 30 else "", None, None, None, at_limit=0.0, beyond=0.0, effort=0.1) for c in costs]


RAW = gathered(
    {}, {("slew", "varied", n): (scores(c), [ACT] * 4) for n, c in COSTS.items()}, {("slew", "varied"): BEST}
)


def test_a_row_gets_the_mean_of_its_middle_and_an_interval_of_each_number():
    row = with_intervals(summarise("slew", "varied", "ours", scores(COSTS["ours"]), ACT, BEST), RAW)
    assert row.ratio_iqm == pytest.approx(4 / 3)  # three runs with a bound: a quarter of them is none
    assert row.intervals["cost"][0] == 1.0 and row.intervals["cost"][1] > 20
    assert row.intervals["failures"] == pytest.approx((4 * 0.0063095, 4 * 0.8058796), rel=1e-4)  # Clopper-Pearson 1/4
    assert row.intervals["effort"] == pytest.approx((0.1, 0.1)) and "settling" not in row.intervals


def test_over_scenes_the_better_one_is_told_with_its_chance():
    lines = {line["controller"]: line for line in overall(RAW)}
    assert lines["ours"]["better"] == pytest.approx((3 + 3 + 2) / 9)  # 1/2 ties two and is above one
    assert "better" not in lines["LQR"] and lines["LQR"]["scenes"] == 1
    low, high = lines["ours"]["iqm_interval"]
    assert lines["ours"]["iqm"] == pytest.approx(2.5 / 3)
    assert low <= lines["ours"]["iqm"] <= high
    assert profiles(RAW, "varied", [0.4, 0.6])["LQR"] == pytest.approx([2 / 3, 0.0])
