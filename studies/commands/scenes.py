"""`pliant scenes`, `new` and `check`: what there is to play, starts of one's own, whether a plant keeps its word."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from pliant.envs import environment_id
from pliant.envs import scenes as known
from pliant.envs.environments.scene_check import check_scene
from pliant.envs.scene_files.settings import with_settings
from pliant.envs.scene_files.starts import plant_start, scene_start
from pliant.envs.scenes.registry import VARIANTS, is_file
from pliant.envs.scenes.scene import Scene
from pliant.plants import check as checked
from pliant.plants.files.atomic_files import write_text
from pliant.plants.tables.plant_types import named
from pliant.studies.common.formatting import measured
from pliant.studies.report.json_tables import scene_table
from pliant.studies.scene_pages import tables

from .console import complain, listed, print_json, say, say_lines, show
from .options import AsJson, Settings


def scenes(
    name: Annotated[
        str | None, typer.Argument(help="One scene, or its file: print its page.", show_default=False)
    ] = None,
    settings: Settings = None,
    as_json: AsJson = False,
) -> None:
    """List the scenes: shipped, registered by --with, of installed packages; or print one's page.

    A page says what is observed, moved, priced, bounded and drawn, with units.
    """
    if name is not None:
        _page(with_settings(name, settings or []), as_json)
        return
    if settings:
        raise ValueError("scenes: --set must follow a scene's name or file")
    found, refused = [], []
    names = [own for name in known.names() for own in (name, *(v for v in VARIANTS if v.startswith(f"{name}-")))]
    for name in names:
        try:
            found.append(known.get(name))
        except ValueError as error:  # another package's
            refused.append(str(error))
    if as_json:
        print_json([scene_table(s) for s in found])
    else:
        _list(found)
    for reason in refused:
        complain(reason)


def _page(scene: Scene, as_json: bool) -> None:
    if as_json:
        print_json(
            scene_table(scene)
            | {table.about: [dict(zip(table.head, r)) for r in table.rows] for table in tables(scene)}
        )
        return
    say(f"{scene.name}: {scene.about}")
    for table in tables(scene):
        show(table.about, table.head, table.rows)


def _list(found: list[Scene]) -> None:
    entries = []
    for s in found:
        facts = (s.plant.label, f"{s.plant.nx} states", f"{s.duration:g} s")
        entries.append(
            ((s.name, environment_id(s.name)), s.about, (*facts, f"tolerance {measured(s.tolerance, s.unit)}"))
        )
    listed("Scenes", entries)


def new(
    kind: Annotated[Literal["plant", "scene"], typer.Argument(help="What to start.")],
    name: Annotated[str, typer.Argument(help="Its name: words of a-z and 0-9 joined by '-', as crane.")],
    base: Annotated[
        str,
        typer.Option(
            help="What a new scene changes: a scene, or its file; or what it is of: a robot's .urdf, a tree's .toml, a "
            "type of plants (Crane)."
        ),
    ] = "two-link-reach",
) -> None:
    """Write a commented start into this folder: a plant with its scene, or a scene that changes another."""
    files = plant_start(name) if kind == "plant" else scene_start(name, base)
    taken = [file for file in files if Path(file).exists()]
    if taken:
        raise ValueError(f"new {kind} {name}: {', '.join(taken)} must not be there yet")
    for file, text in files.items():
        write_text(file, text)
        print(file)


def check(
    plant: Annotated[str, typer.Argument(help="A plant's type (Crane), a scene's name or its file.")],
    settings: Settings = None,
) -> None:
    """Hold a plant's word against its equations: names, ladder, derivatives, energy; play a scene once."""
    if not (is_file(plant) or plant in known.names()):
        if settings:
            raise ValueError("check: --set must follow a scene's name or file")
        try:
            kind = named("check: plant", plant)
        except ValueError as unknown:
            raise ValueError(f"{unknown}; or a scene's file, or its name as `pliant scenes` lists it") from None
        say_lines(str(checked(kind())))
        return
    scene = with_settings(plant, settings or [])
    say_lines(str(checked(scene.plant)))
    say_lines(str(check_scene(scene)))
