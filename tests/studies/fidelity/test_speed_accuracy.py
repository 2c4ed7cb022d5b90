"""The chart as data: fronts, what is fastest, words."""

import dataclasses
import json

import pytest
from made_up_charts import UNSTABLE, made_up_chart, row

from pliant.studies.fidelity.speed_accuracy import SPENT, Chart, pareto, with_fronts

FOUND = made_up_chart()


def test_pareto_keeps_what_nothing_beats():
    points = [(1.0, 9.0), (2.0, 5.0), (2.0, 4.0), (3.0, 4.0), (4.0, 6.0), (5.0, 1.0), (5.0, 1.0)]
    assert pareto(points) == [True, False, True, False, False, True, True]
    assert pareto([]) == []


def test_each_number_of_lanes_has_a_front_of_its_own_without_linear_models():
    told = [(r.variant, r.setting) for r in FOUND.front]
    assert told == [
        ("strain, 3", "dop853, rtol 1e-03"),
        ("strain, 3", "stepper, rk4, 2 ms, 1 lane, double"),
        ("rigid", "dop853, rtol 1e-03"),
        ("strain, 3", "stepper, rk4, 2 ms, 1,024 lanes, double"),
        ("rigid", "stepper, rk4, 20 ms, 1,024 lanes, single"),
    ]


def test_the_fastest_keeps_the_tolerance_with_what_the_reference_is_known_to():
    assert FOUND.fastest().setting == "stepper, rk4, 2 ms, 1 lane, double"
    assert FOUND.fastest(2.1e-4).method == "dop853"  # 2e-4 of the stepper and 2e-5 of the reference are more
    assert FOUND.fastest(1e-15) is None and FOUND.fastest(variant="rigid") is None
    assert FOUND.fastest(0.1, "rigid").setting == "dop853, rtol 1e-03"
    assert FOUND.fastest(lanes=1024).seconds == 1e-4
    with pytest.raises(ValueError, match=r"Chart.fastest.lanes = 7 must be one of 1, 1024"):
        FOUND.fastest(lanes=7)


def test_reasons_in_a_few_words():
    reasons = {r.failure: r.reason for r in FOUND.failed}
    assert reasons[UNSTABLE] == "past the stability limit" and reasons[SPENT] == "no time left, not run"
    assert dataclasses.replace(FOUND.failed[0], failure="OddError: it is").reason == "OddError"
    assert FOUND.measured[0].reason == ""


def test_a_linear_models_setting_names_its_nodes():
    assert FOUND.measured[-1].setting == "LTV along a motion, nodes 20 ms apart"


def test_what_the_budget_bought_no_row_of():
    assert FOUND.lacking == () and FOUND.not_run == 1
    cut = made_up_chart(rows=(*FOUND.rows, row("other", "rk4", SPENT, None), row("lost", "rk4", UNSTABLE, None)))
    assert cut.lacking == ("other",)


def test_a_row_from_elsewhere_takes_its_place_where_there_are_no_numbers():
    assert FOUND.holding(None) is FOUND and FOUND.holding(FOUND.measured[0]) is FOUND
    new = row("strain, 3", "midpoint", 1e-5, 1e-6)
    held = FOUND.holding(new)
    assert len(held.rows) == len(FOUND.rows) and held.fastest().method == "midpoint"
    assert [r.pareto for r in held.measured if r.key == FOUND.measured[0].key] == [False]


def test_how_far_ahead_of_another_program_at_the_same_error():
    other, missing = FOUND.peers
    assert FOUND.ahead(other) == pytest.approx(0.05 / 1e-3)  # the stepper errs by 2e-4, the other by 5e-4
    assert FOUND.ahead(missing) is None
    assert FOUND.ahead(dataclasses.replace(other, error=1e-9)) is None


def test_json_and_back(tmp_path):
    FOUND.save(tmp_path / "chart.json")
    content = json.loads((tmp_path / "chart.json").read_text())
    assert Chart.from_json(content) == FOUND
    assert [FOUND.rows[i].error for i in content["not_told"]] == [1e-5]  # physics is known to 2e-5


def test_errors_that_are_not_told_apart_are_as_good_as_one_another_on_the_front():
    fast, slow = (dataclasses.replace(r, pareto=False) for r in (FOUND.rows[6], FOUND.rows[4]))
    slow = dataclasses.replace(slow, path="stepper")
    assert slow.error < fast.error and slow.seconds > fast.seconds
    assert [r.pareto for r in with_fronts([fast, slow])] == [True, True]
    assert [r.pareto for r in with_fronts([fast, slow], 3e-4)] == [True, False]
