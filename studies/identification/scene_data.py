"""A scene's plant identified from CSV files, and the result written as text, picture and JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pliant.envs.scenes.scene import Scene
from pliant.plants import Experiment, identify, read_experiment
from pliant.plants.core.parameters import require_choice
from pliant.plants.files.atomic_files import Together
from pliant.plants.identification.identification import Identification
from pliant.studies.common.atomic_files import dumps
from pliant.studies.figures.style import save

from .residual_plot import residual_plot

STARTS = ("scene", "rest", "unknown")
NAMES = ("identification.txt", "identification.json", "residuals.png")


def motions_from(
    scene: Scene, paths: Sequence[Path], start: str = "scene", hold: str = "zero-order"
) -> list[Experiment]:
    """The experiments in CSV files. start: "scene", at the scene's own start; "rest", at the plant's rest state;
    "unknown", near the scene's, and estimated with the parameters.
    """
    require_choice("motions_from", "start", start, STARTS)
    x0 = None if start == "rest" else scene.initial[0]
    unknown: Any = "all" if start == "unknown" else ()
    return [read_experiment(scene.plant, path, start=x0, unknown=unknown, hold=hold) for path in paths]


def of_scene(
    scene: Scene, paths: Sequence[Path], parameters: Sequence[str], *, start: str, hold: str, **options: Any
) -> Identification:
    """The named parameters of a scene's plant from CSV files; options are those of `identify`."""
    plant = scene.plant.vary(*parameters)
    return identify(plant, motions_from(scene, paths, start, hold), **options)


def table(scene: Scene, paths: Sequence[Path], found: Identification) -> dict[str, Any]:
    """The result with what it was found from."""
    files = [str(path) for path in paths]
    return {"scene": scene.name, "plant": scene.plant.label, "files": files, **found.table()}


def write(folder: Path, scene: Scene, paths: Sequence[Path], found: Identification) -> None:
    """identification.txt, identification.json and residuals.png, all of one result, in a folder that is made."""
    folder.mkdir(parents=True, exist_ok=True)
    with Together() as files:
        files.text(folder / NAMES[0], found.summary() + "\n")
        files.text(folder / NAMES[1], dumps(table(scene, paths, found)) + "\n")
        save(residual_plot(found), folder / NAMES[2], files)


def numbers(option: str, given: Sequence[str], count: int) -> Mapping[str, Any]:
    """{name: number}, or pairs low:high of them, from words NAME=VALUE. ValueError for others."""
    found: dict[str, Any] = {}
    for word in given:
        name, equals, text = word.partition("=")
        try:
            values = tuple(float(part) for part in text.split(":"))
        except ValueError:
            values = ()
        if not (equals and name and len(values) == count):
            raise ValueError(f"{option} {word[:100]!r} must be NAME={'VALUE' if count == 1 else 'LOW:HIGH'}")
        found[name] = values[0] if count == 1 else values
    return found
