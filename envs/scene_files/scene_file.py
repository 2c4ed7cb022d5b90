"""Scene files: a scene read from TOML and written to it."""

from __future__ import annotations

import os
from typing import Any

from pliant.envs.scenes.scene import Scene
from pliant.plants.files import toml_text
from pliant.plants.files.atomic_files import write_text

from .scene_tables import from_tables, to_tables


def load(path: Any) -> Scene:
    """The scene of a file. ValueError in one line: the file, the key, its value, what it must be; OSError where it
    cannot be read.

    Example
    -------
    >>> import tempfile
    >>> from pliant.envs import scenes
    >>> file = tempfile.mkdtemp() + "/slew.toml"
    >>> save(scenes.get("single-link-slew"), file)
    >>> load(file).name
    'single-link-slew'
    """
    tables = toml_text.load("scene file", path)
    try:
        return from_tables(tables)
    except ValueError as refused:
        raise ValueError(f"scene file: {os.fspath(path)!r} {' '.join(str(refused).split())}") from refused


def text(scene: Scene) -> str:
    """The scene as TOML. ValueError for what no file can hold: a function of one's own as drive, an expression.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> text(scenes.get("single-link-slew")).splitlines()[0]
    '# single-link-slew: turn a steel link with a 1 kg payload by one radian, rest to rest'
    """
    return toml_text.dumps(to_tables(scene), f"{scene.name}: {scene.about}")


def save(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Write the scene's file, whole or as it was before. Errors as `text`; OSError, which names the file.

    Example
    -------
    >>> import tempfile
    >>> from pliant.envs import scenes
    >>> save(scenes.get("single-link-slew"), tempfile.mkdtemp() + "/slew.toml")
    """
    write_text(path, text(scene))
