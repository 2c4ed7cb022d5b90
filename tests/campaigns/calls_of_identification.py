"""Valid calls of what identifies parameters from measured motions."""

from __future__ import annotations

import dataclasses
import tempfile
from pathlib import Path

import numpy as np
from argument_kinds import Call, Choice, Names, Object, Objects
from further_kinds import ByName, Place, Text
from kinds_of_numbers import Array, Count

from pliant.plants import (
    Experiment,
    SingleLinkArm,
    check,
    identify,
    rank_motions,
    read_experiment,
    register,
    write_experiment,
)

ARM = SingleLinkArm(link=SingleLinkArm.textbook().link, hub_inertia=1.0, kinematics="rigid")
VARIED = ARM.vary("hub_inertia")
T = np.linspace(0.0, 0.5, 5)
MOTION = ARM.simulate(None, np.ones((5, 1)), T)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Own(SingleLinkArm):
    """A user's own type."""


MEASURED = Experiment.of(MOTION, signals=("hub_angle",))
FOLDER = Path(tempfile.mkdtemp())


def identification_calls() -> list[Call]:
    """Of experiments, identification and design."""
    write_experiment(ARM, MEASURED, FOLDER / "run.csv")
    noise = ByName({"hub_angle": 2.0**-10}, low=0.0, open=True)
    known = {"noise": ByName({"hub_angle": 2.0**-10}, low=0.0, open=True, none=True)}
    begin = {"start": ByName({"hub_inertia": 1.5}, low=0.0, open=True, none=True)}
    searched = {"plant": Object(VARIED), "tries": Count(1), "seed": Count(0, low=0)}
    taken = {
        "u": Array(np.ones((5, 1)), none=True, wrong=False),
        "start": Array(np.zeros(2), none=True, wrong=False),
        "hold": Choice("linear"),
        "name": Text("run", empty=True),
    }
    read = {
        "signals": Names(("hub_angle",), none=True),
        "noise": ByName({"hub_angle": 0.5}, low=0.0, none=True),
        "seed": Count(0, low=0),
    }
    return [
        Call(
            "identify",
            lambda **k: identify(**k).values,
            searched | known | begin,
            {"motions": [MEASURED], "bounds": {"hub_inertia": (0.5, 2.0)}},
        ),
        Call(
            "rank_motions",
            lambda **k: rank_motions(**k).best.standard_errors,
            {"plant": Object(VARIED), "motions": Objects((MEASURED,)), "criterion": Choice("D"), "noise": noise}
            | begin,
        ),
        Call("Experiment", lambda **k: Experiment(t=T, measured={"hub_angle": T}, **k).t, taken),
        Call("Experiment.t", lambda t: Experiment(t=t, measured={"hub_angle": T}).t, {"t": Array(T, wrong=False)}),
        Call(
            "Experiment.of",
            lambda **k: Experiment.of(**k).measured["hub_angle"],
            {"motion": Object(MOTION)} | read,
        ),
        Call("register", lambda kind: register(kind).__name__, {"kind": Object(Own)}),
        Call(
            "check",
            lambda **k: str(check(**k)),
            {"plant": Object(ARM), "points": Count(1), "seed": Count(0, low=0)},
        ),
        Call(
            "read_experiment",
            lambda **k: read_experiment(**k).t,
            {"plant": Object(ARM), "path": Place(FOLDER / "run.csv")},
        ),
        Call(
            "write_experiment",
            write_experiment,
            {"plant": Object(ARM), "motion": Object(MEASURED), "path": Place(FOLDER / "out.csv")},
        ),
    ]
