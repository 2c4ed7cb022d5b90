"""Valid calls of scenes: their fields, their methods, `scenes.get` and minimum_jerk."""

from __future__ import annotations

import dataclasses
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from argument_kinds import Call, Choice, Flag, Kind, Names, Object, Pairs
from further_kinds import Function, Place, Text, Valued
from kinds_of_numbers import POSITIVE, Array, Count, Number
from laws_at_hand import ARM, SCENE

from pliant.envs import check_scene, scene_files, scenes
from pliant.envs.scenes.scene import Scene

FIELDS = {f.name: getattr(SCENE, f.name) for f in dataclasses.fields(SCENE)}
OWN, ROWS = dataclasses.replace(SCENE, name="a-scene-of-bad-input"), 3
FILE = Path(tempfile.mkdtemp(prefix="scene-files")) / "own.toml"
scene_files.save(OWN, FILE)


def scene_calls() -> list[Call]:
    """Of all of these."""
    return [*field_calls(), *method_calls(), *get_calls()]


def still(plant: Any, t: float) -> np.ndarray:
    """No input."""
    return np.zeros(plant.nu)


class Varied(Kind):
    """A scene's `randomise`."""

    def bad(self) -> Pairs:
        """Other types, unknown parameters, factors that are none."""
        yield from Kind.bad(self)
        yield from (("a number", 3.0), ("a string", "abc"), ("a bare row", ("payload.mass", 0.5, 2.0)))
        yield from (
            ("unknown", (("nonsense", 0.5, 2.0),)),
            ("two", (("payload.mass", 0.5),)),
            ("a number as a name", ((1, 0.5, 2.0),)),
        )
        for what, wrong in (("a string", "0.5"), ("NaN", np.nan), ("negative", -1.0), ("None", None), ("greater", 4.0)):
            yield f"{what} as the least", (("payload.mass", wrong, 2.0),)
        yield from (
            ("infinity", (("payload.mass", 0.5, np.inf),)),
            ("beyond a float", (("payload.mass", 0.5, 10**400),)),
        )

    def good(self) -> Pairs:
        """Lists, NumPy's numbers."""
        yield "lists", [list(row) for row in self.value]
        yield "NumPy's numbers", [(name, np.float64(low), np.float64(high)) for name, low, high in self.value]


def field_calls() -> list[Call]:
    """Of the class itself."""
    kinds: dict[str, Kind] = {
        "name": Text("short"),
        "about": Text("a short one", empty=True),
        "plant": Object(ARM),
        "start": Valued((("hub_angle", 0.0),)),
        "goal": Valued((("hub_angle", 0.03125),)),
        "nominal_start": Valued((("hub_angle", 0.0),), none=True),
        "start_at_rest": Flag(True),
        "goal_at_rest": Flag(True),
        "goal_rates": Valued((("hub_angle", 0.0),)),
        "drive": Function(still, none=True),
        "duration": Number(0.5, **POSITIVE),
        "dt": Number(0.0625, **POSITIVE),
        "substeps": Count(2),
        "move_time": Number(0.25, **POSITIVE),
        "limits": Array(np.array([40.0])),
        "bounds": Valued((("hub_angle_rate", 16.0),), **POSITIVE),
        "weights": Valued((("hub_angle", 8.0),), low=0.0),
        "effort": Valued((("hub_torque", 0.5),), **POSITIVE),
        "observe": Names(("hub_angle",)),
        "randomise": Varied((("payload.mass", 0.5, 2.0),)),
        "gusts": Valued((("tip_force_x", 0.5),), low=0.0),
        "start_spread": Number(0.5, low=0.0),
        "spreads": Valued((("hub_angle", 0.5),), low=0.0),
        "compare": Names(("tip_x",)),
        "tolerance": Number(0.5, **POSITIVE),
    }
    return [Call("Scene", Scene, kinds)]


def method_calls() -> list[Call]:
    """Of its methods."""
    nx, nu, ny = ARM.nx, ARM.nu, ARM.ny if hasattr(ARM, "ny") else len(ARM.outputs)
    x, y = Array(np.zeros((ROWS, nx)), infinite=True, leads=True), Array(np.ones((ROWS, ny)), infinite=True)
    u = Array(np.zeros((ROWS, nu)), infinite=True)
    names = {"names": Names(("hub_angle", "tip_x"))}
    motion = SCENE.open_loop(method="rk4", step=SCENE.dt)
    return [
        Call(
            "Scene.signal_values",
            SCENE.signal_values,
            {"x": _Rows(np.zeros((ROWS, nx))), "y": _Rows(np.ones((ROWS, ny)))} | names,
        ),
        Call(
            "Scene.stage_cost",
            SCENE.stage_cost,
            {"x": _Rows(x.value), "u": _Rows(u.value), "y": _Rows(y.value), "t": Number(0.25)},
        ),
        Call("Scene.positions", SCENE.positions, names),
        Call("Scene.goal_values", SCENE.goal_values, names),
        Call("Scene.goal_drift", SCENE.goal_drift, names),
        Call("Scene.cost", SCENE.cost, {"motion": Object(motion)}),
        Call("Scene.with_plant", SCENE.with_plant, {"plant": Object(ARM)}),
    ]


class _Rows(Array):
    """Rows of numbers, finite or not, as many as the others': a motion that has run away has its cost."""

    def bad(self) -> Pairs:
        """Other widths and types."""
        rows = ("NaN", "infinity", "minus infinity in a list", "one more", "one less", "a dimension more")
        yield from ((what, value) for what, value in Array.bad(self) if what not in rows)


def get_calls() -> list[Call]:
    """Of `scenes.get` and of the motion from rest to rest."""
    own = {"name": "single-link-slew"}
    return [
        Call("scenes.get", scenes.get, {"name": Choice("single-link-slew")}),
        Call(
            "scenes.get, fields",
            scenes.get,
            {"duration": Number(2.0, **POSITIVE), "substeps": Count(5), "limits": Array(np.array([20.0]))},
            own,
        ),
        Call("scenes.get, speed", scenes.get, {"speed": Number(4.0, **POSITIVE)}, {"name": "spin-up"}),
        Call("scenes.get, axis", scenes.get, {"axis": Choice("x")}, {"name": "spacecraft-spin"}),
        Call("scenes.get, rpm", scenes.get, {"rpm": Number(128.0, **POSITIVE)}, {"name": "slider-crank-run"}),
        Call("scenes.register", scenes.register, {"scene": Object(OWN), "replace": Flag(True)}, {"replace": True}),
        Call("check_scene", lambda **k: str(check_scene(**k)), {"scene": Object(OWN)}),
        Call("scenes.load", scenes.load, {"path": Place(FILE)}),
        Call("minimum_jerk", scenes.minimum_jerk, {"s": Array(np.array([0.0, 0.5, 1.0]), wrong=False, infinite=True)}),
        Call("minimum_jerk, a number", scenes.minimum_jerk, {"s": Number(0.5, infinite=True, array=True)}),
    ]
