"""Valid calls of studies. What takes seconds is tried with nonsense only, which is refused before."""

from __future__ import annotations

import numpy as np
from argument_kinds import Call, Choice, Flag, Kind, Names, Object, Objects
from further_kinds import ByName, Function, Place, Text
from kinds_of_numbers import POSITIVE, Array, Count, Number
from laws_at_hand import ARM, SCENE, SCENES, folder

from pliant.controllers import LQR
from pliant.plants import LinearModel
from pliant.studies import chart, choose, progress_bar, report, scoreboard
from pliant.studies.charts.gallery import gallery
from pliant.studies.closed_loop.contestants import playable
from pliant.studies.closed_loop.rollout import nominal, randomised, reading_noise, rollout
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.mode_count import modes_needed
from pliant.studies.fidelity.stiffening import stiffening_needed
from pliant.studies.figures import style
from pliant.studies.papers import registry
from pliant.studies.peers import measure
from pliant.studies.stability.judgement import judge
from pliant.studies.stability.parameter_map import map_stability
from pliant.studies.stability.verdicts import verdict_at_goal, verdict_of

TOLD = {"progress": Function(lambda share, words: None, none=True)}


class Grid(ByName):
    """Two parameters and their values."""

    def bad(self):
        """No names, one, values that do not ascend."""
        yield from ((what, value) for what, value in Kind.bad(self))
        yield from (("a number", 3.0), ("a string", "abc"), ("one", {"a": [1.0]}), ("a list", ["a", "b"]))
        for what, wrong in (("strings", ["1", "2"]), ("NaN", [np.nan]), ("descending", [2.0, 1.0]), ("nothing", [])):
            yield what, {"a": wrong, "b": [1.0]}
        yield from (
            ("complex", {"a": [1j], "b": [1.0]}),
            ("None", {"a": None, "b": [1.0]}),
            ("a key", {1: [1.0], "b": [1.0]}),
        )

    def good(self):
        """Arrays, tuples."""
        yield "arrays", {name: np.array(values) for name, values in self.value.items()}
        yield "tuples", {name: tuple(values) for name, values in self.value.items()}


class Played(Object):
    """A motion; a function that gives one is valid too."""

    def bad(self):
        """All but functions."""
        yield from ((what, value) for what, value in Object.bad(self) if what != "a function")


class Asked(Flag):
    """A flag, or a function that does what it asks for."""

    def bad(self):
        """All but functions."""
        yield from ((what, value) for what, value in Flag.bad(self) if what != "a function")


def built(a: float, b: float) -> LinearModel:
    """An oscillator."""
    return LinearModel.from_matrices([[0.0, 1.0], [-a, -b]], [[0.0], [1.0]])


def study_calls() -> list[Call]:
    """Of all of these."""
    return [*run_calls(), *long_calls(), *map_calls()]


def run_calls() -> list[Call]:
    """Of runs of a scene."""
    law = LQR.for_scene(SCENE)
    return [
        Call("rollout", rollout, SCENES | {"controller": Object(law), "conditions": Object(nominal(SCENE), none=True)}),
        Call("nominal", nominal, SCENES),
        Call("randomised", randomised, SCENES | {"count": Count(2), "seed": Count(1, low=0)}),
        Call("reading_noise", reading_noise, SCENES),
        Call("playable", playable, {"names": Names(("single-link-slew",), none=True)}),
        Call("verdict_at_goal", verdict_at_goal, SCENES),
        Call("style.save", style.save, {"path": Place(folder() / "picture.png")}, {"figure": _figure()}),
    ]


def _figure():
    return style.panels(1)[0]


def long_calls() -> list[Call]:
    """Of what takes seconds."""
    budget, motions = {"budget": Number(1.0, **POSITIVE)}, {"motions": Object(Motions(SCENE), none=True)}
    part = {"variants": Objects((ARM,), none=True), "methods": Names(("rk4",)), "prune": Flag(True)}
    keeping = {"kept": Place(folder() / "rows.jsonl", none=True), "peers": Asked(False)}
    every = {
        "out": Place(folder() / "charts"),
        "scenes": Names(("single-link-slew",), none=True),
        "peers": Asked(False),
    }
    tolerance = {"tolerance": Number(0.5, none=True, **POSITIVE), "measured": Object(_chart(), none=True)}
    counts = {
        "seeds": Count(1),
        "seed": Count(1, low=0),
        "bounds": Count(1, low=0),
        "jobs": Count(1, low=None, none=True),
    }
    who = {"scenes": Names(("single-link-slew",), none=True), "controllers": Names(("LQR",), none=True)}
    out = {"out": Place(folder() / "report"), "budget": Number(1.0, none=True, **POSITIVE)}
    sizes = {"tolerance": Number(0.5, **POSITIVE), "most": Count(2), "size": Number(0.5, **POSITIVE)}
    compared = np.zeros((len(SCENE.times), len(SCENE.compare)))
    return [
        Call("chart", chart, SCENES | budget | part | motions | keeping | TOLD, long=True),
        Call("gallery", gallery, every | budget | TOLD, long=True),
        Call(
            "measure",
            measure,
            SCENES | {"outputs": Array(compared), "budget": Number(0.5, **POSITIVE)} | TOLD,
            long=True,
        ),
        Call("choose", choose, SCENES | tolerance | motions | TOLD, long=True),
        Call("progress_bar", progress_bar, {"title": Text("chart")}),
        Call("report", report, SCENES | out | TOLD, long=True),
        Call("scoreboard", scoreboard, who | counts | TOLD, long=True),
        Call(
            "modes_needed",
            modes_needed,
            {"plant": Object(ARM), "nominal": Played(SCENE.open_loop())}
            | sizes
            | {"with_modes": Function(lambda plant, n: plant, none=True)},
            long=True,
        ),
        Call("stiffening_needed", stiffening_needed, SCENES, long=True),
        Call(
            "judge",
            judge,
            SCENES | {"seconds": Number(1.0, low=0.0), "largest": Number(8.0, **POSITIVE)} | TOLD,
            long=True,
        ),
        Call("verdict_of", verdict_of, SCENES | TOLD, long=True),
        Call("papers.draw", registry.draw, {"paper": Choice("single-link")}, long=True),
        Call(
            "papers.write",
            registry.write,
            {"paper": Choice("single-link"), "folder": Place(folder()), "progress": Function(print)},
            long=True,
        ),
    ]


def _chart():
    from pliant.studies.fidelity.speed_accuracy import Chart, Reference

    return Chart("short", ("tip_x",), 0.5, 1.0, (), Reference("rigid", "rigid, simulated", 0.0), {}, 1.0)


def map_calls() -> list[Call]:
    """Of the stability map, and of what it and a chart give."""
    grid = {"grid": Grid({"a": [1.0, 2.0], "b": [0.5, 1.0]}), "period": Number(1.0, none=True, **POSITIVE)}
    how = {
        "jobs": Count(1, low=None),
        "backend": Choice("sequential"),
        "at": ByName({"hub_angle": 0.0}, none=True, any=True),
    }
    found = map_stability(built, {"a": [1.0], "b": [0.5]}, jobs=1, backend="sequential")
    return [
        Call("map_stability", map_stability, {"plant": Function(built)} | grid | how | TOLD),
        Call("StabilityMap.share", found.share, {"verdict": Choice("stable")}),
        Call("StabilityMap.save", found.save, {"table": Place(folder() / "map.json", none=True)}),
        Call("Chart.save", _chart().save, {"table": Place(folder() / "chart.json")}),
        Call(
            "Chart.fastest",
            _chart().fastest,
            {"tolerance": Number(0.5, none=True, low=0.0), "lanes": Choice(1)},
        ),
    ]
