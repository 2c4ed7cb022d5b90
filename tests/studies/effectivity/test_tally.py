"""Rows whose verdict is known by hand."""

import math

import pytest

from pliant.studies.effectivity.tally import Tally


def row(seed=0, *, met=True, true=0.5, rungs=((2.0, 2.0), (0.5, 0.5)), **changes):
    """Tolerance 1; rungs are (predicted, true)."""
    made = {
        "seed": seed,
        "kind": "drop",
        "failure": "",
        "met": met,
        "tolerance": 1.0,
        "uncertainty": 0.01,
        "true": true,
        "bound": true,
        "rungs": [{"variant": "v", "predicted": p, "bound": p, "true": t} for p, t in rungs],
        "cpu": 6.0,
        "cpu_chosen": 2.0,
        "cpu_finest": 12.0,
        "wall": 1.0,
    }
    return made | changes


def test_a_right_study():
    tally = Tally([row(0), row(1, met=False, true=3.0, rungs=((3.0, 3.0),))])
    assert not tally.faulty
    assert tally.numbers["decided"] == 1.0 and tally.numbers["met"] == 1
    assert tally.numbers["within 0.8 to 1.25"] == 1.0
    assert tally.numbers["median cost in runs of the chosen"] == 3.0
    assert tally.numbers["share below one run of the finest"] == 1.0


@pytest.mark.parametrize("true", (1.001, None))
def test_met_above_the_tolerance_or_with_a_motion_that_fails_is_wrong(true):
    tally = Tally([row(7, true=true)])
    assert tally.numbers["wrongly met"] == [7] and tally.faulty
    assert tally.numbers["decided"] == 0.0


def test_a_crash_is_a_fault_and_no_scene_whose_truth_is_known():
    tally = Tally([{"seed": 3, "failure": "ValueError: no"}, row(4)])
    assert tally.numbers["crashed"] == [3] and tally.faulty and tally.numbers["truth known"] == 1


def test_refusals():
    """A rung at 0.4 of the tolerance: false; at 0.8: undecided; with a bound that keeps it: physics left its range."""
    false = row(1, met=False, rungs=((1.1, 0.4),))
    open_ = row(2, met=False, rungs=((1.1, 0.8),))
    outside = row(3, met=False, rungs=((0.4, 0.4),))
    tally = Tally([false, open_, outside])
    assert tally.numbers["false refusals"] == [1] and tally.numbers["undecided"] == [1, 2]
    assert tally.numbers["physics out of range"] == [3]
    assert tally.numbers["decided"] == pytest.approx(1 / 3)


def test_a_truth_that_is_not_known_is_left_out_and_told():
    tally = Tally([row(1, uncertainty=0.06), row(2, uncertainty=None), row(3)])
    assert tally.numbers["left out"] == [1, 2] and tally.numbers["truth known"] == 1


def test_ratios():
    """Below what the truth is known to there is none; where one motion alone fails it is 0 or infinite."""
    rungs = ((0.3, 0.1), (5.0, 0.009), (None, 2.0), (2.0, None), (None, None))
    tally = Tally([row(rungs=rungs)])
    assert [one for _, one in tally.ratios] == pytest.approx([3.0, math.inf, 0.0])
    assert tally.share((0.5, 4.0)) == pytest.approx(1 / 3)
    assert math.isnan(Tally([]).share((0.5, 2.0)))


def test_lines_name_the_seeds():
    lines = dict(Tally([row(7, true=2.0)]).lines())
    assert lines["wrongly met"] == "1 (7)" and lines["false refusals"] == "0"


def test_a_refusal_for_extension_is_no_false_one_where_the_truth_has_none():
    refused = {"met": False, "true": 0.2, "rungs": ((0.2, 0.2),), "bound": 1.5, "missing": ["extension", "torsion"]}
    tally = Tally([row(3, **refused, truth="strain, polynomial 6"), row(4, **refused, truth="strain, stretches 3")])
    for each in tally.rows:
        each["rungs"][0]["bound"] = 1.5
    assert tally.numbers["refused for what the truth lacks"] == [3] and tally.numbers["false refusals"] == [4]
