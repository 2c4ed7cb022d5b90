"""Imports of four kinds of their own: modules when they are first used, a package's names when they are first asked
for, old names of modules, other packages' objects.

Late    `linalg.expm` imports scipy.linalg, which costs as much as half of `import pliant.plants` without it
offer   names of a package, from modules of its rooms: `from pliant.studies import chart` imports what measures,
        `import pliant.studies` does not
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


class _Offering(ModuleType):
    """A package some of whose names come from modules that are imported when the name is first asked for.

    A room of such a name (pliant.studies.report) does not take its place when something imports the room.
    """

    _offers: Mapping[str, str] = {}  # {name: "module:object" or "module", behind the package's own name}

    def __setattr__(self, name: str, value: Any) -> None:
        room = isinstance(value, ModuleType) and value.__name__ == f"{self.__name__}.{name}"
        if not (room and ":" in self._offers.get(name, "")):
            super().__setattr__(name, value)

    def __getattr__(self, name: str) -> Any:
        if name not in self._offers:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        module, _, inner = self._offers[name].partition(":")
        found: Any = importlib.import_module(f"{self.__name__}.{module}")
        if inner:
            found = getattr(found, inner)
        super().__setattr__(name, found)
        return found

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._offers})


def offer(package: str, names: Mapping[str, str]) -> None:
    """Names of a package from modules that are imported when a name is first asked for (as PEP 562 has it).

    names: {module, behind the package's name: "name other=object ..."}; "" for modules of the package: "riccati
    rl=learning". Where a name differs from what the module calls it, "name=object".
    """
    places = {}
    for module, words in names.items():
        for word in words.split():
            name, _, inner = word.partition("=")
            places[name] = f"{module}:{inner or name}" if module else inner or name
    own = sys.modules[package]
    own.__class__ = _Offering
    vars(own)["_offers"] = places


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
