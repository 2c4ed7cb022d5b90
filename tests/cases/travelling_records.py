"""Records of studies, evaluations and certificates, filled with made-up values, and the library's errors."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
from typing import Any

import numpy as np
from travelling import Roll, fields

from pliant.plants import (
    PliantError,
)  # fmt: skip

ROLL = Roll()
traveller, record = ROLL.traveller, ROLL.record

RECORDS = {  # of studies, evaluations and certificates: filled with made-up values
    "plants.stability.frozen_time": "SlowVariation",
    "plants.stability.lyapunov_certificate": "Certificate",
    "controllers.linear_quadratic.funnel": "Funnel",
    "controllers.learning.evaluation": "Evaluation Training",
    "envs.scenes.beams": "SmoothSpinUp",
    "envs.scenes.spacecraft": "Articulation",
    "studies.closed_loop.closed_loop": "Loop",
    "studies.closed_loop.comparison": "Contest",
    "studies.closed_loop.contestants": "Designed",
    "studies.closed_loop.scores": "Score Row",
    "studies.fidelity.choice": "Rung Choice",
    "studies.physics.effects": "Effect",
    "studies.fidelity.mode_count": "ModeCount ModesNeeded",
    "studies.fidelity.speed_accuracy": "Row Reference Chart",
    "studies.fidelity.stiffening": "Stiffening",
    "studies.papers.single_link": "SpinUp",
    "studies.report.findings": "Findings",
    "studies.scoreboard.results": "Entry Line Results",
    "studies.scoreboard.scoreboard": "Scoreboard",
    "studies.stability.judgement": "Judgement",
    "studies.stability.parameter_map": "StabilityMap",
}


def made_up(kind: type) -> Any:
    """A record with a value of each field's kind: it holds nothing that knows where it is."""
    made = kind.__new__(kind)
    for k, field in enumerate(dataclasses.fields(kind)):
        about = str(field.type)
        array = np.arange(3.0 + k)
        array.setflags(write=bool(k % 2))
        held = array if "ndarray" in about or about == "Array" else 0.5 + k
        value = (held, "name") if about.startswith("tuple") else held
        object.__setattr__(made, field.name, f"name {k}" if about == "str" else value)
    return made


for where, what in RECORDS.items():
    for name in what.split():
        at = importlib.import_module(f"pliant.{where}")
        record(f"{where}.{name}")(lambda at=at, name=name: made_up(getattr(at, name)))


def kinds(base: type) -> list[type]:
    return [base, *(kind for below in base.__subclasses__() for kind in kinds(below))]


@traveller("errors", lambda errors: [str(e).encode() for e in errors] + [fields(vars(e)) for e in errors])
def _errors() -> Any:
    """Each that the library raises; what it takes beside its message is made up by name."""
    made = []
    for kind in [k for k in kinds(PliantError) if k.__module__.startswith("pliant")]:
        takes = [p for p in inspect.signature(kind.__init__).parameters.values() if p.kind is p.POSITIONAL_OR_KEYWORD]
        made.append(kind("what happened", *([0.5] * (len(takes) - 2 if "message" in [p.name for p in takes] else 0))))
    return made
