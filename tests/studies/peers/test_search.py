"""The search for a program's best settings, on a program whose errors and times are known."""

from itertools import pairwise

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.peers.planar_machine import machine_of
from pliant.studies.peers.programs import BrokenDownError, Player, Setting
from pliant.studies.peers.search import FLOOR, Found, Search, best, settled

MACHINE = machine_of(scenes.get("cantilever-drop"))
OUTPUTS = np.linspace([0.0, 0.0], [1.0, -2.0], MACHINE.steps + 1)


class Known:
    """Error 0.1/parts^2 + 0.1/substeps^2; "slow" takes twice the time of "fast"; four substeps at least."""

    peer = package = "known"
    part = "parts"

    def why_not(self, machine):
        return ""

    def parts(self, machine):
        return 1, 2, 4, 8, 16, 32

    def solvers(self):
        return "fast", "slow"

    def beside(self, solver):
        return ("tuned",) if solver == "fast" else ()

    def player(self, machine, setting):
        if setting.substeps < 4:
            raise BrokenDownError("the steps are too long")
        error = 0.1 / setting.parts**2 + 0.1 / setting.substeps**2
        seconds = {"fast": 1e-5, "slow": 2e-5, "tuned": 0.5e-5}[setting.solver] * setting.parts * setting.substeps
        tip = OUTPUTS + error
        return Player(lambda: ((tip, np.zeros(machine.steps + 1)), seconds), lambda: seconds)


def test_front_is_what_nothing_beats():
    front = Search(Known(), MACHINE, OUTPUTS, 1e-3, 60.0).front()
    assert len(front) > 4 and {at.setting.solver for at in front} == {"tuned"}
    for a, b in pairwise(front):
        assert a.seconds < b.seconds and b.error < a.error
    assert front[-1].error < 3e-4 and all(at.runs > 1 and at.setting.substeps >= 4 for at in front)


def test_no_time_no_rows():
    assert Search(Known(), MACHINE, OUTPUTS, 1e-3, 1e-9).front() == []


def test_no_motion_no_rows():
    class Broken(Known):
        def player(self, machine, setting):
            raise BrokenDownError("no")

    search = Search(Broken(), MACHINE, OUTPUTS, 1e-3, 5.0)
    assert search.front() == [] and search.tried > 0


def test_an_error_that_does_not_matter_is_not_made_smaller():
    class Exact(Known):
        def player(self, machine, setting):
            tip = OUTPUTS + 0.1 * FLOOR
            return Player(lambda: ((tip, np.zeros(machine.steps + 1)), 1e-3), lambda: 1e-3)

    search = Search(Exact(), MACHINE, OUTPUTS, 1.0, 60.0)
    assert len(search.front()) == 1 and search.tried <= 13  # one a solver and parts, one beside it


@pytest.mark.parametrize("errors, done", [((1e-3, 9.9e-4), True), ((1e-3, 5e-4), False)])
def test_settled_where_shorter_steps_change_nothing(errors, done):
    before, after = (Found(Setting(2, k), 1.0, e) for k, e in zip((4, 8), errors))
    assert settled(before, after) is done


def test_what_is_worse_than_not_to_move_is_no_row():
    search = Search(Known(), MACHINE, 1e-6 * OUTPUTS, 1e-3, 5.0)
    assert search.front() == [] and search.tried > 0


def test_best():
    points = [(1.0, 1.0), (2.0, 0.9), (3.0, 0.5), (2.5, 2.0), (4.0, 0.1)]
    found = [Found(Setting(1, 1), s, e) for s, e in points]
    assert [(f.seconds, f.error) for f in best(found)] == [(1.0, 1.0), (3.0, 0.5), (4.0, 0.1)]
