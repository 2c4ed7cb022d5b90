"""A scene's page as tables: what is observed, moved, priced, bounded and drawn, each with its unit."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from pliant.envs import environment_id
from pliant.envs.scenes import registry
from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import require_instance
from pliant.studies.common.formatting import measured

Cell = str | float
Row = tuple[Cell, ...]


@dataclass(frozen=True)
class Table:
    """Rows under their heads; what it shows, in a word or two."""

    about: str
    head: tuple[str, ...]
    rows: tuple[Row, ...]


def tables(scene: Scene) -> tuple[Table, ...]:
    """The tables of a scene that have a row; numbers in the signals' own units.

    ValueError where `scene` is none.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> [table.about for table in tables(scenes.get("single-link-slew"))]
    ['facts', 'observation', 'action', 'cost', 'ends beyond', 'drawn where randomised']
    """
    scene = require_instance("tables.scene", scene, Scene)
    found = (_facts(scene), _observation(scene), _action(scene), _cost(scene), _bounds(scene), _drawn(scene))
    return tuple(table for table in found if table.rows)


def _facts(scene: Scene) -> Table:
    plant = scene.plant
    registered = scene.name in (*registry.names(), *registry.VARIANTS) and registry.get(scene.name) == scene
    identified = environment_id(scene.name) if registered else "none; PlantEnv(scene) makes it"
    rows: list[Row] = [
        ("environment id", identified),
        ("plant", f"{type(plant).__name__}, {plant.label}"),
        ("states, inputs, outputs", f"{plant.nx}, {plant.nu}, {plant.ny}"),
        ("other fidelities", "; ".join(p.label for p in plant.ladder() if p.label != plant.label) or "none"),
        ("episode", f"{scene.duration:g} s: {scene.steps} control periods of {scene.dt:g} s"),
        ("integrated by", f"rk4, {scene.substeps} steps a control period"),
        ("tolerance of a model", f"{measured(scene.tolerance, scene.unit)} in {', '.join(scene.compare)}"),
    ]
    return Table("facts", ("what", "is"), tuple(rows))


def _observation(scene: Scene) -> Table:
    x, u = scene.initial
    start = scene.signal_values(x, scene.plant.measure(x, u), scene.observe)
    goal = scene.goal_values(scene.observe)
    return Table(
        "observation",
        ("signal, less its value at the goal", "unit", "at the start", "goal"),
        tuple(
            (name, unit, _told(a), _told(b)) for (name, unit), a, b in zip(_units(scene, scene.observe), start, goal)
        ),
    )


def _action(scene: Scene) -> Table:
    return Table(
        "action",
        ("input", "unit", "at -1", "at 1"),
        tuple((s.name, s.unit, -limit, limit) for s, limit in zip(scene.plant.inputs, scene.limits)),
    )


def _cost(scene: Scene) -> Table:
    units = {s.name: s.unit for s in (*scene.signals, *scene.plant.inputs)}
    priced = (*scene.weights, *scene.effort)
    return Table(
        "cost",
        ("deviation in", "unit", "weight of its square [1/s per unit^2]"),
        tuple((name, units[name], weight) for name, weight in priced),
    )


def _bounds(scene: Scene) -> Table:
    return Table(
        "ends beyond",
        ("signal", "unit", "largest size"),
        tuple((name, unit, bound) for (name, unit), (_, bound) in zip(_units(scene, dict(scene.bounds)), scene.bounds)),
    )


def _drawn(scene: Scene) -> Table:
    units = {s.name: s.unit for s in (*scene.signals, *scene.plant.disturbances)}
    rows: list[Row] = [(path, "", f"{low:g} to {high:g} times") for path, low, high in scene.randomise]
    spreads = zip(scene.start, scene.spread)
    rows += [(f"start of {name}", units[name], f"within {size:g}") for (name, _), size in spreads if size]
    rows += [(f"constant {name}", units[name], f"within {size:g}") for name, size in scene.gusts]
    return Table("drawn where randomised", ("what", "unit", "range, uniform"), tuple(rows))


def _units(scene: Scene, chosen: Iterable[str]) -> list[tuple[str, str]]:
    units = {s.name: s.unit for s in scene.signals}
    return [(name, units[name]) for name in chosen]


def _told(value: float) -> float:
    """Rounded to what the page shows, so that a rest point's rounding is not read as a number."""
    return float(np.round(value, 6)) + 0.0
