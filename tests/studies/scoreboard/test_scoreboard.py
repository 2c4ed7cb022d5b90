"""The scoreboard: repeatable whatever the number of processes, complete with reasons, never below the bound."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg as sla
from typer.testing import CliRunner

from pliant.controllers import LQR
from pliant.envs import scenes
from pliant.plants import PliantError
from pliant.studies.closed_loop.contestants import CONTESTANTS, playable
from pliant.studies.closed_loop.evaluation_scene import play
from pliant.studies.closed_loop.optimal_bound import bound
from pliant.studies.closed_loop.rollout import nominal, rollout
from pliant.studies.closed_loop.scores import BAND, score, summarise
from pliant.studies.commands.cli import app
from pliant.studies.scoreboard.scoreboard import scoreboard

ROOT = Path(__file__).parents[3]
SLEW = scenes.get("single-link-slew")
NAMES = ("LQR", "trained policy")
TIMES = ("act_median", "act_p99")


@pytest.fixture(scope="module")
def board():
    return scoreboard(["single-link-slew", "cantilever-drop"], NAMES, seeds=3, bounds=1, jobs=1)


def untimed(board):
    return [{k: v for k, v in row.to_json().items() if k not in TIMES} for row in board.rows]


def test_rows_do_not_depend_on_the_number_of_processes(board):
    other = scoreboard(["single-link-slew"], NAMES, seeds=3, bounds=1, jobs=2)
    assert untimed(other) == [row for row in untimed(board) if row["scene"] == "single-link-slew"]
    assert other.bounds == {key: costs for key, costs in board.bounds.items() if key[0] == "single-link-slew"}


def test_every_scene_case_and_controller_has_a_row(board):
    cases = ("exact", "finer", "varied", "delayed")
    wanted = {(s, c, n) for s in ("single-link-slew", "cantilever-drop") for c in cases for n in NAMES}
    assert {(r.scene, r.case, r.controller) for r in board.rows} == wanted
    for row in board.rows:
        assert row.runs in ((0,) if row.reason.startswith("ValueError") else (1,) if row.case in cases[:2] else (3,))


def test_a_controller_that_cannot_be_had_says_why(board):
    row = board.row("cantilever-drop", "exact", "trained policy")
    assert row.cost is None and row.runs == 0
    assert row.reason.startswith("ValueError: Policy.scene = 'cantilever-drop' must be one of")


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
    assert len(ratios) == 12
    assert min(min(pair) for pair in ratios) > 1 - 1e-6


def test_bound_is_what_the_runs_cost_and_lqr_reaches_it_where_all_is_linear(board):
    """LQR on the nearly linear slew without active limits is the optimum of an infinite horizon."""
    row = board.row("single-link-slew", "exact", "LQR")
    (best,) = board.bounds["single-link-slew", "exact"]
    assert row.ratio == pytest.approx(row.cost / best, rel=1e-12)
    assert 1 - 1e-6 < row.ratio < 1.001


def test_bound_of_a_linear_plant_is_the_finite_horizon_riccati_cost():
    """P_N = 0, P_k = Q dt + A'P A - A'P B (R dt + B'P B)^-1 B'P A; no limit is active from 0.1 rad."""
    plant = dataclasses.replace(SLEW.plant, kinematics="linear")
    scene = play(dataclasses.replace(SLEW, plant=plant, start=(("hub_angle", 0.9),), duration=1.0))
    model = plant.linearize(*scene.target)
    big = sla.expm(np.block([[model.A, model.B], [np.zeros((1, 7))]]) * scene.dt)
    A, B = big[:6, :6], big[:6, 6:]
    Q, R, _ = scene.quadratic()
    P = np.zeros((6, 6))
    for _ in range(scene.steps):
        P = scene.dt * Q + A.T @ P @ (A - B @ np.linalg.solve(scene.dt * R + B.T @ P @ B, B.T @ P @ A))
    off = scene.initial[0] - scene.target[0]
    cost, x, u = bound(scene, nominal(scene))
    assert np.abs(u).max() < 40 and x.shape == (51, 6)
    assert cost == pytest.approx(off @ P @ off, rel=1e-4)  # the plant still turns: cos(hub_angle) enters no cost


def test_bound_with_delay_charges_what_happens_before():
    scene = play(SLEW)
    late = dataclasses.replace(nominal(scene), delay=3)
    cost, x, u = bound(scene, late)
    assert len(x) == len(u) + 1 == SLEW.steps + 1 and (u[:3] == 0).all() and np.abs(x[3]).max() < 1e-12
    free = dataclasses.replace(scene, duration=SLEW.duration - 3 * SLEW.dt)
    assert cost == pytest.approx(3 * SLEW.dt * 10.0 + bound(free, nominal(free))[0], rel=1e-6)  # 10 (1 rad)^2 a second


def test_scores_of_a_motion_known_in_closed_form():
    scene = play(SLEW)
    run = rollout(scene, LQR.for_scene(SLEW))
    t, n = scene.times, len(scene.times)
    signals = np.zeros_like(run.signals)
    places = {name: run.names.index(name) for name in run.names}
    signals[:, places["hub_angle"]] = 1 - np.exp(-3 * t)  # within 5 % from ln(20)/3 = 0.9986 s on
    signals[:, places["tip_deflection"]] = 0.02 * np.exp(-t) * np.cos(40 * t)
    found = score(scene, dataclasses.replace(run, signals=signals, u=np.full((n - 1, 1), 20.0)))
    assert BAND == 0.05 and found.settling == pytest.approx(1.0)
    assert found.peak == pytest.approx(0.02)
    assert found.residual == pytest.approx(0.02 * np.exp(-2.75), rel=0.1)
    assert found.effort == pytest.approx(0.5) and found.at_limit == 0.0
    never = signals.copy()
    never[:, places["hub_angle"]] = 0.9
    assert score(scene, dataclasses.replace(run, signals=never)).settling == np.inf


def test_summary_counts_failures_and_keeps_their_charge():
    scene = play(SLEW)
    good = score(scene, rollout(scene, LQR.for_scene(SLEW)))
    bad = dataclasses.replace(good, cost=100.0, failure="diverged at 1 s", settling=None, peak=None, residual=None)
    row = summarise("s", "varied", "c", [good, bad, good], np.array([1000, 3000, 2000]), [2.0, 4.0])
    assert row.failures == 1 and row.reason == "diverged at 1 s"
    assert row.cost == pytest.approx((2 * good.cost + 100) / 3)
    assert row.ratio == pytest.approx((good.cost + 100) / 6)
    assert (row.ratio_low, row.ratio_high) == (pytest.approx(good.cost / 2), 25.0)
    assert row.act_median == 2.0 and row.settling == good.settling


def test_tables_and_pictures(board, tmp_path):
    files = board.save(tmp_path / "board", "pliant scoreboard ...")
    assert [f.name for f in files] == [
        *("scoreboard.json", "scoreboard.md", "single-link-slew.png", "cantilever-drop.png")
    ]
    table = json.loads(files[0].read_text())
    assert len(table["rows"]) == 16 and table["command"] == "pliant scoreboard ..."
    assert {r["scene"] for r in table["rows"]} == {s["scene"] for s in table["scenes"]}
    text = files[1].read_text()
    assert "| LQR |" in text and "trained policy: none. ValueError" in text and "](single-link-slew.png)" in text
    assert all(f.read_bytes().startswith(b"\x89PNG") for f in files[2:])


def test_command(tmp_path):
    arguments = ["scoreboard", "single-link-slew", "--controllers", "LQR", "--seeds", "2", "--bounds", "1"]
    done = CliRunner().invoke(app, [*arguments, "--jobs", "1", "--json", "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    table = json.loads(done.stdout)
    assert [r["case"] for r in table["rows"]] == ["exact", "finer", "varied", "delayed"]
    assert table["command"].startswith("pliant scoreboard single-link-slew --seeds 2 --controllers LQR --bounds 1")
    assert (tmp_path / "scoreboard.md").is_file() and "100 %" in done.stderr
    done = CliRunner().invoke(app, ["scoreboard", "nowhere"])
    assert done.exit_code == 2 and "scoreboard.scene = 'nowhere' must be one of" in done.stderr
    done = CliRunner().invoke(app, ["scoreboard", "--controllers", "magic"])
    assert done.exit_code == 2 and "scoreboard.controller = 'magic' must be one of" in done.stderr


def test_all_scenes_with_inputs_are_played():
    named = {s.name for s in playable()}
    assert set(scenes.names()) <= named
    assert {"single-link-slew-gentle", "two-link-reach-weak"} <= named
    assert len({s.name for s in playable()}) == len(playable())
    assert set(NAMES) < set(CONTESTANTS)
