"""JSON objects with a checksum: what is read back is what was written, or a ValueError that names the file.

The entry "sha256" is over the other entries, in one order and without spaces: it does not feel how the text is laid
out. Files of version 0.1, which say no format, have none.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from typing import Any, NoReturn

from .atomic_files import require_path, write_text
from .sealed_arrays import NotOwnError, check_format, opened

SEAL = "sha256"


def dumps(value: Mapping[str, Any]) -> str:
    """Strict JSON text (no NaN) with its checksum and a line end."""
    plain = json.loads(json.dumps(dict(value), allow_nan=False))
    return json.dumps({**plain, SEAL: _digest(plain)}, indent=1, allow_nan=False) + "\n"


def save(path: str | os.PathLike[str], value: Mapping[str, Any]) -> None:
    """The whole file, or what was there before. OSError, which names `path`."""
    write_text(path, dumps(value))


def load(owner: str, path: Any, newest: int) -> dict[str, Any]:
    """What `save` wrote, "format" in it and the checksum taken out. ValueError as `sealed_arrays.load`.

    A file without "format" is one of version 0.1, format 1, which may have no checksum; later ones must have it.
    """
    path = require_path(f"{owner}: path", path)
    with opened(owner, path) as (file, _):
        value = json.loads(file.read().decode(), parse_constant=_refuse)
        if not isinstance(value, dict):
            raise NotOwnError(f"holds a {type(value).__name__}, must be a JSON object")
        seal = value.pop(SEAL, None)
        form = value.setdefault("format", 1)
        check_format(form, newest)
        if seal is None and form > 1:
            raise NotOwnError("has no checksum: it was edited or is damaged")
        if seal is not None and seal != _digest(value):
            raise NotOwnError("was edited or is damaged: its checksum is another")
        return value


def _digest(value: Mapping[str, Any]) -> str:
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def _refuse(word: str) -> NoReturn:
    raise NotOwnError(f"holds {word}, which is no number of JSON")
