"""A board that is killed again and again, and one that was left alone: the same runs to the last digit."""

import signal
import subprocess
import sys

import numpy as np
import pytest

from pliant.controllers import LQR
from pliant.envs import scenes
from pliant.studies.scoreboard import kept_tasks
from pliant.studies.scoreboard.raw_runs import MEASURED, PLACES, RawRuns
from pliant.studies.scoreboard.scoreboard import scoreboard

SCENES = [scenes.get("single-link-slew", duration=0.2)]
OPTIONS = {"seeds": 20, "bounds": 0, "jobs": 1, "backend": "sequential"}
COLUMNS = (*PLACES, *MEASURED, "bound")
CHILD = """
import os, signal, sys
from pliant.envs import scenes
from pliant.studies.scoreboard import kept_tasks
from pliant.studies.scoreboard.scoreboard import scoreboard

path, out, last, share = sys.argv[1], sys.argv[2], int(sys.argv[3]), float(sys.argv[4])
write, rows = kept_tasks.add_line, 0

def killed(path, row):  # in the middle of the row after the last
    global rows
    rows += 1
    write(path, row)
    if rows > last:
        size = path.stat().st_size
        os.truncate(path, size - int(share * len(path.read_bytes().splitlines()[-1])))
        os.kill(os.getpid(), signal.SIGKILL)

kept_tasks.add_line = killed
slew = [scenes.get("single-link-slew", duration=0.2)]
scoreboard(slew, ["LQR", "PD"], **{options}, kept=path).raw.save(out)
"""


def soft(scene):
    return LQR.for_scene(scene, effort=10.0)


def hard(scene):
    return LQR.for_scene(scene)


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    path = tmp_path_factory.mktemp("kept") / "board.jsonl"
    return path, scoreboard(SCENES, ["LQR"], **OPTIONS, kept=path)


def test_what_is_kept_is_read_and_not_played_again(kept, monkeypatch):
    path, board = kept
    size = path.stat().st_size
    monkeypatch.setattr(sys.modules["pliant.studies.scoreboard.scoreboard"], "work", None)
    again = scoreboard(SCENES, ["LQR"], **OPTIONS, kept=path)
    assert [row.to_json() for row in again.rows] == [row.to_json() for row in board.rows]  # times of act too
    for name in COLUMNS:
        np.testing.assert_array_equal(again.raw.columns[name], board.raw.columns[name])
    assert again.entries == board.entries and path.stat().st_size == size
    np.testing.assert_array_equal(again.lines["single-link-slew", "LQR"].u, board.lines["single-link-slew", "LQR"].u)


def test_a_line_that_was_cut_off_is_played_again(kept, tmp_path):
    path, board = kept
    half = tmp_path / "half.jsonl"
    half.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
    again = scoreboard(SCENES, ["LQR"], **OPTIONS, kept=half)
    for name in COLUMNS:
        np.testing.assert_array_equal(again.raw.columns[name], board.raw.columns[name])


def test_another_law_of_the_same_name_or_another_seed_is_other_work():
    slew = scenes.get("single-link-slew")
    task = (slew, "varied", "LQR", hard, 0, 16)
    assert kept_tasks.marked(task, 0) == kept_tasks.marked(task, 0)
    assert kept_tasks.marked(task, 1) != kept_tasks.marked(task, 0)
    assert kept_tasks.marked((slew, "varied", "LQR", soft, 0, 16), 0) != kept_tasks.marked(task, 0)
    with pytest.raises(ValueError, match="laws that travel"):
        kept_tasks.marked((slew, "varied", "LQR", lambda scene: soft(scene), 0, 16), 0)


def test_a_file_of_something_else_is_refused(tmp_path):
    (tmp_path / "rows.jsonl").write_text('{"study": 1}\n')
    with pytest.raises(ValueError, match=r"rows.jsonl.*no runs of pliant-scoreboard-2"):
        kept_tasks.read(tmp_path / "rows.jsonl")


@pytest.mark.campaign
def test_killed_ten_times_it_ends_as_if_undisturbed(kept, tmp_path):
    path, out = tmp_path / "board.jsonl", tmp_path / "runs.npz"
    code, rng, kills = CHILD.format(options=OPTIONS), np.random.default_rng(0), 0
    while not out.exists():
        last = 0 if kills < 5 else 1 if kills < 10 else 1000
        done = subprocess.run([sys.executable, "-c", code, str(path), str(out), str(last), str(rng.uniform())])
        kills += done.returncode == -signal.SIGKILL
    whole = scoreboard(SCENES, ["LQR", "PD"], **OPTIONS)
    found = RawRuns.load(out)
    assert kills == 10
    for name in COLUMNS:
        np.testing.assert_array_equal(found.columns[name], whole.raw.columns[name])


@pytest.mark.campaign
def test_a_cluster_of_two_local_workers_gives_the_same_table(kept):
    distributed = pytest.importorskip("distributed", reason="dask is not installed")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster),
    ):
        again = scoreboard(SCENES, ["LQR"], **{**OPTIONS, "backend": "dask", "jobs": 2})
    for name in COLUMNS:
        np.testing.assert_array_equal(again.raw.columns[name], kept[1].raw.columns[name])
