"""Changing a scene by NAME=VALUE words: `--set goal.theta1=0.3 --set payload.mass=0.7 --set duration=5`."""

from __future__ import annotations

import ast
import dataclasses
from collections.abc import Sequence
from typing import Any

from pliant.envs.scenes import registry
from pliant.envs.scenes.checks import ALLOWED
from pliant.envs.scenes.scene import Scene
from pliant.plants.core import parameters
from pliant.plants.core.argument_gates import require_number, shown
from pliant.plants.core.signals import index

from .scene_tables import FLAGS, NAMES, NUMBERS, put

LONGEST_VALUE = 1000  # characters of a setting
FIELDS = ("about", *NUMBERS, *FLAGS, *NAMES, "limits")  # of one value


def with_settings(name: str, settings: Sequence[str]) -> Scene:
    """A scene, by name or by its file, with NAME=VALUE settings: keywords of its own, fields (duration, limits.tau1),
    numbers by the names of signals (goal.theta1), or parameters of its plant (payload.mass).

    ValueError for a scene, name or value that is not known or out of range.
    """
    parts = [setting.partition("=") for setting in settings]
    for setting, (path, equals, _) in zip(settings, parts):
        if not equals or not path:
            raise ValueError(f"--set {setting!r} must be NAME=VALUE")
    own = registry.keywords(name)
    given = {path: _value(path, text, own[path]) for path, _, text in parts if path in own}
    scene = registry.get(name, **given)
    for path, _, text in parts:
        if path not in own:
            scene = _changed(scene, path, text)
    return scene


def _changed(scene: Scene, path: str, text: str) -> Scene:
    group, _, rest = path.partition(".")
    if path in FIELDS:
        return _with(scene, path, _value(path, text, getattr(scene, path)))
    if rest and group in ALLOWED:
        pairs = dict(getattr(scene, group) or ())
        pairs[rest] = require_number(f"--set {path}", _value(path, text, 0.0), ALLOWED[group])
        return _with(scene, group, tuple(pairs.items()))
    if rest and group == "limits":
        limits = list(scene.limits)
        limits[index(scene.plant.inputs, rest, f"--set {path}={shown(text)}: input")] = _value(path, text, 0.0)
        return dataclasses.replace(scene, limits=tuple(limits))
    if rest and group == "randomise":
        rows: dict[str, Any] = {name: factors for name, *factors in scene.randomise}
        factors = _value(path, text, (1.0, 1.0))
        if not isinstance(factors, tuple) or len(factors) != 2:
            raise ValueError(f"--set {path}={text} must be two factors, [0.8,1.2]")
        rows[rest] = factors
        return _with(scene, "randomise", tuple((name, *row) for name, row in rows.items()))
    value = _value(path, text, parameters.get(scene.plant, path))
    return scene.with_plant(put(scene.plant, path, value, "--set "))


def _with(scene: Scene, field: str, value: Any) -> Scene:
    changed: dict[str, Any] = {field: value}
    return dataclasses.replace(scene, **changed)


def _value(path: str, text: str, before: Any) -> Any:
    """The text as a value of the kind that it replaces."""
    if isinstance(before, str):
        return text
    if len(text) > LONGEST_VALUE:
        raise ValueError(f"--set {path} has a value of {len(text)} characters, must be at most {LONGEST_VALUE}")
    if isinstance(before, bool) and text in ("true", "false"):
        return text == "true"
    try:
        value = ast.literal_eval(text)  # numbers, words and lists: no code
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        raise ValueError(f"--set {path}={text} must be a value like {before!r}") from None
    if isinstance(before, float) and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    if isinstance(before, tuple) and isinstance(value, list):
        return tuple(value)
    return value
