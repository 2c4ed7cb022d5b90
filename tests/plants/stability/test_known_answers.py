"""A sample of tests/campaigns/verdicts.py: seeded systems with known answers; the whole is run by `make campaign`."""

import runpy
import sys

import numpy as np
import pytest
import unseen
import verdicts
from unseen_systems import long_chain, many_states

from pliant.plants.stability import assess

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


def test_none_is_misled():
    """A sample of tests/campaigns/unseen.py: two of each kind, the large ones aside."""
    rows = [unseen.run(seed) for seed in range(200, 234) if unseen.KINDS[seed % len(unseen.KINDS)] is not many_states]
    assert not [row for row in rows if row["faults"]]
    assert sum(row["verdict"] == "undecided" for row in rows) <= 0.15 * len(rows)


@pytest.mark.parametrize("seed", (1, 5, 7))
def test_a_high_power_of_time_is_no_exponential(seed):
    """Six to eight integrators in a row, in other axes than the states, grow 50,000-fold and more."""
    told = assess(long_chain(np.random.default_rng(seed)).model, periodic=False)
    assert told.verdict != "unstable" and not told.evidence["growth"].compounds
