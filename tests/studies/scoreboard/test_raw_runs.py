"""Every run, there and back, and the same bytes each time."""

import numpy as np
import pytest

from pliant.studies.closed_loop.scores import Score
from pliant.studies.scoreboard.raw_runs import RawRuns, gathered

GOOD = Score(2.0, "", 0.5, 0.01, None, at_limit=0.1, beyond=0.0, effort=0.3)
BAD = Score(90.0, "diverged at 1 s", None, None, None, at_limit=0.9, beyond=0.5, effort=0.8)
ACT = np.array([1000, 3000, 2000])
RAW = gathered(
    {"suite": "s", "seed": 3, "seeds": 2},
    {("slew", "varied", "LQR"): ([GOOD, BAD], [ACT, ACT[:1]]), ("slew", "exact", "MPC"): ([GOOD], [ACT])},
    {("slew", "varied"): (1.0, None), ("slew", "exact"): (1.6,)},
)


def test_columns_hold_what_the_runs_had():
    assert RAW.column("cost", "slew", "varied", "LQR").tolist() == [2.0, 90.0]
    assert [RAW.reasons[k] if k >= 0 else "" for k in RAW.column("failure", "slew", "varied", "LQR")] == [
        "",
        BAD.failure,
    ]
    assert RAW.column("act_median", "slew", "varied", "LQR").tolist() == [2.0, 1.0]
    assert RAW.scores("slew", "varied", "LQR").tolist() == [0.5]
    assert RAW.scores("slew", "exact", "MPC").tolist() == [0.8]
    assert len(RAW.rows("slew", "varied", "PD")) == 0


def test_file_holds_the_same_and_its_bytes_depend_on_nothing_else(tmp_path):
    paths = [tmp_path / name for name in ("one.npz", "two.npz")]
    for path in paths:
        RAW.save(path)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    again = RawRuns.load(paths[0])
    assert (again.scenes, again.cases, again.controllers, again.reasons) == (
        RAW.scenes,
        RAW.cases,
        RAW.controllers,
        RAW.reasons,
    )
    assert again.about["seed"] == 3
    for name, column in RAW.columns.items():
        np.testing.assert_array_equal(again.columns[name], column)
    np.savez(tmp_path / "other.npz", a=np.zeros(2))
    with pytest.raises(ValueError, match=r"other\.npz"):
        RawRuns.load(tmp_path / "other.npz")
