"""A scene as tables of plain values, and the scene of such tables: the same in every number and word.

name, about          words; the name a-z, 0-9 and "-"
base                 a scene that this one changes: its name, or {name = .., its own keywords}
plant                in its place, or in the base's: a table, see plants/tables/plant_tables.py
parameters           of the plant, by dotted names: "payload.mass" = 0.7
start, goal, ..      tables of numbers by the names of signals; limits by inputs, or a list in their order
randomise            by dotted names, [least, greatest factor]
motion               the nominal inputs, see motions.py
what a Scene has     duration, dt, substeps, move_time, tolerance, observe, compare, ..
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from pliant.envs.scenes import registry
from pliant.envs.scenes.checks import ALLOWED
from pliant.envs.scenes.scene import Scene
from pliant.plants.core import parameters
from pliant.plants.core.argument_gates import (
    require_instance,
    require_mapping,
    require_number,
    require_text,
    shown,
)
from pliant.plants.core.signals import names
from pliant.plants.dynamics.plant import Plant
from pliant.plants.tables import plant_tables

from .motions import motion_of, motion_table

PAIRS = tuple(ALLOWED)  # tables of numbers by the names of signals
NAMES, FLAGS = ("observe", "compare"), ("start_at_rest", "goal_at_rest")
NUMBERS = ("duration", "dt", "substeps", "move_time", "start_spread", "tolerance")
OWN = ("name", "about", "base", "plant", "parameters", "motion")
KEYS = (*OWN, *NUMBERS, *FLAGS, *NAMES, *PAIRS, "limits", "randomise")


def to_tables(scene: Scene) -> dict[str, Any]:
    """A scene as tables. ValueError for a drive or a plant that no file can hold."""
    require_instance("to_tables.scene", scene, Scene)
    defaults = {f.name: f.default for f in dataclasses.fields(Scene)}
    found: dict[str, Any] = {"name": scene.name, "about": scene.about}
    for key in (*NUMBERS, *FLAGS, *NAMES):
        value = getattr(scene, key)
        if value != defaults[key]:
            found[key] = list(value) if isinstance(value, tuple) else value
    found["limits"] = dict(zip(names(scene.plant.inputs), scene.limits))
    if scene.drive is not None:
        found["motion"] = motion_table(scene.drive)
    for key in PAIRS:
        value = getattr(scene, key)
        if value or (key == "nominal_start" and value is not None):
            found[key] = dict(value)
    if scene.randomise:
        found["randomise"] = {path: [low, high] for path, low, high in scene.randomise}
    return found | {"plant": plant_tables.to_table(scene.plant)}


def from_tables(tables: Any) -> Scene:
    """The scene of tables. ValueError that names the key, its value and what it must be."""
    given = require_mapping("scene", tables)
    for key, value in given.items():
        if key not in KEYS:
            raise ValueError(f"{key} = {shown(value)}: a scene has no {key!r}, must be one of {', '.join(KEYS)}")
    if "name" not in given:
        raise ValueError("lacks name, must say what the scene is called: name = 'crane-swing'")
    name = registry.require_name("name", given["name"])
    base = _base(given["base"]) if "base" in given else None
    plant = _plant(given, base)
    fields: dict[str, Any] = {"name": name, "plant": plant}
    if "about" in given:
        fields["about"] = require_text("about", given["about"], empty=True)
    fields |= {key: _value(plant, key, given[key]) for key in given if key not in OWN}
    if "motion" in given:
        fields["drive"] = motion_of("motion", given["motion"])
    if base is not None:
        return dataclasses.replace(base, **fields)
    if missing := [key for key in ("duration", "limits") if key not in given]:
        raise ValueError(f"lacks {', '.join(missing)}, which a scene without a base must have")
    return Scene(**{"about": "", "start": (), "goal": ()} | fields)


def _base(value: Any) -> Scene:
    """The scene that a file changes, by name, with keywords of its own."""
    given = dict(value) if isinstance(value, Mapping) else {"name": value}
    name = given.pop("name", None)
    if not isinstance(name, str) or name not in registry.names():
        raise ValueError(f"base = {shown(value)} must be one of {', '.join(registry.names())}")
    own = registry.keywords(name)
    for key, one in given.items():
        if key not in own:
            raise ValueError(f"base.{key} = {shown(one)}: must be one of {', '.join(own) or '(there are none)'}")
    try:
        return registry.get(name, **given)
    except ValueError as refused:
        raise ValueError(f"base: {refused}") from None


def _plant(given: Mapping[str, Any], base: Scene | None) -> Plant:
    """The plant of the file or of the base, with the file's parameters."""
    if "plant" in given:
        plant = plant_tables.from_table(given["plant"], "plant")
    elif base is None:
        raise ValueError("lacks plant, must be a table with a type; or base, the name of a scene")
    else:
        plant = base.plant
    for path, value in require_mapping("parameters", given.get("parameters", {})).items():
        plant = put(plant, path, value)
    return plant


def put(plant: Plant, path: str, value: Any, owner: str = "parameters.") -> Plant:
    """The plant with the parameter at a dotted name. ValueError that names it, its value and what it must be."""
    name = f"{owner}{path}"
    try:
        before = parameters.get(plant, path)
    except ValueError as unknown:
        raise ValueError(f"{name} = {shown(value)} must be a parameter of the plant: {unknown}") from None
    if isinstance(before, float) and not isinstance(value, list):
        value = require_number(name, value)
    try:
        return parameters.put(plant, path, tuple(value) if isinstance(value, list) else value)
    except (ValueError, TypeError) as refused:
        raise ValueError(f"{name} = {shown(value)}: {refused}") from None


def _value(plant: Plant, key: str, value: Any) -> Any:
    """A field of a scene from what a file holds."""
    if key in PAIRS:
        return tuple(require_mapping(key, _numbers(plant, key, value)).items())
    if key == "limits" and isinstance(value, Mapping):
        inputs = names(plant.inputs)
        given = _known(key, value, inputs, "input")
        if missing := [name for name in inputs if name not in given]:
            raise ValueError(f"limits = {shown(dict(value))} lacks {', '.join(missing)}, must have a number for each")
        return tuple(given[name] for name in inputs)
    if key == "randomise":
        rows = require_mapping(key, value)
        for path, row in rows.items():
            if not isinstance(row, list) or len(row) != 2:
                raise ValueError(f"randomise.{path} = {shown(row)} must be [least, greatest factor]")
            try:
                parameters.unit_of(plant, path)
            except ValueError as unknown:
                raise ValueError(f"randomise.{path} = {row} must name a parameter: {unknown}") from None
        return tuple((path, *row) for path, row in rows.items())
    if key in NAMES and not isinstance(value, list):
        raise ValueError(f"{key} = {shown(value)} must be a list of names")
    if key in FLAGS and not isinstance(value, bool):
        raise ValueError(f"{key} = {shown(value)} must be true or false")
    if key in NUMBERS:
        require_number(key, value, "finite" if key in ("start_spread", "substeps") else "positive")
    return tuple(value) if isinstance(value, list) else value


def _numbers(plant: Plant, key: str, value: Any) -> dict[str, Any]:
    """Numbers by the names of signals, each within its range."""
    kinds = {"effort": plant.inputs, "gusts": plant.disturbances, "goal_rates": plant.states}
    kinds["nominal_start"] = plant.states
    given = _known(key, value, names(kinds.get(key, plant.states + plant.outputs)), "signal")
    for name, number in given.items():
        require_number(f"{key}.{name}", number, ALLOWED[key])
    return given


def _known(key: str, value: Any, known: tuple[str, ...], kind: str) -> dict[str, Any]:
    given = require_mapping(key, value)
    for name, number in given.items():
        if name not in known:
            listed = ", ".join(known) or "(there are none)"
            raise ValueError(f"{key}.{name} = {shown(number)}: no such {kind}, must be one of {listed}")
    return given
