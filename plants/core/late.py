"""Modules that are imported when they are first used: `linalg.expm` imports scipy.linalg, which costs a third of what
`import pliant.plants` costs without it.
"""

from __future__ import annotations

import importlib
from typing import Any


class Late:
    """Stands for a module; the first attribute that is asked for imports it."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        if attribute.startswith("__"):  # copy, pickle and inspect ask; no reason to import
            raise AttributeError(attribute)
        found = getattr(importlib.import_module(self._name), attribute)
        setattr(self, attribute, found)
        return found


linalg = Late("scipy.linalg")
