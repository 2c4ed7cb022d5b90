"""The report of a scene: a page, its figures and its tables."""

from .report import report

__all__ = ["report"]
