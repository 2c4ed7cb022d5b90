"""What other programs give of a scene."""

import os
import sys
import time
from itertools import pairwise

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions
from pliant.studies.peers import measure
from pliant.studies.peers.measure import PROGRAMS, one_core, util
from pliant.studies.peers.programs import BrokenDownError, Player
from pliant.studies.physics.physics_motion import physics_motion

measuring = sys.modules["pliant.studies.peers.measure"]  # whose name is the function's too
DROP = scenes.get("cantilever-drop", duration=1.0)


def zeros(scene):
    return np.zeros((len(scene.times), len(scene.compare)))


def test_a_spacecraft_has_no_peer_and_says_why():
    scene = scenes.get("spacecraft-slew")
    rows = measure(scene, zeros(scene))
    assert [row.peer for row in rows] == [program.peer for program in PROGRAMS]
    assert all("hub" in row.failure and row.seconds is None and row.error is None for row in rows)


def test_what_is_not_installed_is_a_row(monkeypatch):
    monkeypatch.setattr(util, "find_spec", lambda name: None)
    for row, program in zip(measure(DROP, zeros(DROP)), PROGRAMS, strict=True):
        assert row.failure == f"{program.package} is not installed"


def test_what_fails_is_a_row(monkeypatch):
    def player(*_):
        raise RuntimeError("no licence")

    for program in PROGRAMS:
        monkeypatch.setattr(type(program), "player", player)
    monkeypatch.setattr(util, "find_spec", lambda name: True)
    assert {row.failure for row in measure(DROP, zeros(DROP))} == {"RuntimeError: no licence"}


def test_where_no_setting_gives_a_motion_the_row_says_of_how_many(monkeypatch):
    def player(*_):
        def broken():
            raise BrokenDownError("the steps are too long")

        return Player(broken, broken)

    monkeypatch.setattr(measuring, "PROGRAMS", PROGRAMS[:1])
    monkeypatch.setattr(type(PROGRAMS[0]), "player", player)
    monkeypatch.setattr(util, "find_spec", lambda name: True)
    (row,) = measure(DROP, zeros(DROP) + 1.0)
    assert row.searched > 100 and row.failure == f"none of {row.searched} settings tried gives a motion"


def test_rows_are_fronts(monkeypatch):
    monkeypatch.setattr(measuring, "PROGRAMS", PROGRAMS[:2])
    monkeypatch.setattr(time, "perf_counter", time.process_time)  # what else runs here must not shorten the search
    pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    told = []
    truth = physics_motion(Motions(DROP), DROP.tolerance).outputs
    rows = measure(DROP, truth, budget=3.0, progress=lambda fraction, task: told.append(fraction))
    assert told[0] == 0.0 and told[-1] == 1.0 and told == sorted(told)
    chain = [row for row in rows if row.peer.startswith("MuJoCo, rigid")]
    assert len(chain) > 3 and all(row.failure is None and row.runs and row.searched > 10 for row in chain)
    for a, b in pairwise(chain):
        assert 0 < a.seconds < b.seconds and b.error < a.error


@pytest.mark.parametrize(
    "given, words",
    [
        ({"outputs": np.zeros((2, 2))}, "measure.outputs"),
        ({"outputs": np.full((21, 2), np.nan)}, "measure.outputs"),
        ({"budget": 0.0}, "measure.budget"),
        ({"scene": "cantilever-drop"}, "measure.scene"),
        ({"progress": 1}, "measure.progress"),
    ],
)
def test_bad_input(given, words):
    with pytest.raises(ValueError, match=words):
        measure(**{"scene": DROP, "outputs": zeros(DROP)} | given)


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="threads cannot choose their core here")
def test_one_core_and_back():
    before = os.sched_getaffinity(0)
    with one_core():
        assert len(os.sched_getaffinity(0)) == 1
    assert os.sched_getaffinity(0) == before
