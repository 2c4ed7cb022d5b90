"""What a scoreboard holds, by name."""

import pytest

from pliant.studies.closed_loop.scores import Row
from pliant.studies.scoreboard.results import Results


def test_a_row_is_found_by_its_three_names():
    rows = tuple(Row("slew", case, name, 1) for case in ("exact", "finer") for name in ("LQR", "MPC"))
    board = Results(1, 0, (), rows, {}, {})
    assert board.row("slew", "finer", "LQR") is rows[2]
    with pytest.raises(ValueError, match="no row of 'PD' on 'slew', 'exact'"):
        board.row("slew", "exact", "PD")
