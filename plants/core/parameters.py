"""Physical parameters as dataclass fields that know their unit and range, reached by dotted names.

`quantity("kg", "positive")` declares a field; `validate(self)` in `__post_init__` checks every declared field;
`get(obj, "payload.mass")` and `put(obj, "payload.mass", 0.5)` follow dotted names through nested dataclasses and
tuples ("hub_inertia.0"). A CasADi expression passes unchecked: that is how a parameter becomes a symbol.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple, TypeVar

import casadi as ca
import numpy as np

from .argument_gates import (  # noqa: F401 -- the gates stand here too, as they did
    LARGEST,
    LEAST,
    LONGEST,
    RANGES,
    SHORTEST,
    nested,
    require_choice,
    require_count,
    require_finite,
    require_flag,
    require_instance,
    require_number,
    require_parts,
    require_seconds,
    shown,
)
from .errors import PliantError

T = TypeVar("T")


def quantity(
    unit: str,
    allowed: str = "finite",
    default: Any = dataclasses.MISSING,
    *,
    uncertain: bool = False,
    shape: tuple[int, ...] | None = None,
    or_shape: tuple[int, ...] | None = None,
    fixed: str = "",
) -> Any:
    """A dataclass field for a number in `unit` and within RANGES[allowed], or for a tuple of `shape` of them.

    -1 in a shape is any length; None: a number, or any length where the field is annotated as a tuple. `or_shape`:
    another that is taken too. `uncertain`: a robustness study may vary it, as
    payloads, stiffnesses and damping. `fixed`: why it is no parameter that may be varied, as "is a part of a unit
    vector"; "" where it may be.
    """
    told = {"unit": unit, "allowed": allowed, "uncertain": uncertain, "fixed": fixed}
    told |= {"shape": shape, "or_shape": or_shape}
    return dataclasses.field(default=default, metadata=told)


def part(kind: type, **default: Any) -> Any:
    """A dataclass field for an object of `kind`, which `validate` checks; `default` or `default_factory` as `field`."""
    return dataclasses.field(metadata={"gate": lambda name, value: require_instance(name, value, kind)}, **default)


def flag(default: bool) -> Any:
    """A dataclass field for True or False, which `validate` checks."""
    return dataclasses.field(default=default, metadata={"gate": require_flag})


def is_symbolic(value: object) -> bool:
    """Whether a value is a CasADi expression."""
    return isinstance(value, (ca.SX, ca.MX))


def validate(obj: Any) -> None:
    """Raise ValueError naming field, value and range for the first bad quantity() field of a dataclass.

    Lists and arrays become tuples, numbers of any type floats. A field with metadata "gate" becomes gate(name, value).
    """
    made: Any = type(obj)
    for name, gate, told in _plan(made):
        value = getattr(obj, name)
        if gate is not None:
            object.__setattr__(obj, name, gate(f"{type(obj).__name__}.{name}", value))
        if told is None or (type(value) is float and told.fits(value)):
            continue  # as most are, at little cost
        found = _checked(f"{type(obj).__name__}.{name}", nested(getattr(obj, name)), told)
        object.__setattr__(obj, name, found)
    for path in getattr(obj, "varied", ()):
        unit_of(obj, path)


class _Quantity(NamedTuple):
    """What a quantity() field must be."""

    unit: str
    allowed: str
    holds: Callable[[float], bool]
    shapes: tuple[tuple[int, ...], ...]
    one: bool  # whether it may be one number

    def fits(self, value: float) -> bool:
        return self.one and self.holds(value) and (value == 0 or LEAST <= abs(value) <= LARGEST)

    @classmethod
    def of(cls, field: dataclasses.Field[Any]) -> _Quantity:
        told = field.metadata
        own, other = told["shape"], told["or_shape"]
        if own is None:
            own = (-1,) if "tuple" in str(field.type) else ()
        shapes = (own,) if other is None else (own, other)
        return cls(told["unit"], told["allowed"], RANGES[told["allowed"]][1], shapes, () in shapes)


@cache
def _plan(made: type) -> tuple[tuple[str, Callable[..., Any] | None, _Quantity | None], ...]:
    """(name, gate, quantity) of the fields of a dataclass that have one of them."""
    return tuple(
        (f.name, f.metadata.get("gate"), _Quantity.of(f) if "allowed" in f.metadata else None)
        for f in dataclasses.fields(made)
        if "gate" in f.metadata or "allowed" in f.metadata
    )


def _checked(name: str, value: Any, told: _Quantity) -> Any:
    if not any(_has_shape(value, shape) for shape in told.shapes):
        text = " or ".join(_in_words(shape) for shape in told.shapes)
        each = "" if told.allowed == "finite" else f", each {RANGES[told.allowed][0]}"
        raise ValueError(f"{name} = {shown(value)} must be {text}{each} [{told.unit}]")
    return _entries(name, value, told.allowed, told.unit)


def _entries(name: str, value: Any, allowed: str, unit: str) -> Any:
    """Floats and symbols, in tuples as they came."""
    if isinstance(value, tuple):
        return tuple(_entries(f"{name}[{i}]", item, allowed, unit) for i, item in enumerate(value))
    return number_or_symbol(name, value, allowed, unit)


def number_or_symbol(name: str, value: Any, allowed: str = "finite", unit: str = "1") -> Any:
    """`value` as a float, or the one symbol that it is; ValueError for anything else."""
    if not is_symbolic(value):
        return require_number(name, value, allowed, unit)
    if value.numel() != 1:
        raise ValueError(f"{name} = {shown(value)} has shape {value.shape}, must be one number or one symbol [{unit}]")
    return value


def _has_shape(value: Any, shape: tuple[int, ...]) -> bool:
    if not shape:
        return not isinstance(value, tuple)
    fits = isinstance(value, tuple) and shape[0] in (-1, len(value))
    return fits and all(_has_shape(item, shape[1:]) for item in value)


def _in_words(shape: tuple[int, ...]) -> str:
    if len(shape) == 1:
        return {-1: "a tuple of numbers", 2: "two numbers", 3: "three numbers"}.get(shape[0], f"{shape[0]} numbers")
    return " x ".join(map(str, shape)) if shape else "a number"


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


def least_parameters(plant: Any) -> np.ndarray:
    """What the varied parameters of a plant must not be below, (np,): 0, or LEAST where it must be more, and -inf.

    The plant itself is asked: what it takes with a positive value in a place, and not with that value's negative.
    """
    kept: dict[str, Any] = plant.__dict__
    if "_least_parameters" not in kept:
        kept["_least_parameters"] = np.array([_least(plant, path) for path in plant.varied], dtype=float)
    return np.asarray(kept["_least_parameters"])


def _least(plant: Any, path: str) -> float:
    plain = dataclasses.replace(plant, varied=())

    def taken(value: float) -> bool:
        try:
            put(plain, path, value)
        except (ValueError, PliantError):
            return False
        return True

    size = abs(get(plain, path)) or 1.0
    if taken(-size) or not taken(size):
        return -np.inf
    return 0.0 if taken(0.0) else LEAST


def require_allowed(name: str, values: np.ndarray, plant: Any) -> None:
    """ValueError where one of the values (.., np) of a plant's varied parameters is below the least that it takes.

    What is no number is left to others to tell.
    """
    if not values.size:
        return
    least = least_parameters(plant)
    if (values < least).any():
        where = tuple(int(i) for i in np.argwhere(values < least)[0])
        signal = plant.parameters[where[-1]]
        text = RANGES["positive" if least[where[-1]] > 0 else "nonnegative"][0]
        raise ValueError(f"{name}{list(where)} ({signal.name}) = {values[where]:g} must be {text} [{signal.unit}]")


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
