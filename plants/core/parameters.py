"""Physical parameters as dataclass fields that know their unit and range, reached by dotted names.

`quantity("kg", "positive")` declares a field; `validate(self)` in `__post_init__` checks every declared field;
`get(obj, "payload.mass")` and `put(obj, "payload.mass", 0.5)` follow dotted names through nested dataclasses and
tuples ("hub_inertia.0"). A CasADi expression passes unchecked: that is how a parameter becomes a symbol.
"""

from __future__ import annotations

import dataclasses
import math
import numbers
import sys
from collections.abc import Collection
from typing import Any, TypeVar

import casadi as ca
import numpy as np

T = TypeVar("T")

RANGES = {
    "positive": ("> 0", lambda v: v > 0),
    "nonnegative": (">= 0", lambda v: v >= 0),
    "finite": ("a finite number", lambda v: True),
}


def quantity(
    unit: str,
    allowed: str = "finite",
    default: Any = dataclasses.MISSING,
    *,
    uncertain: bool = False,
    fixed: str = "",
) -> Any:
    """A dataclass field for a float, or a tuple of floats, in `unit` and within RANGES[allowed].

    `uncertain`: a robustness study may vary it, as payloads, stiffnesses and damping. `fixed`: why it is no parameter
    that may be varied, as "is a part of a unit vector"; "" where it may be.
    """
    about = {"unit": unit, "allowed": allowed, "uncertain": uncertain, "fixed": fixed}
    return dataclasses.field(default=default, metadata=about)


def is_symbolic(value: object) -> bool:
    """Whether a value is a CasADi expression."""
    return isinstance(value, (ca.SX, ca.MX))


def _check(name: str, value: Any, unit: str, allowed: str) -> None:
    if is_symbolic(value):
        return
    if isinstance(value, (tuple, list)):
        for i, item in enumerate(value):
            _check(f"{name}[{i}]", item, unit, allowed)
        return
    text, holds = RANGES[allowed]
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise ValueError(f"{name} = {value!r} must be a number {text} [{unit}]")
    if not (math.isfinite(value) and holds(value)):
        raise ValueError(f"{name} = {value!r} must be {text} [{unit}]")


def validate(obj: Any) -> None:
    """Raise ValueError naming field, value and range for the first bad quantity() field of a dataclass."""
    for field in dataclasses.fields(obj):
        if "allowed" in field.metadata:
            value = getattr(obj, field.name)
            _check(f"{type(obj).__name__}.{field.name}", value, field.metadata["unit"], field.metadata["allowed"])


def require_choice(owner: str, name: str, value: object, choices: Collection[Any]) -> None:
    """Raise ValueError unless value is among choices."""
    if value not in choices:
        raise ValueError(f"{owner}.{name} = {value!r} must be one of {', '.join(map(repr, choices))}")


def require_count(owner: str, name: str, value: object, lowest: int, highest: int) -> None:
    """Raise ValueError unless value is an integer within [lowest, highest]."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral) or not lowest <= int(value) <= highest:
        raise ValueError(f"{owner}.{name} = {value!r} must be an integer from {lowest} to {highest}")


SHORTEST, LONGEST = 1e-15, 1e9  # [s] between which a step of a machine lies


def require_seconds(name: str, value: Any, least: float = 0.0, most: float = math.inf) -> float:
    """`value` as a float [s]; ValueError unless it is a finite number > 0 and within [least, most]."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    number = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if not (number and 0 < value <= sys.float_info.max):
        raise ValueError(f"{name} = {value!r} must be > 0 [s]")
    if not least <= value <= most:
        raise ValueError(f"{name} = {value!r} must be from {least:g} to {most:g} [s]")
    return float(value)


def require_parts(name: str, part: float, whole: float, most: int, what: str) -> None:
    """ValueError where parts [s] of a time [s] are more than `most`; `what` they are, in words."""
    count = whole / part if whole < part * sys.float_info.max else math.inf
    if count > most:
        raise ValueError(
            f"{name} = {part:.6g} s makes {count:.3g} {what} of the {whole:.6g} s of t, at most {most:,} are taken"
        )


def require_finite(name: str, value: Any, shape: tuple[int, ...]) -> Any:
    """`value` as a float array; ValueError unless it has `shape` and is finite (a single -1 means any length)."""
    array = np.asarray(value, dtype=float)
    if array.ndim != len(shape) or any(want not in (-1, have) for want, have in zip(shape, array.shape)):
        raise ValueError(f"{name} has shape {array.shape}, must be {shape}")
    if not np.all(np.isfinite(array)):
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"{name}{list(where)} = {array[where]} must be finite")
    return array


def _step(obj: Any, key: str, path: str) -> Any:
    if isinstance(obj, tuple) and key.isdigit() and int(key) < len(obj):
        return obj[int(key)]
    if dataclasses.is_dataclass(obj) and key in {f.name for f in dataclasses.fields(obj)}:
        return getattr(obj, key)
    names = quantities(obj) if dataclasses.is_dataclass(obj) else ()
    known = f"it has {', '.join(names)}" if names else f"it holds {len(obj)}" if isinstance(obj, tuple) else "no parts"
    raise ValueError(f"parameter {path!r}: {type(obj).__name__} has no {key!r}; {known}")


def get(obj: Any, path: str) -> Any:
    """The parameter at a dotted path."""
    for key in path.split("."):
        obj = _step(obj, key, path)
    return obj


def put(obj: T, path: str, value: Any) -> T:
    """A copy of a frozen dataclass (or tuple) with the parameter at a dotted path replaced."""
    key, _, rest = path.partition(".")
    inner = _step(obj, key, path)
    new = put(inner, rest, value) if rest else value
    if isinstance(obj, tuple):
        return (*obj[: int(key)], new, *obj[int(key) + 1 :])  # type: ignore[return-value]
    return dataclasses.replace(obj, **{key: new})  # type: ignore[type-var]


def unit_of(obj: Any, path: str) -> str:
    """The unit of the parameter at a dotted path; ValueError if it is not a physical quantity, or a fixed one."""
    value, unit = obj, None
    for key in path.split("."):
        inner = _step(value, key, path)
        if dataclasses.is_dataclass(value):
            about = next(f for f in dataclasses.fields(value) if f.name == key).metadata
            if about.get("fixed"):
                raise ValueError(f"parameter {path!r} cannot be varied: it {about['fixed']}")
            unit = about.get("unit")
        value = inner
    if unit is None:
        raise ValueError(f"parameter {path!r} is not a physical quantity; choose from {', '.join(quantities(obj))}")
    return str(unit)


def quantities(obj: Any, prefix: str = "", *, uncertain: bool = False) -> tuple[str, ...]:
    """Dotted names of the physical quantities of a dataclass that are not fixed, one for each number, nested ones
    included; `uncertain`: those marked so.
    """
    found: list[str] = []
    for field in dataclasses.fields(obj):
        value, about = getattr(obj, field.name), field.metadata
        if about.get("fixed") or ("unit" in about and uncertain and not about.get("uncertain")):
            continue
        found += _names(value, prefix + field.name, uncertain, "unit" in about)
    return tuple(found)


def _names(value: Any, path: str, uncertain: bool, inside: bool) -> list[str]:
    """Of a field's value, `inside` a quantity or not."""
    if isinstance(value, tuple):
        return [name for i, part in enumerate(value) for name in _names(part, f"{path}.{i}", uncertain, inside)]
    if inside:
        return [path]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return list(quantities(value, f"{path}.", uncertain=uncertain))
    return []
