"""A sample of tests/campaigns/verdicts.py: seeded systems with known answers; the whole is run by `make campaign`."""

import runpy
import sys

import pytest
import verdicts

SEEDS = range(100_000, 100_060)


def test_no_wrong_verdict_and_no_error_too_small():
    rows = [verdicts.run(seed) for seed in SEEDS]
    assert not [row for row in rows if row["wrong"]], rows
    assert not [row for row in rows if row["short"] > 0], rows
    stand = [row for row in rows if row["stands"]]
    assert len(stand) > 30 and sum(row["open"] for row in stand) <= 0.15 * len(stand)


def test_it_goes_on_where_it_was_stopped(tmp_path, monkeypatch, capsys):
    out = tmp_path / "rows.jsonl"
    for count in (2, 4):
        monkeypatch.setattr(sys, "argv", ["verdicts.py", "--count", str(count), "--first", "100000", "--out", str(out)])
        with pytest.raises(SystemExit) as done:
            runpy.run_path(verdicts.__file__, run_name="__main__")
        assert done.value.code in (0, False)
    assert [line.split(",")[0] for line in out.read_text().splitlines()] == [
        f'{{"seed": {100_000 + k}' for k in range(4)
    ]
    assert "4 systems: 0 wrong verdicts, 0 errors too small" in capsys.readouterr().out
