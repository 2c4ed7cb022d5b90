"""What a scene's fields must be: names that its plant knows, numbers within their ranges, rests that there are."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants import EquilibriumError, Plant
from pliant.plants.core.argument_gates import (
    as_number,
    as_tuple,
    real_array,
    require_count,
    require_flag,
    require_function,
    require_instance,
    require_names,
    require_number,
    require_text,
    shown,
)
from pliant.plants.core.errors import unstable_rests_untold
from pliant.plants.core.parameters import unit_of
from pliant.plants.dynamics.equilibrium import with_joints

if TYPE_CHECKING:
    from .scene import Manoeuvre, Scene

ALLOWED = {  # of the numbers in pairs (name, number)
    "start": "finite",
    "goal": "finite",
    "nominal_start": "finite",
    "goal_rates": "finite",
    "spreads": "nonnegative",
    "bounds": "positive",
    "weights": "nonnegative",
    "effort": "positive",
    "gusts": "nonnegative",
}
NUMBERS = ("duration", "dt", "move_time", "start_spread", "tolerance")
OF_STATES = ("start", "goal", "nominal_start", "goal_rates")
OF_INPUTS = ("effort", "gusts")  # which all variants share
LARGEST = 10_000_000  # control periods of an episode


def checked(scene: Scene) -> dict[str, Any]:
    """The fields as they are kept, tuples of Python's numbers; ValueError naming the scene, the field and the value."""
    owner = f"scene {require_text('Scene.name', scene.name)!r}"
    require_text("Scene.about", scene.about, empty=True)
    plant = require_instance("Scene.plant", scene.plant, Plant)
    for name in NUMBERS:  # which no symbol may stand for
        require_number(f"{owner}: {name}", getattr(scene, name))
    found: dict[str, Any] = {}
    found["substeps"] = _substeps(owner, scene.substeps)
    if not scene.duration < LARGEST * scene.dt:
        raise ValueError(f"{owner}: duration = {scene.duration} s must be less than {LARGEST:,} dt = {scene.dt} s")
    if scene.duration < scene.dt * (1 - 1e-9):
        raise ValueError(f"{owner}: duration = {scene.duration} s must be at least dt = {scene.dt} s")
    for name in ("start_at_rest", "goal_at_rest"):
        found[name] = require_flag(f"Scene.{name}", getattr(scene, name))
    if scene.drive is not None:
        require_function("Scene.drive", scene.drive)
    found["limits"] = _limits(owner, scene)
    states, known = (tuple(s.name for s in signals) for signals in (plant.states, scene.signals))
    inputs, disturbances = (tuple(s.name for s in signals) for signals in (plant.inputs, plant.disturbances))
    of = dict.fromkeys(OF_STATES, states) | {"effort": inputs, "gusts": disturbances}
    for group in ALLOWED:
        if group != "nominal_start" or scene.nominal_start is not None:
            found[group] = _pairs(owner, group, getattr(scene, group), of.get(group, known))
    for group in ("observe", "compare"):
        found[group] = require_names(f"{owner}: {group}", getattr(scene, group), known, "signal", repeated=True)
    if not found["compare"]:
        raise ValueError(f"{owner}: compare = () must name one output at least")
    found["randomise"] = _randomised(owner, scene)
    _on_every_rung(owner, plant, found)
    return found


def rest_point(scene: Manoeuvre, field: str) -> tuple[np.ndarray, np.ndarray]:
    """(x, u) at the rest that the field "start" or "goal" names: joints that it does not name at zero, what no input
    drives in equilibrium. EquilibriumError, which names the field, where there is none.
    """
    plant, named = scene.plant, dict(getattr(scene, field))
    moving = {name: value for name, value in named.items() if name in plant.rates.values() and value}
    if moving:
        told = ", ".join(f"{name} = {value:g}" for name, value in moving.items())
        raise EquilibriumError(
            f"scene {scene.name!r}: [{field}] has {told}: rates are zero at rest, or say {field}_at_rest = false",
            max(map(abs, moving.values())),
        )
    try:
        with unstable_rests_untold():  # a controller is to hold it
            return plant.equilibrium(with_joints(plant, named))
    except EquilibriumError as none:
        held, n = [name for name in named if name in plant.rates], plant.nu
        joints = ", ".join(joint.position for joint in plant.joints)
        advice = f"name {n} at most" + (f", as {joints}" if joints else "")
        if len(held) <= n:
            advice = f"name others, or say {field}_at_rest = false"
        remains = str(none).partition(";")[0]
        raise EquilibriumError(
            f"scene {scene.name!r}: [{field}] names {len(held)} {'coordinate' if len(held) == 1 else 'coordinates'} "
            f"({', '.join(held) or 'none'}), of a plant with {n} {'input' if n == 1 else 'inputs'}: "
            f"{advice}; {remains}",
            none.residual,
        ) from none


@lru_cache(maxsize=64)  # making a ladder takes longer than a scene's other checks
def _signals_of_rungs(plant: Plant) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """(label, names of states and outputs) of each variant on the plant's ladder."""
    return tuple((rung.label, tuple(s.name for s in (*rung.states, *rung.outputs))) for rung in plant.ladder())


def _on_every_rung(owner: str, plant: Plant, found: dict[str, Any]) -> None:
    """ValueError for a name that a variant of the plant's ladder lacks: it could not play the scene.

    What is observed need not be on every one: a modal coordinate is not, and environments are of the scene's own plant.
    """
    signals = {group: [name for name, _ in found.get(group, ())] for group in ALLOWED if group not in OF_INPUTS}
    signals["compare"] = list(found["compare"])
    for label, known in _signals_of_rungs(plant):
        for group, wanted in signals.items():
            for name in wanted:
                if name not in known:
                    raise ValueError(
                        f"{owner}: {group} {name!r} is no signal of {label!r} on the ladder of {type(plant).__name__}, "
                        f"must be one of {', '.join(dict.fromkeys(known))}"
                    )


def rows(owner: str, **given: tuple[Any, int]) -> list[np.ndarray]:
    """Real numbers (.., size) of each name: (value, size), finite or not, as many rows in all of them.

    A motion that has run away is told by what it costs.
    """
    found: list[np.ndarray] = []
    for name, (value, size) in given.items():
        array = real_array(f"{owner}.{name}", value)
        first = found[0] if found else array
        if array.ndim < 1 or array.shape != (*first.shape[:-1], size):
            must = f"(.., {size})" if not found else str((*first.shape[:-1], size))
            raise ValueError(f"{owner}.{name} has shape {array.shape}, must be {must}")
        found.append(array)
    return found


def _substeps(owner: str, value: Any) -> int:
    try:
        return require_count("Scene", "substeps", value, 1, 1_000_000)
    except ValueError:
        raise ValueError(f"{owner}: substeps = {shown(value)} must be an integer >= 1, at most a million") from None


def _limits(owner: str, scene: Scene) -> tuple[float, ...]:
    given = as_tuple("Scene.limits", scene.limits)
    if len(given) != scene.plant.nu:
        raise ValueError(f"{owner}: limits = {shown(given)} must hold {scene.plant.nu} numbers > 0")
    each = zip(given, scene.plant.inputs)
    return tuple(
        _kept(value, require_number(f"Scene.limits[{i}]", value, "positive", s.unit))
        for i, (value, s) in enumerate(each)
    )


def _pairs(owner: str, group: str, value: Any, known: tuple[str, ...]) -> tuple[tuple[str, float], ...]:
    """Names and numbers."""
    found = []
    for i, pair in enumerate(as_tuple(f"{owner}: {group}", value)):
        if not isinstance(pair, (tuple, list)) or len(pair) != 2:
            raise ValueError(f"{owner}: {group}[{i}] = {shown(pair)} must be a pair (name, number)")
        name, number = pair
        if not isinstance(name, str) or name not in known:
            listed = ", ".join(dict.fromkeys(known)) or "(there are none)"
            raise ValueError(f"{owner}: {group} {shown(name)} must be one of {listed}")
        found.append((str(name), _kept(number, require_number(f"{owner}: {group} {name}", number, ALLOWED[group]))))
    if len({name for name, _ in found}) != len(found):
        raise ValueError(f"{owner}: {group} = {shown(tuple(found))} must name each signal once")
    return tuple(found)


def _randomised(owner: str, scene: Scene) -> tuple[tuple[str, float, float], ...]:
    found = []
    for i, row in enumerate(as_tuple(f"{owner}: randomise", scene.randomise)):
        if not isinstance(row, (tuple, list)) or len(row) != 3 or not isinstance(row[0], str):
            raise ValueError(f"{owner}: randomise[{i}] = {shown(row)} must be (parameter, least, greatest factor)")
        path = row[0]
        try:
            unit_of(scene.plant, path)
        except ValueError as unknown:
            raise ValueError(f"{owner}: randomise[{i}]: {unknown}") from None
        low, high = (_kept(v, require_number(f"{owner}: randomise {path}", v)) for v in row[1:])
        if not 0 < low <= high:
            raise ValueError(f"{owner}: randomise {path} from {low} to {high} must be 0 < low <= high")
        found.append((path, low, high))
    return tuple(found)


def _kept(given: Any, number: float) -> float:
    """A number as it was given where Python has it so: an integer stays one in what is printed."""
    plain = as_number(given)
    return plain if isinstance(plain, (int, float)) else number
