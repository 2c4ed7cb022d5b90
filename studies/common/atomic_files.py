"""What a study writes: JSON tables and report folders, each by the writer of plants/files."""

from __future__ import annotations

import json
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants.files import atomic_files, whole_folders

MARK = "report.json"  # a folder that holds this is a former report


def check_target(folder: Path) -> None:
    """ValueError unless the folder is absent, empty or a former report."""
    whole_folders.check_target(folder, MARK)


def whole_folder(folder: Path) -> AbstractContextManager[Path]:
    """A temporary folder beside `folder` to write into; it takes the folder's place when all went well."""
    return whole_folders.whole_folder(folder, MARK)


def plain(value: Any) -> Any:
    """A value as JSON knows it: arrays as lists, complex numbers as [re, im], what is not finite as None."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if np.isfinite(value) else None
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    return value


def dumps(value: Any) -> str:
    """JSON text, strict: no NaN."""
    return json.dumps(plain(value), indent=1, allow_nan=False)


def write_json(path: Path, value: Any) -> None:
    """Write JSON text and a line end: the whole file, or what was there before. OSError, which names it."""
    atomic_files.write_text(path, dumps(value) + "\n")
