"""The scoreboard: repeatable whatever the number of processes, complete with reasons, never below the bound."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from pliant.controllers import LQR
from pliant.envs import scenes
from pliant.plants import PliantError
from pliant.studies.closed_loop.contestants import CONTESTANTS, designed
from pliant.studies.closed_loop.rollout import rollout
from pliant.studies.common.reference_motions import Motions
from pliant.studies.scoreboard import tasks
from pliant.studies.scoreboard.scoreboard import scoreboard

ROOT = Path(__file__).parents[3]
SLEW = scenes.get("single-link-slew")
NAMES = ("LQR", "trained policy")
SHORT = scenes.get("spin-up", duration=0.5)
TIMES = ("act_median", "act_p99")


@pytest.fixture(scope="module")
def board():
    return scoreboard([SLEW, SHORT], NAMES, seeds=2, bounds=1, jobs=1)


def untimed(board):
    rows = [{k: v for k, v in row.to_json().items() if k not in TIMES} for row in board.rows]
    return [row | {"intervals": {k: v for k, v in row["intervals"].items() if k not in TIMES}} for row in rows]


@pytest.mark.campaign
def test_rows_do_not_depend_on_the_number_of_processes(board):
    other = scoreboard(["single-link-slew"], NAMES[:1], seeds=2, bounds=1, jobs=2)  # two runs and bounds a process
    mine = [row for row in untimed(board) if row["scene"] == "single-link-slew" and row["controller"] == NAMES[0]]
    assert untimed(other) == mine
    assert other.bounds == {key: costs for key, costs in board.bounds.items() if key[0] == "single-link-slew"}


def test_every_scene_case_and_controller_has_a_row(board):
    cases = ("exact", "finer", "varied", "delayed", "all at once")
    wanted = {(s, c, n) for s in ("single-link-slew", "spin-up") for c in cases for n in NAMES}
    assert {(r.scene, r.case, r.controller) for r in board.rows} == wanted
    for row in board.rows:
        assert row.runs in ((0,) if row.reason.startswith("ValueError") else (1,) if row.case in cases[:2] else (2,))


def test_a_controller_that_cannot_be_had_says_why(board):
    row = board.row("spin-up", "exact", "trained policy")
    assert row.cost is None and row.runs == 0
    assert row.reason.startswith("ValueError: Policy.for_scene.name = 'spin-up' must be one of")


def refuses(scene):
    raise PliantError("no law for this\nsecond line")


def gives_up(scene):
    return GivesUp()


class GivesUp:
    dt, reads = None, ("hub_angle",)

    def reset(self):
        pass

    def act(self, t, y):
        raise PliantError("not today")


def reads_what_is_not_there(scene):
    return dataclasses.replace(LQR.for_scene(scene), reads=("eta7",))


def test_failures_are_told_not_swallowed():
    makers = {"refuses": refuses, "gives up": gives_up, "wrong names": reads_what_is_not_there}
    found = scoreboard(["single-link-slew"], makers, seeds=2, bounds=0, jobs=1)
    assert found.row("single-link-slew", "finer", "refuses").reason == "PliantError: no law for this"
    row = found.row("single-link-slew", "varied", "gives up")
    assert row.failures == row.runs == 2 and row.reason == "PliantError at 0 s: not today"
    assert row.cost == pytest.approx(SLEW.duration * SLEW.early_end_rate)
    row = found.row("single-link-slew", "finer", "wrong names")
    assert row.runs == 0 and "reads eta7, which stiffened, payload 3 does not have" in row.reason


def test_no_ratio_is_below_one(board):
    ratios = [(r.ratio, r.ratio_low) for r in board.rows if r.ratio is not None]
    assert len(ratios) == 15
    assert min(min(pair) for pair in ratios) > 1 - 1e-6


def test_bound_is_what_the_runs_cost_and_lqr_reaches_it_where_all_is_linear(board):
    """LQR on the nearly linear slew without active limits is the optimum of an infinite horizon."""
    row = board.row("single-link-slew", "exact", "LQR")
    (best,) = board.bounds["single-link-slew", "exact"]
    assert row.ratio == pytest.approx(row.cost / best, rel=1e-12)
    assert 1 - 1e-6 < row.ratio < 1.001


def test_the_plant_that_is_played_is_judged_by_physics_on_what_the_lqr_plays(board):
    """Exact rotations with shear, simulated under the same inputs: as far from the plant as told, to what is known."""
    entry = next(e for e in board.entries if e.scene == "single-link-slew")
    played = tasks.played_scene(SLEW, "finer")[0]
    u = rollout(played, designed(SLEW, CONTESTANTS["LQR"])).u
    motions = Motions(played, np.vstack([u, u[-1:]]))
    true = np.abs(motions.outputs(played.plant, 1e-9) - motions.outputs(played.plant.physics(2), 1e-9)).max()
    assert entry.plant == played.plant.label and entry.model_remark == "on what the LQR plays"
    assert entry.model_error == pytest.approx(true, abs=2 * entry.model_known, rel=0.05)
    assert 0 < entry.model_known < 0.05 * SLEW.tolerance


def test_tables_and_pictures(board, tmp_path):
    files = board.save(tmp_path / "board", "pliant scoreboard ...")
    names = ("scoreboard.json", "scoreboard.md", "single-link-slew.png", "spin-up.png", "runs.npz", "profiles.png")
    assert [f.name for f in files] == [*names]
    table = json.loads(files[0].read_text())
    assert len(table["rows"]) == 20 and table["suite"] == "pliant-scoreboard-2"
    assert table["command"] == "pliant scoreboard ..."
    assert {r["scene"] for r in table["rows"]} == {s["scene"] for s in table["scenes"]}
    text = files[1].read_text()
    assert "from physics on what the LQR plays, to " in text
    assert "| LQR |" in text and "trained policy: none. ValueError" in text and "](single-link-slew.png)" in text
    assert all(f.read_bytes().startswith(b"\x89PNG") for f in files if f.suffix == ".png")
