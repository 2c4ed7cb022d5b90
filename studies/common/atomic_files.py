"""Folders that are written whole or not at all."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

MARK = "report.json"  # a folder that holds this is a former report


def check_target(folder: Path) -> None:
    """ValueError unless the folder is absent, empty or a former report."""
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise ValueError(f"out = {str(folder)!r} must be a folder, or not exist yet")
    if folder.is_dir() and any(folder.iterdir()) and not (folder / MARK).is_file():
        raise ValueError(
            f"out = {str(folder)!r} holds other files: it must be absent, empty or a former report ({MARK})"
        )


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """A temporary folder beside `folder` to write into; it takes the folder's place when all went well."""
    check_target(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    made = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        yield made
        made.chmod(0o777 & ~_umask())
        check_target(folder)
        if folder.exists():
            former = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
            os.replace(folder, former / "former")
            os.replace(made, folder)
            shutil.rmtree(former)
        else:
            os.replace(made, folder)
    finally:
        shutil.rmtree(made, ignore_errors=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


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
    """Write JSON text and a line end."""
    path.write_text(dumps(value) + "\n", encoding="utf-8")
