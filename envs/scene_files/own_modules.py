"""A user's own Python file as a module: `pliant --with crane.py report crane.toml`."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

from pliant.plants.core.argument_gates import shown


def import_file(path: Path) -> None:
    """Run a file as the module of its name, so that what it makes also travels to other processes.

    ValueError where it is no Python file, has the name of a module that Python knows already, or fails.
    """
    place = path.resolve()
    if place.suffix != ".py" or not place.stem.isidentifier() or not place.is_file():
        raise ValueError(f"--with {str(path)!r} must be a Python file, its name an identifier: crane.py")
    loaded = sys.modules.get(place.stem)
    if loaded is not None and getattr(loaded, "__file__", None) == str(place):
        return
    if loaded is not None or place.stem in sys.stdlib_module_names:
        raise ValueError(f"--with {str(path)!r} must not have the name of another module, {place.stem!r}")
    sys.path.insert(0, str(place.parent))
    importlib.invalidate_caches()
    try:
        importlib.import_module(place.stem)
    except Exception as error:  # whatever the user's file raises
        raise ValueError(f"--with {str(path)!r} fails: {type(error).__name__}: {shown(str(error))}") from error
