"""Types of plants by name: those that are shipped, those that were registered, those of installed packages.

A package names its plants in its pyproject.toml,

    [project.entry-points."pliant.plants"]
    Crane = "cranes.crane:Crane"

and is imported when the first of them is asked for.
"""

from __future__ import annotations

import dataclasses
from typing import TypeVar

from pliant.plants.arms.single_link import SingleLinkArm
from pliant.plants.arms.two_link import TwoLinkArm
from pliant.plants.core.argument_gates import require_text, shown
from pliant.plants.core.imports import loaded, offered
from pliant.plants.dynamics.plant import Plant
from pliant.plants.large_deflection.large_beam import LargeDeflectionBeam
from pliant.plants.multibody.tree import FlexibleTree
from pliant.plants.slider_crank.plant import SliderCrank
from pliant.plants.spacecraft.plant import FlexibleSpacecraft

P = TypeVar("P", bound=type)
GROUP = "pliant.plants"
SHIPPED: dict[str, type[Plant]] = {
    kind.__name__: kind
    for kind in (SingleLinkArm, TwoLinkArm, LargeDeflectionBeam, FlexibleTree, SliderCrank, FlexibleSpacecraft)
}
_registered: dict[str, type[Plant]] = {}


def register(kind: P) -> P:
    """Let scene files name a type of plants by its class's name; a class decorator. Registering it again replaces it.

    ValueError unless it is a dataclass that is a Plant, of a name that no shipped plant has.

    Example
    -------
    >>> @register
    ... @dataclasses.dataclass(frozen=True, kw_only=True)
    ... class Pointer(SingleLinkArm):
    ...     colour: str = "blue"
    >>> "Pointer" in names()
    True
    """
    found = _require_kind("register: kind", kind)
    if found.__name__ in SHIPPED:
        raise ValueError(f"register: kind = {shown(kind)} must have a name of its own, not that of a shipped plant")
    _registered[found.__name__] = found
    return kind


def _require_kind(name: str, kind: object) -> type[Plant]:
    if not (isinstance(kind, type) and issubclass(kind, Plant) and dataclasses.is_dataclass(kind)):
        raise ValueError(f"{name} = {shown(kind)} must be a class, a dataclass derived from Plant")
    return kind


def names() -> tuple[str, ...]:
    """The names of all types of plants that are known, those of installed packages among them."""
    return tuple(dict.fromkeys((*SHIPPED, *_registered, *offered(GROUP))))


def named(owner: str, name: str) -> type[Plant]:
    """The type of plants called `name`. ValueError that lists the names, or says why a package's cannot be had."""
    require_text(f"{owner}", name)
    if name in SHIPPED:
        return SHIPPED[name]
    if name in _registered:
        return _registered[name]
    if name not in offered(GROUP):
        raise ValueError(
            f"{owner} = {shown(name)} must be one of {', '.join(names())}, or registered: `pliant --with FILE.py` runs "
            "a file of your own first"
        )
    what = f"{owner} = {shown(name)}"
    kind = _require_kind(f"{what}: entry point {GROUP} {name}", loaded(offered(GROUP)[name], what))
    if kind.__name__ != name:
        raise ValueError(f"{owner} = {shown(name)} is the class {kind.__name__}, must have the name of its class")
    _registered[name] = kind
    return kind
