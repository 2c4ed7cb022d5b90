"""The figures of the source papers."""

from .registry import draw, write

__all__ = ["draw", "write"]
