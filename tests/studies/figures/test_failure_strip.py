"""What the strip below a chart says."""

import pytest
from made_up_charts import UNSTABLE, made_up_chart, row

from pliant.studies.figures.failure_strip import groups, sentences, strip_height
from pliant.studies.peers.peer_rows import PeerRow


def test_failures_by_reason_the_most_frequent_first():
    found = made_up_chart()
    assert groups(found) == {"no linear model": [3], "past the stability limit": [5]}
    more = made_up_chart(rows=(*found.rows, row("rigid", "rk8", UNSTABLE, None)))
    assert next(iter(groups(more).items())) == ("past the stability limit", [5, 11])


def test_what_was_not_run_is_counted_and_other_programs_say_why():
    said = sentences(made_up_chart())
    assert said[0] == "Not run: 1 setting that cannot be on the front and 1 setting for want of time."
    assert said[1:] == ["Third: not installed: pip install third"]


def test_programs_with_one_reason_stand_together():
    peers = (PeerRow("A", "", failure="no chain"), PeerRow("B", "", failure="no chain"), PeerRow("C", "", failure="no"))
    assert sentences(made_up_chart(rows=(), peers=peers)) == ["A; B: no chain", "C: no"]


def test_no_strip_where_everything_has_a_result():
    found = made_up_chart(peers=())
    assert strip_height(found) > 0 == strip_height(made_up_chart(rows=found.measured, peers=()))


def test_a_long_reason_is_wrapped():
    said = sentences(made_up_chart(rows=(), peers=(PeerRow("P", "", failure="because " * 40),)))
    assert len(said) > 2 and max(map(len, said)) <= 118
    assert strip_height(made_up_chart(rows=(), peers=())) == pytest.approx(0.0)
