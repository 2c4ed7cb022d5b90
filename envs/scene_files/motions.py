"""Nominal inputs that a scene file can name: `motion = {type = "smooth-spin-up", speed = 6.0, time = 15.0}`."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.envs.scenes.beams import SmoothSpinUp
from pliant.envs.scenes.nominal_inputs import let_go
from pliant.envs.scenes.scene import Drive
from pliant.envs.scenes.spacecraft import Articulation
from pliant.plants import Plant
from pliant.plants.core.argument_gates import nested, require_choice, require_finite, require_number, shown


@dataclass(frozen=True)
class Samples:
    """Inputs between samples on straight lines, the last one held."""

    times: tuple[float, ...]  # (nt,) [s], increasing from 0
    inputs: tuple[tuple[float, ...], ...]  # (nt, nu), each in its own unit

    def __post_init__(self) -> None:
        t = require_finite("samples.times", self.times, (-1,))
        u = require_finite("samples.inputs", self.inputs, (len(t), -1))
        if not len(t) or t[0] != 0.0 or np.any(np.diff(t) <= 0):
            raise ValueError(f"samples.times = {shown(self.times)} must increase from 0.0 [s]")
        object.__setattr__(self, "times", nested(t))
        object.__setattr__(self, "inputs", nested(u))

    def __call__(self, plant: Plant, t: float) -> np.ndarray:
        rows = np.array(self.inputs)
        if rows.shape[1] != plant.nu:
            raise ValueError(f"samples.inputs has rows of {rows.shape[1]} numbers, must have {plant.nu}")
        return np.array([np.interp(t, self.times, column) for column in rows.T])


TYPES: dict[str, Any] = {
    "rest-to-rest": None,  # a minimum-jerk motion of the rigid plant from start to goal in move_time
    "let-go": let_go,
    "smooth-spin-up": SmoothSpinUp,
    "articulation": Articulation,
    "samples": Samples,
}


def motion_table(drive: Drive | None) -> dict[str, Any]:
    """The table of a scene's drive. ValueError for a function that no file can name."""
    for name, made in TYPES.items():
        if drive is made:
            return {"type": name}
        if isinstance(made, type) and type(drive) is made:
            fields: Any = dataclasses.fields(made)
            return {"type": name, **{f.name: _listed(getattr(drive, f.name)) for f in fields}}
    raise ValueError(f"Scene.drive = {shown(drive)} cannot be written, must be one of {', '.join(TYPES)}")


def _listed(value: Any) -> Any:
    return [_listed(part) for part in value] if isinstance(value, tuple) else value


def motion_of(owner: str, table: Any) -> Drive | None:
    """The drive of a table."""
    if not isinstance(table, Mapping) or "type" not in table:
        raise ValueError(f"{owner} = {shown(table)} must be a table with a type, one of {', '.join(TYPES)}")
    given = dict(table)
    require_choice(owner, "type", name := given.pop("type"), tuple(TYPES))
    made = TYPES[name]
    known = [f.name for f in dataclasses.fields(made)] if isinstance(made, type) else []
    for key, value in given.items():
        if key not in known:
            listed = ", ".join(known) or "(there are none)"
            raise ValueError(f"{owner}.{key} = {shown(value)}: {name!r} has no {key!r}, must be one of {listed}")
    if not isinstance(made, type):
        drive: Drive | None = made
        return drive
    if missing := [key for key in known if key not in given]:
        raise ValueError(f"{owner} = {shown(dict(table))} lacks {', '.join(missing)}, which {name!r} must have")
    if made is not Samples:
        positive = ("time",)
        given = {
            key: require_number(f"{owner}.{key}", value, "positive" if key in positive else "finite")
            for key, value in given.items()
        }
    try:
        found: Drive = made(**given)
    except ValueError as refused:
        raise ValueError(f"{owner}: {refused}") from None
    return found
