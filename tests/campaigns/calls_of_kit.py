"""Valid calls of filters, of what writes controllers to files, and of Monte Carlo."""

from __future__ import annotations

import numpy as np
from argument_kinds import Call, Choice, Flag, Names, Object, Objects
from further_kinds import ByName, Function, Place
from kinds_of_numbers import POSITIVE, Array, Count, Number
from laws_at_hand import DT, GAIN, SCENE, SCENES, folder

from pliant.controllers import (
    LQR,
    Feedback,
    Filter,
    Filtered,
    arrays_of,
    export_arrays,
    export_c,
    lag,
    notch,
    roll_off,
)
from pliant.controllers.joint_control.input_shaping import shaper
from pliant.studies import monte_carlo, robustify
from pliant.studies.scene_pages.returns import returns
from pliant.studies.scene_pages.tables import tables
from pliant.studies.slews import compare_slews


class Factors(ByName):
    """Pairs of factors by name."""

    def bad(self):
        """No pairs, and pairs that are no range."""
        yield from (
            (what, {"link.E": value}) for what, value in (("a number", 1.0), ("a string", "ab"), ("None", None))
        )
        yield from (("a list", [1.0]), ("a number", 1.0), ("nothing", {}), ("another key", {1: (0.5, 1.0)}))
        for what, pair in (("NaN", (np.nan, 1.0)), ("descending", (1.0, 0.5)), ("negative", (-1.0, 1.0))):
            yield what, {"link.E": pair}

    def good(self):
        """As it is."""
        yield "itself", self.value


def kit_calls() -> list[Call]:
    """Of all of these."""
    return [*filter_calls(), *file_calls(), *run_calls()]


def filter_calls() -> list[Call]:
    """Of filters."""
    f, w = notch(4.0), {"frequency": Number(4.0, **POSITIVE)}
    matrices = {"A": Array(np.array([[-0.5]])), "B": Array(np.ones((1, 1))), "C": Array(np.ones((1, 1)))}
    matrices |= {"D": Array(np.ones((1, 1))), "dt": Number(DT, none=True, **POSITIVE)}
    powers = {"numerator": Array(np.array([1.0, 4.0]), leads=True, wrong=False)}
    powers |= {"denominator": Array(np.array([1.0, 2.0, 4.0]), leads=True, wrong=False)}
    sampled = Feedback(np.array([[2.0, 1.0]]), ("s", "v"), dt=DT)
    acting = Filtered(sampled, (f,))
    prewarped = {"dt": Number(DT, **POSITIVE), "prewarp": Number(4.0, none=True, **POSITIVE)}
    return [
        Call("Filter", Filter, matrices | {"frequency": Number(4.0, none=True, **POSITIVE)}),
        Call("Filter.from_coefficients", Filter.from_coefficients, powers),
        Call("Filter.at", f.at, {"omega": Array(np.array([1.0, 2.0]), leads=True)}),
        Call("Filter.discretised", f.discretised, prewarped),
        Call("Filter.then", f.then, {"other": Object(f)}),
        Call("notch", notch, w | {"depth": Number(0.5, low=0.0), "width": Number(0.5, **POSITIVE)}),
        Call("roll_off", roll_off, w | {"order": Count(2)}),
        Call("lag", lag, {"slow": Number(0.5, **POSITIVE), "fast": Number(2.0, **POSITIVE)}),
        Call("Filtered", Filtered, {"law": Object(GAIN), "filters": Objects((f,))}),
        Call("Filtered.act", acting.act, {"t": Number(0.5), "y": Array(np.ones(2))}, compare=False),
    ]


def file_calls() -> list[Call]:
    """Of files of controllers."""
    step = folder() / "step.c"
    return [
        Call("export_c", export_c, {"path": Place(folder() / "law.c"), "precision": Choice("single")}, {"what": GAIN}),
        Call(
            "export_c, a plant",
            export_c,
            {"dt": Number(DT, **POSITIVE)},
            {"what": SCENE.plant, "path": step},
        ),
        Call("export_c, what", export_c, {"what": Object(GAIN)}, {"path": folder() / "law.c"}),
        Call("export_arrays", export_arrays, {"path": Place(folder() / "law.npz")}, {"what": GAIN}),
        Call("arrays_of", arrays_of, {"what": Object(GAIN)}),
    ]


def run_calls() -> list[Call]:
    """Of Monte Carlo."""
    ranges = {"ranges": Factors({"link.E": (0.5, 1.0)})}
    counts = {"runs": Count(1), "seed": Count(1, low=0), "delay": Count(1, low=0), "noise": Flag(False)}
    more = {"backend": Choice("threading"), "kept": Place(folder() / "runs.jsonl", none=True)}
    more |= {"progress": Function(lambda share, words: None, none=True)}
    law = LQR.for_scene(SCENE)
    shown = {"profiles": Names(("bang-bang",)), "shaper": Object(shaper(4.0), none=True), "points": Count(50)}
    return [
        Call("monte_carlo", monte_carlo, SCENES | {"law": Object(law)} | ranges | counts | more, long=True),
        Call(
            "robustify",
            robustify,
            SCENES
            | {"law": Object(law), "noise": Flag(False), "redesign": Flag(False)}
            | {"ranges": Factors({"link.E": (0.5, 1.0)}), "progress": more["progress"]},
            {"delays": (0,), "efforts": (1.0,)},
            long=True,
        ),
        Call("scene_pages.tables", tables, SCENES, compare=False),
        Call("scene_pages.returns", returns, SCENES, long=True),
        Call("compare_slews", compare_slews, SCENES | shown, long=True),
    ]
