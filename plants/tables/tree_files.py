"""Trees of bodies as TOML files: the fields of `FlexibleTree`, its bodies a list of tables that hold those of their
joints and beams. Nothing in a file is executed.

    gravity = [0.0, 0.0, -9.81]

    [[bodies]]
    name = "link"
    joint = {name = "hub", axis = [0.0, 0.0, 1.0], damping = 0.1}
    beam = {make = "rectangular", length = 1.0, width = 0.05, depth = 0.005, material = {type = "Material", ...}}
    modes = [2, 0, 0, 0]
"""

from __future__ import annotations

import os
from typing import Any

from pliant.plants.core.argument_gates import require_path
from pliant.plants.files import toml_text
from pliant.plants.multibody.tree import FlexibleTree

from .plant_tables import from_table, to_table

HEAD = "A tree of bodies for pliant.plants.FlexibleTree.from_toml. SI units; fields at their defaults are left out."


def read_tree(kind: type[FlexibleTree], path: Any) -> FlexibleTree:
    """The tree of a file, of class `kind`. ValueError: the file, the key, its value and what it must be."""
    file = require_path("from_toml.path", path)
    table = toml_text.load("from_toml", file)
    try:
        made = from_table({"type": kind.__name__, **table}, "tree")
        if not isinstance(made, kind):
            raise ValueError(f"tree.type = {type(made).__name__!r} must be {kind.__name__!r}")
    except ValueError as refused:
        raise ValueError(f"from_toml: {os.fspath(file)!r} {refused}") from refused
    return made


def write_tree(tree: FlexibleTree, path: Any) -> None:
    """The whole file, or what was there before. ValueError for a field that is an expression."""
    toml_text.save(require_path("to_toml.path", path), to_table(tree), HEAD)
