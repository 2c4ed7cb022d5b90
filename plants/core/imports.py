"""Imports of three kinds of their own: modules when they are first used, old names of modules, other packages' objects.

Late    `linalg.expm` imports scipy.linalg, which costs as much as half of `import pliant.plants` without it
serve   modules under the names that they had before the rooms: `pliant.plants.sensitivities` is
        `pliant.plants.integration.step_sensitivities`. The old name imports the same module object, with a
        DeprecationWarning that says the new one. A name that is now a room (`pliant.plants.linear`) is not served
        here: the room exports what the module did.
offered objects that installed packages name in their pyproject.toml under an entry point's group, listed without being
        imported; `loaded` imports the package of one
"""

from __future__ import annotations

import importlib
import importlib.abc
import importlib.util
import sys
import warnings
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import metadata
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any


class Late:
    """Stands for a module; the first attribute that is asked for imports it."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        if attribute.startswith("__"):  # copy, pickle and inspect ask; no reason to import
            raise AttributeError(attribute)
        found = getattr(importlib.import_module(self._name), attribute)
        setattr(self, attribute, found)
        return found


linalg = Late("scipy.linalg")


class _Moved(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds old names; the last finder asked, so that a module in its place always wins."""

    def __init__(self) -> None:
        self.places: dict[str, str] = {}
        self.specs: dict[str, ModuleSpec | None] = {}

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        return importlib.util.spec_from_loader(name, self) if name in self.places else None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        place = self.places[spec.name]
        warnings.warn(f"{spec.name} has moved: import {place}", DeprecationWarning, stacklevel=2)
        module = importlib.import_module(place)
        self.specs[place] = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """The module has run where it stands: it gets its own spec back."""
        module.__spec__ = self.specs[module.__name__]


_finder = _Moved()
sys.meta_path.append(_finder)


def serve(package: str, rooms: Mapping[str, str]) -> None:
    """Serve old names of a package. rooms: {room: "module old_name=new_name ..."}, room "" for the
    package itself."""
    for room, words in rooms.items():
        for word in words.split():
            old, _, new = word.partition("=")
            _finder.places[f"{package}.{old}"] = ".".join(part for part in (package, room, new or old) if part)


@cache
def offered(group: str) -> dict[str, metadata.EntryPoint]:
    """The entry points of a group by their names, of the packages that were installed at the first call."""
    return {entry.name: entry for entry in metadata.entry_points(group=group)}


def loaded(entry: metadata.EntryPoint, what: str) -> Any:
    """The object of an entry point. ValueError that says that `what` cannot be had, of which package, and why."""
    try:
        return entry.load()
    except Exception as error:  # whatever another package raises when it is imported
        package = entry.dist.name if entry.dist else entry.value
        raise ValueError(f"{what} of package {package!r} cannot be had: {error}") from error
