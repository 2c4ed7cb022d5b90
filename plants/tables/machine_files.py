"""A machine that comes as a file of its own: a robot's URDF, or the TOML that a tree of bodies is kept in."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from pliant.plants.core.argument_gates import require_path
from pliant.plants.files import toml_text
from pliant.plants.multibody.tree import FlexibleTree

ROBOT, TABLE = ".urdf", ".toml"


def is_machine(path: Any) -> bool:
    """Whether this names a file that holds a machine and not a scene: a URDF, or a TOML with `bodies` of its own.

    >>> is_machine("two-link-reach"), is_machine("panda.urdf")
    (False, True)
    """
    if not isinstance(path, (str, os.PathLike)):
        return False
    ending = Path(path).suffix.lower()
    if ending == TABLE and Path(path).is_file():
        return "bodies" in toml_text.load("machine", Path(path))
    return ending == ROBOT


def read(path: Any) -> FlexibleTree:
    """The machine of a file, every link of a URDF rigid. ValueError: the file, the element or key, and its value.

    >>> arm = read("arm.urdf")
    """
    file = require_path("machine", path)
    return (FlexibleTree.from_urdf if file.suffix.lower() == ROBOT else FlexibleTree.from_toml)(file)
