"""A file of JSON lines to which work is added row by row, so that a killed run loses at most the row it was making."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pliant.plants.files.atomic_files import write_text


def read_lines(path: Path | None) -> list[dict[str, Any]]:
    """Whole lines; one that was cut off leaves the file, and is done again. ValueError where a line is none of ours."""
    if path is None or not path.exists():
        return []
    try:
        *lines, rest = path.read_text(encoding="utf-8").split("\n")
        found = [json.loads(line) for line in lines if line]
    except ValueError as error:
        raise ValueError(f"{str(path)!r} is no file of rows kept: {error}") from None
    if not all(isinstance(row, dict) for row in found):
        raise ValueError(f"{str(path)!r} is no file of rows kept")
    if rest:
        write_text(path, "".join(line + "\n" for line in lines))
    return found


def add_line(path: Path, row: dict[str, Any]) -> None:
    """One row more."""
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")
