"""A law from an outsider's file: played as ours, told apart by its content, its faults told."""

import pytest

from pliant.envs import scenes
from pliant.plants import PliantError
from pliant.studies.commands import scoreboard as command
from pliant.studies.commands.cli import main
from pliant.studies.scoreboard.own_laws import OwnLaw
from pliant.studies.scoreboard.scoreboard import scoreboard

SLEW = scenes.get("single-link-slew", duration=0.2)
FILE = """
from pliant.controllers import LQR

class Soft:
    @classmethod
    def for_scene(cls, scene):
        return LQR.for_scene(scene, effort=4.0)

def same(scene):
    return LQR.for_scene(scene)

def wrong(scene):
    return 7

class Half:
    def __init__(self, scene):
        self.dt = scene.dt

    def act(self, t, y):
        return [0.0]

def broken(scene):
    return scene["x"]
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    made = tmp_path_factory.mktemp("own") / "my_scored_law.py"
    made.write_text(FILE)
    return made


def test_it_is_played_as_the_others_are(path):
    makers = {"own": OwnLaw.of(f"{path}:same"), "soft": OwnLaw.of(f"{path}:Soft")}
    own = scoreboard([SLEW], makers, seeds=2, bounds=0, jobs=1)
    ours = scoreboard([SLEW], ["LQR"], seeds=2, bounds=0, jobs=1)
    for case in ("exact", "varied", "all at once"):
        costs = [own.row(SLEW.name, case, name).cost for name in ("own", "soft")]
        assert costs[0] == ours.row(SLEW.name, case, "LQR").cost != costs[1]


def test_faults_are_told_in_its_row(path):
    half = r"gave an object of Half, must be a controller: it lacks reads, names of states or outputs, reset\(\)$"
    faults = (("wrong", "gave 7, must be a controller"), ("Half", half), ("broken", "TypeError: 'Scene' object"))
    for name, words in faults:
        with pytest.raises(PliantError, match=words):
            OwnLaw.of(f"{path}:{name}")(SLEW)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("law.py", "my_law.py:Law"),
        ("nowhere.py:Law", "no file 'nowhere.py'"),
        ("{path}:Nothing", "no class or function"),
    ],
)
def test_bad_names_are_refused(path, text, words):
    with pytest.raises(ValueError, match=words):
        OwnLaw.of(text.format(path=path))


def test_a_law_that_is_none_is_told_before_bounds_are_looked_for(path, monkeypatch, capsys):
    monkeypatch.setattr(command, "score", lambda *given, **named: pytest.fail("it was played"))
    monkeypatch.setattr("sys.argv", ["pliant", "scoreboard", "single-link-slew", "--law", f"{path}:Half"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 1 and "it lacks reads" in capsys.readouterr().err
