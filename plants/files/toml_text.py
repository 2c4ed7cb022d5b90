"""TOML files: read by tomllib, every value looked at; written here, one key a line, numbers to the last bit.

What is read is data: nothing in a file names code, opens another file or is executed.
"""

from __future__ import annotations

import json
import math
import os
import re
import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

from .atomic_files import require_path, write_text
from .sealed_arrays import NotOwnError, opened

BARE = re.compile(r"[A-Za-z0-9_-]+")
LARGEST, DEEPEST, WIDTH, SHOWN = 16_000_000, 40, 110, 60  # bytes, tables in tables, characters of a line and of a value


def load(owner: str, path: Any) -> dict[str, Any]:
    """The tables of a TOML file. ValueError in one line: the file, the line or the key, its value, what it must be."""
    place = require_path(f"{owner}: path", path)
    with opened(owner, place) as (file, size):
        if size > LARGEST:
            raise NotOwnError(f"has {size} bytes, must have at most {LARGEST}")
        content = file.read()
        try:
            text = content.decode().removeprefix("\ufeff")  # what editors of one system put before it
        except UnicodeDecodeError as error:
            line = content.count(b"\n", 0, error.start) + 1
            raise NotOwnError(f"line {line}: byte {error.start} = {content[error.start]:#x} must be UTF-8") from None
        return loads(text)


def loads(text: str) -> dict[str, Any]:
    """As `load`, of a text; errors begin with the line or the key."""
    try:
        found = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise NotOwnError(_at_line(str(error), text)) from None
    except RecursionError:
        raise NotOwnError(f"has tables in tables, must be at most {DEEPEST} deep") from None
    except ValueError as error:  # a date that is none, an integer of thousands of digits
        raise NotOwnError(f"must be TOML: {str(error).splitlines()[0]}") from None
    _require_plain("", found, 0)
    return found


def save(path: str | os.PathLike[str], tables: Mapping[str, Any], head: str = "") -> None:
    """The whole file, or what was there before. OSError, which names `path`."""
    write_text(path, dumps(tables, head))


def dumps(tables: Mapping[str, Any], head: str = "") -> str:
    """TOML text of numbers, words, truths, and lists and tables of them; `head` comes before it as a comment."""
    comment = "".join(f"# {line}".rstrip() + "\n" for line in head.splitlines())
    return comment + "\n" * bool(comment) + "\n".join(_lines(tables, ())).strip("\n") + "\n"


def _at_line(message: str, text: str) -> str:
    """tomllib's words, with the line that it stopped at."""
    found = re.search(r"at line (\d+), column \d+", message)
    lines = text.splitlines()
    number = int(found[1]) if found else len(lines)
    line = lines[number - 1].strip() if 0 < number <= len(lines) else ""
    if len(line) > SHOWN:
        line = line[:SHOWN] + "..."
    return f"line {number}: {line!r} must be TOML: {message}"


def _require_plain(path: str, value: Any, depth: int) -> None:
    if depth > DEEPEST:
        raise NotOwnError(f"{path[:SHOWN]} has tables in tables, must be at most {DEEPEST} deep")
    if isinstance(value, Mapping):
        for key, part in value.items():
            _require_plain(f"{path}.{_key(key)}" if path else _key(key), part, depth + 1)
    elif isinstance(value, list):
        for i, part in enumerate(value):
            _require_plain(f"{path}[{i}]", part, depth + 1)
    elif not isinstance(value, (str, int, float)):
        raise NotOwnError(f"{path} = {value} must be a number, words, true or false, or a list or table of these")
    elif isinstance(value, float) and not math.isfinite(value):
        raise NotOwnError(f"{path} = {value} must be a finite number")


def _key(key: str) -> str:
    return key if BARE.fullmatch(key) else _words(key)


def _words(text: str) -> str:
    """A basic string; JSON's escapes are TOML's."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _lines(table: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    """First the values of a table, then its tables, so that each value stands under its own heading."""
    inner = []
    for key, value in table.items():
        if isinstance(value, Mapping) or _tables(value):
            inner.append((key, value))
        else:
            yield _wrapped(f"{_key(key)} = ", value)
    for key, value in inner:
        place = (*path, _key(key))
        parts = [value] if isinstance(value, Mapping) else value
        mark = ("[", "]") if isinstance(value, Mapping) else ("[[", "]]")
        for part in parts:
            yield f"\n{mark[0]}{'.'.join(place)}{mark[1]}"
            yield from _lines(part, place)


def _tables(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and bool(value) and all(isinstance(part, Mapping) for part in value)


def _wrapped(start: str, value: Any) -> str:
    """One line, or a list with as many entries a line as have room."""
    line = start + _value(value)
    if len(line) <= WIDTH or not isinstance(value, (list, tuple)):
        return line
    rows, row = [], ""
    for part in value:
        text = _value(part)
        if row and len(row) + len(text) + 6 > WIDTH:
            rows.append(row)
            row = ""
        row += (", " if row else "") + text
    return "\n".join([f"{start}[", *(f"    {row}," for row in [*rows, row]), "]"])


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"{value} cannot be written, must be a finite number")
        return repr(float(value))
    if isinstance(value, int):
        return str(int(value))
    if isinstance(value, str):
        return _words(value)
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_value, value))}]"
    raise ValueError(f"{value!r} cannot be written, must be a number, words, true or false, or a list of these")
