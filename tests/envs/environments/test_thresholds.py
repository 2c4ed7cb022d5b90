"""Thresholds against the kept scoreboard."""

import json
from pathlib import Path

import pytest

from pliant.envs.environments.thresholds import THRESHOLDS
from pliant.envs.scenes.registry import SCENES, VARIANTS

BOARD = Path(__file__).parents[3] / "docs" / "scoreboard" / "scoreboard.json"


def test_they_are_one_percent_below_what_lqr_returns() -> None:
    rows = json.loads(BOARD.read_text(encoding="utf-8"))["rows"]
    exact = {(row["scene"], row["controller"]): row for row in rows if row["case"] == "exact"}
    for name, threshold in THRESHOLDS.items():
        law = "MPC" if name == "single-link-slew-gentle" else "LQR"
        assert threshold == pytest.approx(-1.01 * exact[name, law]["cost"], rel=2e-3), name


def test_every_scene_has_one_that_doing_nothing_does_not_reach() -> None:
    """Returns of doing nothing stand in the scenes' docstrings; the slider-crank's is within a permille of LQR's."""
    makers = {**SCENES, **VARIANTS}
    assert set(makers) - set(THRESHOLDS) == {"slider-crank-run"} and set(THRESHOLDS) <= set(makers)
    for name, threshold in THRESHOLDS.items():
        told = (makers[name].__doc__ or "").partition("| zero actions             | ")[2].split(" ")[0]
        assert float(told) < threshold, name
