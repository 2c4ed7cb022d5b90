"""The gates that arguments pass: what is no real number, no count, no name or of another type is refused in words.

    real_array, finite_array, require_finite   numbers of any layout and real type, as float64; of one shape
    require_number, require_seconds            one number within a range
    require_count, require_counts              an integer within a range, a tuple of them
    require_choice, require_flag, require_all  one of a few values, a tuple of objects of a type
    require_names, require_text, require_path  distinct names, words, a file or a folder
    as_tuple, in_order, unit_vector            a tuple from what is meant as one
    require_by_name, require_mapping           numbers by name, anything by name

Each raises ValueError with the name of the argument, its value and what it must be.
"""

from __future__ import annotations

import math
import numbers
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Set
from typing import Any, TypeVar

import numpy as np

from pliant.plants.files.atomic_files import require_path  # noqa: F401 -- stands with what opens files

T = TypeVar("T")
UNORDERED = (str, bytes, bytearray, memoryview, Mapping, Set, type)
RANGES = {
    "positive": ("> 0", lambda v: v > 0),
    "nonnegative": (">= 0", lambda v: v >= 0),
    "finite": ("a finite number", lambda v: True),
}
SHORTEST, LONGEST = 1e-15, 1e9  # [s] between which a step of a machine lies
LARGEST_ENTRY = 1e150  # of an array: squares are finite
LEAST, LARGEST = 1e-75, 1e75  # sizes of one number: fourth powers are finite; what has to be > 0 is not below
BYTES = ("b", "B", "c")  # formats of memory that holds no numbers
DEEPEST, SHOWN = 8, 120  # lists in lists; characters of a value in a message


def shown(value: Any) -> str:
    """A value as a message shows it, in one line of limited length."""
    try:
        text = " ".join(repr(value).split())
    except Exception:
        text = f"<{type(value).__name__}>"
    return text if len(text) <= SHOWN else text[: SHOWN - 3] + "..."


def real_array(name: str, value: Any) -> np.ndarray:
    """`value` as float64; ValueError unless it is real numbers: no strings, objects, complex or masked ones."""
    if type(value) is np.ndarray and value.dtype == np.float64 and value.dtype.isnative:
        return value
    try:
        array = None if isinstance(value, bytearray) else np.asarray(value)
    except Exception:  # whatever an object's own __array__, __len__ or __getitem__ raises
        array = None
    if array is None or (isinstance(value, memoryview) and value.format in BYTES):
        raise ValueError(f"{name} = {shown(value)} must be an array of real numbers, rows of one length") from None
    if np.ma.is_masked(value):
        raise ValueError(f"{name} has {np.ma.count_masked(value)} masked entries, must be real numbers")
    if array.dtype.kind == "O" and array.size and all(_real(item) for item in array.flat):
        try:
            return array.astype(float)
        except OverflowError:
            raise ValueError(f"{name} = {shown(value)} is beyond what a float holds") from None
    if array.dtype.kind not in "fiub":
        raise ValueError(f"{name} = {shown(value)} must be an array of real numbers, has {_kind(array)}")
    return np.asarray(array, dtype=np.float64)


def require_finite(name: str, value: Any, shape: tuple[int, ...]) -> Any:
    """`value` as a float array; ValueError unless it has `shape` (-1: any length), is finite, at most LARGEST_ENTRY."""
    array = real_array(name, value)
    if array.ndim != len(shape) or any(want not in (-1, have) for want, have in zip(shape, array.shape)):
        raise ValueError(f"{name} has shape {array.shape}, must be {shape}")
    if not np.all(np.abs(array) <= LARGEST_ENTRY):
        where = tuple(int(i) for i in np.argwhere(~(np.abs(array) <= LARGEST_ENTRY))[0])
        most = f"at most {LARGEST_ENTRY:g} in size" if np.isfinite(array[where]) else "finite"
        raise ValueError(f"{name}{list(where)} = {array[where]} must be {most}")
    return array


def finite_array(name: str, value: Any) -> np.ndarray:
    """`value` as a float array of any shape, finite."""
    return np.asarray(require_finite(name, array := real_array(name, value), array.shape))


def as_number(value: Any) -> Any:
    """A number as Python has it, of a NumPy scalar or an array or tensor without dimensions; what is none stays."""
    if isinstance(value, np.generic) or (isinstance(value, np.ndarray) and value.ndim == 0):
        return value if value.dtype.kind in "mM" else value.item()  # a date that is none would be None
    if type(value).__module__ == "torch" and getattr(value, "ndim", None) == 0:
        return value.item()
    return value


def require_number(
    name: str, value: Any, allowed: str = "finite", unit: str = "1", *, least: float = -math.inf, most: float = math.inf
) -> float:
    """`value` as a float; ValueError unless it is one number, finite, within RANGES[allowed] and [least, most]."""
    text, holds = RANGES[allowed]
    small = LEAST if allowed == "positive" else 0.0
    if type(value) is float and holds(value) and least <= value <= most and small <= abs(value) <= LARGEST:
        return value
    value = as_number(value)
    if math.isfinite(least):
        text = f"within [{least:g}, {most:g}]" if math.isfinite(most) else f"at least {least:g}"
    elif math.isfinite(most):
        text = f"{text} and at most {most:g}" if allowed != "finite" else f"at most {most:g}"
    unit = "" if unit == "1" else f" [{unit}]"
    if not _real(value):
        raise ValueError(f"{name} = {shown(value)} must be {'' if text[0] == 'a' else 'a number '}{text}{unit}")
    finite = -sys.float_info.max <= value <= sys.float_info.max
    if not (finite and holds(value) and least <= value <= most):
        raise ValueError(f"{name} = {shown(value)} must be {text}{unit}")
    if not small <= abs(value) <= LARGEST:
        sizes = f"of a size from {small:g} to {LARGEST:g}" if small else f"at most {LARGEST:g} in size"
        raise ValueError(f"{name} = {shown(value)} must be {text}{unit}, {sizes}")
    return float(value)


def require_count(owner: str, name: str, value: Any, lowest: int, highest: float) -> int:
    """`value` as an int; ValueError unless it is an integer within [lowest, highest]."""
    value = as_number(value)
    if not (isinstance(value, numbers.Integral) and _real(value) and lowest <= int(value) <= highest):
        raise ValueError(f"{owner}.{name} = {shown(value)} must be an integer from {lowest} to {highest}")
    return int(value)


def require_counts(
    owner: str, name: str, value: Any, lowest: int, highest: int, *, length: int | None = None
) -> tuple[int, ...]:
    """A tuple of integers within [lowest, highest], `length` of them where that is given; else each once."""
    found = as_tuple(f"{owner}.{name}", value)
    if length is not None and len(found) != length:
        raise ValueError(f"{owner}.{name} = {shown(found)} must be {length} integers")
    counts = tuple(require_count(owner, f"{name}[{i}]", item, lowest, highest) for i, item in enumerate(found))
    if length is None and len(set(counts)) != len(counts):
        raise ValueError(f"{owner}.{name} = {shown(counts)} must name each once")
    return counts


def require_seconds(name: str, value: Any, least: float = 0.0, most: float = LARGEST) -> float:
    """`value` as a float [s]; ValueError unless it is a finite number > 0 and within [least, most]."""
    value = as_number(value)
    if not (_real(value) and 0 < value <= sys.float_info.max):
        raise ValueError(f"{name} = {shown(value)} must be > 0 [s]")
    if not least <= value <= most:
        raise ValueError(f"{name} = {shown(value)} must be from {least:g} to {most:g} [s]")
    return float(value)


def require_parts(name: str, part: float, whole: float, most: int, what: str) -> None:
    """ValueError where parts [s] of a time [s] are more than `most`; `what` they are, in words."""
    count = whole / part if whole < part * sys.float_info.max else math.inf
    if count > most:
        raise ValueError(
            f"{name} = {part:.6g} s makes {count:.3g} {what} of the {whole:.6g} s of t, at most {most:,} are taken"
        )


def require_choice(owner: str, name: str, value: Any, choices: Collection[Any]) -> None:
    """Raise ValueError unless value is among choices."""
    alike = (c for c in choices if isinstance(value, type(c)) and isinstance(value, bool) == isinstance(c, bool))
    if not any(value == c for c in alike):
        raise ValueError(f"{owner}.{name} = {shown(value)} must be one of {', '.join(map(repr, choices))}")


def require_flag(name: str, value: Any) -> bool:
    """`value` as a bool; ValueError unless it is True or False."""
    value = as_number(value)
    if not isinstance(value, bool):
        raise ValueError(f"{name} = {shown(value)} must be True or False")
    return value


def require_instance(name: str, value: T, kind: type, *, what: str = "") -> T:
    """`value` itself; ValueError unless it is of `kind`; `what` tells it in words where the type's name does not."""
    if not isinstance(value, kind):
        word = what or kind.__name__
        an = "an" if word[0] in "AEIOUaeiou" else "a"
        raise ValueError(f"{name} = {shown(value)} must be {an} {word}, not {_type(value)}")
    return value


def require_names(
    name: str, value: Any, known: Collection[str] | None = None, kind: str = "name", *, repeated: bool = False
) -> tuple[str, ...]:
    """`value` as a tuple of strings, distinct unless `repeated`; ValueError for a bare string or one not `known`."""
    found = in_order(name, value, "a tuple of names")
    for i, item in enumerate(found):
        if not isinstance(item, str):
            raise ValueError(f"{name}[{i}] = {shown(item)} must be a string")
        if known is not None and item not in known:
            raise ValueError(f"{name}[{i}] = {item!r}: no such {kind}; choose from {', '.join(known) or '(none)'}")
    if not repeated and len(set(found)) != len(found):
        raise ValueError(f"{name} = {shown(found)} must be distinct names")
    return tuple(map(str, found))


def in_order(name: str, value: Any, what: str) -> tuple[Any, ...]:
    """A tuple of what has an order: no word or set, no 0-d array, no expression, no iterator that fails."""
    if isinstance(value, Iterable) and not isinstance(value, UNORDERED):
        try:
            return tuple(value)
        except Exception as error:
            raise ValueError(f"{name} = {shown(value)} must be {what}") from error
    raise ValueError(f"{name} = {shown(value)} must be {what}")


def as_tuple(name: str, value: Any) -> tuple[Any, ...]:
    """A tuple of a tuple, list, range or array (one dimension); ValueError for anything else."""
    if isinstance(value, np.ndarray) and value.ndim == 1:
        return tuple(value.tolist())
    if not isinstance(value, (tuple, list, range)):
        raise ValueError(f"{name} = {shown(value)} must be a tuple, not {_type(value)}")
    return tuple(value)


def unit_vector(name: str, value: Any) -> tuple[float, ...]:
    """Three numbers of length 1 as a tuple; ValueError for anything else."""
    found = require_finite(name, value, (3,))
    if not abs(np.linalg.norm(found) - 1) < 1e-9:
        raise ValueError(f"{name} = {shown(value)} must be a unit vector of three numbers")
    return tuple(found.tolist())


def require_all(name: str, value: Any, kind: type) -> tuple[Any, ...]:
    """A tuple of objects of `kind`, from a tuple or a list of them."""
    found = as_tuple(name, value)
    for i, item in enumerate(found):
        require_instance(f"{name}[{i}]", item, kind)
    return found


def require_by_name(
    name: str, value: Any, known: Collection[str] | None = None, kind: str = "name", allowed: str = "finite"
) -> dict[str, float]:
    """Numbers within RANGES[allowed] by name, as a dict; `known`: names that there are, each a `kind`."""
    found = require_mapping(name, value, known, kind)
    return {key: require_number(f"{name}[{key!r}]", number, allowed) for key, number in found.items()}


def require_mapping(name: str, value: Any, known: Collection[str] | None = None, kind: str = "name") -> dict[str, Any]:
    """Anything by name, as a dict; ValueError where it is no mapping, or a name is not `known`."""
    if not isinstance(value, Mapping):
        raise ValueError(f"{name} = {shown(value)} must be values by name, not {_type(value)}")
    try:
        found = dict(value)
    except Exception as error:
        raise ValueError(f"{name} = {shown(value)} must be values by name") from error
    for key in found:
        if not isinstance(key, str):
            raise ValueError(f"{name} has the key {shown(key)}, must be names")
        if known is not None and key not in known:
            raise ValueError(f"{name}: {kind} {key!r} must be one of {', '.join(known) or '(there are none)'}")
    return {str(key): one for key, one in found.items()}


def require_text(name: str, value: Any, *, empty: bool = False) -> str:
    """`value` as a str; ValueError unless it is words, `empty` where none are words too."""
    if not isinstance(value, str) or not (value or empty):
        raise ValueError(f"{name} = {shown(value)} must be words")
    return str(value)


def require_function(name: str, value: Any) -> Callable[..., Any]:
    """`value` itself; ValueError unless it can be called."""
    if not callable(value):
        raise ValueError(f"{name} = {shown(value)} must be a function, not {_type(value)}")
    return value


def nested(value: Any, depth: int = DEEPEST) -> Any:
    """Lists, tuples and arrays as tuples of Python's numbers, `depth` deep; anything else as it is."""
    if isinstance(value, np.ndarray) and value.ndim:
        value = value.tolist()
    if isinstance(value, (list, tuple)) and depth:
        return tuple(nested(item, depth - 1) for item in value)
    return as_number(value)


def _real(value: Any) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, (bool, np.timedelta64))


def _type(value: Any) -> str:
    return f"the class {value.__name__}" if isinstance(value, type) else type(value).__name__


def _kind(array: np.ndarray) -> str:
    words = {"U": "strings", "S": "bytes", "c": "complex numbers", "O": "objects", "M": "dates", "m": "durations"}
    return words.get(array.dtype.kind, str(array.dtype))
