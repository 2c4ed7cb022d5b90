"""A plant as a table of plain values, and the plant of such a table: the same in every number and word.

A table holds the fields of a dataclass, parts as tables of their own. `type` names the class where the field does not:
a plant's always. Where `make` is given, the class's own maker of that name (`textbook`, `rectangular`, ..) takes the
keys that it knows, and the rest replaces fields of what it made. Fields at their defaults are not written.

    [plant]
    type = "SingleLinkArm"
    link = {make = "rectangular", length = 1.0, width = 0.05, depth = 0.01, material = {type = "Material", ...}}
    hub_inertia = 1.3
"""

from __future__ import annotations

import dataclasses
import inspect
import re
import sys
from collections.abc import Mapping
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import (
    as_number,
    require_choice,
    require_flag,
    require_instance,
    require_mapping,
    require_number,
    require_text,
    shown,
)
from pliant.plants.dynamics.plant import Plant

from .plant_types import named

MAKERS = ("textbook", "rectangular", "circular", "tube", "boom", "panel", "rigid", "from_participation")
WORDS = {"float": "a number", "int": "an integer", "bool": "true or false", "str": "words"}


def to_table(plant: Any) -> dict[str, Any]:
    """A plant as a table. ValueError for a field that is no number, word or part, as an expression."""
    require_instance("to_table.plant", plant, Plant)
    return {"type": type(plant).__name__, **_fields("plant", plant)}


def from_table(table: Any, owner: str = "plant") -> Plant:
    """The plant of a table; errors name the key below `owner`, its value and what it must be."""
    found = require_mapping(owner, table)
    if "type" not in found:
        raise ValueError(f"{owner} lacks type, must name the plant: type = 'SingleLinkArm'")
    kind = named(f"{owner}.type", found.pop("type"))
    return require_instance(owner, _made(owner, kind, found), Plant)


def _fields(path: str, value: Any) -> dict[str, Any]:
    """The fields of a dataclass that are not at their defaults."""
    found = {}
    for field in dataclasses.fields(value):
        own, place = getattr(value, field.name), f"{path}.{field.name}"
        if not field.init or _same(own, _default(field)):
            continue
        if own is None:
            raise ValueError(f"{place} = None cannot be written, must be the field's default")
        found[field.name] = _plain(place, own, _annotation(field))
    return found


def _plain(path: str, value: Any, annotation: str) -> Any:
    value = as_number(value)
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (tuple, list)):
        return [_plain(f"{path}[{i}]", part, annotation) for i, part in enumerate(value)]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        name = type(value).__name__
        implied = [word for word in _words(annotation) if word == name] and not re.search(r"\|(?! *None)", annotation)
        return ({} if implied else {"type": name}) | _fields(path, value)
    if isinstance(value, (bool, int, float, str)):
        return value
    raise ValueError(f"{path} = {shown(value)} cannot be written, must be a number, words or a part")


def _default(field: dataclasses.Field[Any]) -> Any:
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return field.default


def _same(a: Any, b: Any) -> bool:
    """Equal, of one type throughout: 0 is not 0.0 in what is printed."""
    if type(a) is not type(b) or isinstance(a, np.ndarray):
        return False
    if isinstance(a, tuple):
        return len(a) == len(b) and all(map(_same, a, b))
    return bool(a == b)


def _made(path: str, kind: type, table: Mapping[str, Any]) -> Any:
    """An object of a dataclass from its table."""
    given, maker = dict(table), None
    if "make" in given and "make" not in {f.name for f in dataclasses.fields(kind)}:
        own = [name for name in MAKERS if isinstance(inspect.getattr_static(kind, name, None), classmethod)]
        require_choice(path, "make", maker := given.pop("make"), own)
    known = {f.name: _annotation(f) for f in dataclasses.fields(kind) if f.init}
    try:
        if maker is None:
            _require_keys(path, kind, given, known)
            _require_all(path, kind, given)
            return kind(**{key: _read(f"{path}.{key}", kind, given[key], known[key]) for key in given})
        call = inspect.signature(getattr(kind, maker)).parameters
        takes = {name: str(p.annotation) for name, p in call.items()}
        _require_keys(path, kind, given, known | takes)
        missing = [n for n, p in call.items() if p.default is inspect.Parameter.empty and n not in given]
        if missing:
            raise ValueError(f"{path} lacks {', '.join(missing)}, must be given to make {maker!r}")
        keys = {key: _read(f"{path}.{key}", kind, given[key], (known | takes)[key]) for key in given}
        made = getattr(kind, maker)(**{key: value for key, value in keys.items() if key in takes})
        rest = {key: value for key, value in keys.items() if key not in takes}
        return dataclasses.replace(made, **rest) if rest else made
    except ValueError as refused:
        if str(refused).startswith(path):
            raise
        raise ValueError(f"{path}: {refused}") from refused
    except Exception as failed:  # whatever a class of another package raises
        raise ValueError(f"{path} = {shown(dict(table))} must make a {kind.__name__}: {failed}") from failed


def _require_keys(path: str, kind: type, given: Mapping[str, Any], known: Mapping[str, str]) -> None:
    for key, value in given.items():
        if key not in known:
            listed = ", ".join(name for name in known if name != "varied")
            raise ValueError(f"{path}.{key} = {shown(value)}: {kind.__name__} has no {key!r}, must be one of {listed}")


def _require_all(path: str, kind: type, given: Mapping[str, Any]) -> None:
    missing = [f.name for f in dataclasses.fields(kind) if f.init and _default(f) is dataclasses.MISSING]
    missing = [name for name in missing if name not in given]
    if missing:
        raise ValueError(f"{path} lacks {', '.join(missing)}, which a {kind.__name__} must have")


def _read(path: str, owner: type, value: Any, annotation: str) -> Any:
    """A value of a field of `owner`: tables become parts, lists tuples, the rest is what the annotation says."""
    if isinstance(value, Mapping):
        return _part(path, owner, value, annotation)
    if isinstance(value, list):
        return tuple(_read(f"{path}[{i}]", owner, part, annotation) for i, part in enumerate(value))
    if annotation in WORDS:
        return _of_kind(path, value, annotation)
    parts = _parts(owner, annotation)
    if parts and not any(word in annotation for word in ("float", "int", "str")):
        raise ValueError(f"{path} = {shown(value)} must be a table, a {' or a '.join(p.__name__ for p in parts)}")
    return value


def _of_kind(path: str, value: Any, annotation: str) -> Any:
    if annotation == "bool":
        return require_flag(path, value)
    if annotation == "str":
        return require_text(path, value, empty=True)
    number = require_number(path, value)
    if annotation == "int" and not isinstance(value, int):
        raise ValueError(f"{path} = {shown(value)} must be an integer")
    return value if annotation == "int" else number


def _part(path: str, owner: type, value: Mapping[str, Any], annotation: str) -> Any:
    given, parts = dict(value), _parts(owner, annotation)
    if "type" in given:
        name, spaces = given.pop("type"), _spaces(owner)
        kinds = [space[name] for space in spaces if isinstance(name, str) and _is_part(space.get(name))]
        if not kinds:
            known = ", ".join(dict.fromkeys(n for space in spaces for n, one in space.items() if _is_part(one)))
            raise ValueError(f"{path}.type = {shown(name)} must be one of {known}")
        return _made(path, kinds[0], given)
    if len(parts) != 1:
        words = " or ".join(part.__name__ for part in parts)
        must = f"must have a type, {words}" if parts else f"must be {WORDS.get(annotation, annotation)}, not a table"
        raise ValueError(f"{path} = {shown(dict(value))} {must}")
    return _made(path, parts[0], given)


def _is_part(kind: Any) -> bool:
    return isinstance(kind, type) and dataclasses.is_dataclass(kind) and not issubclass(kind, Plant)


def _parts(owner: type, annotation: str) -> list[type]:
    """The dataclasses that an annotation names, where its class is written."""
    found = [space[word] for word in _words(annotation) for space in _spaces(owner) if _is_part(space.get(word))]
    return list(dict.fromkeys(found))


def _spaces(owner: type) -> list[dict[str, Any]]:
    """Names that the modules of a class and of its bases know."""
    return [vars(sys.modules[kind.__module__]) for kind in owner.__mro__ if kind.__module__ in sys.modules]


def _annotation(field: dataclasses.Field[Any]) -> str:
    return field.type if isinstance(field.type, str) else getattr(field.type, "__name__", str(field.type))


def _words(annotation: str) -> list[str]:
    return re.findall(r"\w+", annotation)
