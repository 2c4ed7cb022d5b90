"""Thresholds against the kept scoreboard."""

import json
from pathlib import Path

import pytest

from pliant.envs.environments.thresholds import THRESHOLDS

BOARD = Path(__file__).parents[3] / "docs" / "scoreboard" / "scoreboard.json"


def test_they_are_one_percent_below_what_lqr_returns() -> None:
    rows = json.loads(BOARD.read_text(encoding="utf-8"))["rows"]
    exact = {(row["scene"], row["controller"]): row for row in rows if row["case"] == "exact"}
    for name, threshold in THRESHOLDS.items():
        law = "MPC" if name == "single-link-slew-gentle" else "LQR"
        assert threshold == pytest.approx(-1.01 * exact[name, law]["cost"], rel=2e-3), name
