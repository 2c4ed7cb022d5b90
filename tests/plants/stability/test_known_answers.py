"""A sample of tests/campaigns/verdicts.py: seeded systems with known answers; the whole is run by `make campaign`."""

import importlib.util
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "campaigns" / "verdicts.py"
SEEDS = range(100_000, 100_060)


@pytest.fixture(scope="module")
def campaign():
    spec = importlib.util.spec_from_file_location("campaign_of_verdicts", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


def test_no_wrong_verdict_and_no_error_too_small(campaign):
    rows = [campaign.run(seed) for seed in SEEDS]
    assert not [row for row in rows if row["wrong"]], rows
    assert not [row for row in rows if row["short"] > 0], rows
    stand = [row for row in rows if row["stands"]]
    assert len(stand) > 30 and sum(row["open"] for row in stand) <= 0.15 * len(stand)


def test_it_goes_on_where_it_was_stopped(campaign, tmp_path, monkeypatch, capsys):
    out = tmp_path / "rows.jsonl"
    for count in (2, 4):
        monkeypatch.setattr(sys, "argv", ["verdicts.py", "--count", str(count), "--first", "100000", "--out", str(out)])
        with pytest.raises(SystemExit) as done:
            campaign.main()
        assert done.value.code in (0, False)
    assert [line.split(",")[0] for line in out.read_text().splitlines()] == [
        f'{{"seed": {100_000 + k}' for k in range(4)
    ]
    assert "4 systems: 0 wrong verdicts, 0 errors too small" in capsys.readouterr().out
