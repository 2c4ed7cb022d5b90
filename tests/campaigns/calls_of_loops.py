"""Valid calls of what looks at loops: margins, robustness, the worst of a box."""

from __future__ import annotations

import numpy as np
from argument_kinds import Call, Choice, Names, Object, Objects
from further_kinds import ByName, Function, Text
from kinds_of_numbers import POSITIVE, Array, Count, Number
from laws_at_hand import ARM, DT, GAIN, MODEL, SCENE, STATES, law

from pliant.controllers import (
    LQR,
    loop,
    margins,
    spillover,
)
from pliant.controllers.analysis.linear_laws import LinearLaw, linearised
from pliant.controllers.analysis.loops import closed_loop, closed_loops
from pliant.controllers.analysis.margins import disk_gain, disk_phase_deg
from pliant.controllers.analysis.margins_along import margins_along
from pliant.controllers.analysis.spillover import case_of, crossover_hz, growth
from pliant.controllers.robust_analysis.miss_over_box import miss_over_box
from pliant.controllers.robust_analysis.robust_gain import UncertainLTV, robust_gain, shows
from pliant.controllers.robust_analysis.robust_stability import over_box, robust_stability, stands
from pliant.controllers.robust_analysis.worst_parameters import worst_parameters
from pliant.plants import Trajectory


def loop_calls() -> list[Call]:
    """Of loops, margins, spillover."""
    model, controller = {"model": Object(MODEL)}, {"controller": Object(law("lqr, continuous"))}
    found = loop(MODEL, law("lqr, continuous"))
    reads = {"reads": Names(("place",), free=True), "dt": Number(DT, none=True, **POSITIVE), "delay": Count(1, low=0)}
    own = {
        "A": Array(np.array([[0.5]])),
        "B": Array(np.ones((1, 1))),
        "C": Array(np.ones((1, 1)), leads=True),
        "D": Array(np.ones((1, 1))),
    }
    more = {"at": ByName({"hub_angle": 0.5}, none=True), "reserve": Number(1.25, low=1.0)}
    spill = LQR.for_plant(ARM, np.zeros(2), np.zeros(1), np.eye(2), np.eye(1))
    return [
        *robust_calls(),
        Call("LinearLaw", LinearLaw, own | reads),
        Call(
            "linearised",
            linearised,
            {"controller": Object(GAIN), "y0": STATES, "step": Number(0.5, **POSITIVE), "t": Number(0.5)},
        ),
        Call("loop", loop, model | controller | {"at": Choice("input")}),
        Call("closed_loops", closed_loops, model | controller),
        Call("closed_loop", closed_loop, model | controller | {"gain": Number(0.5)}),
        Call("Loop.at", found.at, {"omega": Array(np.array([1.0, 2.0]), leads=True)}),
        Call("margins", margins, {"loop": Object(found)}),
        Call("disk_gain", disk_gain, {"disk": Number(0.5, low=0.0)}),
        Call("disk_phase_deg", disk_phase_deg, {"disk": Number(0.5, low=0.0)}),
        Call("growth", growth, model | controller | {"gain": Number(0.5)}),
        Call("case_of", case_of, model | controller | {"design": Object(MODEL), "label": Text("plant", empty=True)}),
        Call("crossover_hz", crossover_hz, {"found": Object(found), "gain": Number(0.5, **POSITIVE)}),
        Call("spillover", spillover, {"controller": Object(spill), "plants": Objects((ARM,))} | more),
        Call(
            "spillover, redesign",
            spillover,
            {"redesign": Function(lambda f: spill, none=True)},
            {"controller": spill, "plants": [ARM], "at": {"hub_angle": 0.0}},
        ),
    ]


def robust_calls() -> list[Call]:
    """Of boxes of parameters and of uncertain blocks."""
    one, t = np.ones((5, 1, 1)), np.linspace(0.0, 1.0, 5)
    fields = {n: Array(v) for n, v in {"t": t, "A": -one, "B": one, "E": one, "C": one, "D": 0 * one}.items()}
    along = UncertainLTV(t, -one, one, one, one, 0 * one, 0 * one, np.ones((1, 1)))
    sizes = {"size": Number(0.5, **POSITIVE), "pole": Number(2.0, **POSITIVE)}
    box, rest = {"link.E": (6e10, 7e10)}, {"hub_angle": 0.0}
    x, times = np.zeros((4, ARM.nx)), DT * np.arange(4)
    motion = Trajectory.from_arrays(times, x, np.zeros((4, ARM.nu)), plant=ARM)
    followed = ARM.linearize_along(motion)
    return [
        Call(
            "robust_stability",
            robust_stability,
            {"plant": Object(ARM), "controller": Object(LQR.for_scene(SCENE))},
            {"box": box, "at": rest},
            long=True,
        ),
        Call(
            "worst_parameters",
            worst_parameters,
            {"plant": Object(ARM), "nominal": Object(motion), "outputs": Names((ARM.outputs[0].name,))}
            | {"substeps": Count(2), "seed": Count(1, low=0)},
            {"box": box},
            long=True,
        ),
        Call(
            "miss_over_box",
            miss_over_box,
            {"plant": Object(ARM), "nominal": Object(motion), "outputs": Names((ARM.outputs[0].name,))}
            | {"substeps": Count(2), "seed": Count(1, low=0)},
            {"box": box},
            long=True,
        ),
        Call(
            "stands",
            stands,
            {"plant": Object(ARM), "controller": Object(LQR.for_scene(SCENE)), "parts": Count(20)},
            {"box": box, "at": rest},
            long=True,
        ),
        Call(
            "margins_along",
            margins_along,
            {"ltv": Object(followed), "K": Array(np.zeros((4, ARM.nu, ARM.nx)), wrong=False)}
            | {"limit": Number(2.0, low=1.0, open=True), "frozen": Count(2)}
            | {
                n: Names((s[0].name,), none=True)
                for n, s in (("outputs", ARM.outputs), ("disturbances", ARM.disturbances))
            },
            long=True,
        ),
        Call("robust_gain", robust_gain, {"system": Object(along)} | sizes, long=True),
        Call(
            "over_box",
            over_box,
            {"dt": Number(0.5, none=True, **POSITIVE)},
            {"state_matrix": lambda d: np.array([[-0.5 + d[0] / 4]]), "box": {"a": (1.0, 2.0)}},
            compare=False,
        ),
        Call("UncertainLTV", UncertainLTV, fields, {"F": 0 * one, "G": np.ones((1, 1))}),
        Call(
            "shows",
            shows,
            {"system": Object(along), "gain": Number(8.0, **POSITIVE), "multiplier": Array(np.eye(2), wrong=False)}
            | sizes,
        ),
    ]
