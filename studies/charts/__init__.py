"""Speed against accuracy, measured: settings, runs, rows that are kept, pages."""

from typing import TYPE_CHECKING

from pliant.plants.core import imports

if TYPE_CHECKING:  # imported when they are first asked for
    from .measure import chart

__all__ = ["chart"]

imports.offer(
    __name__,
    {
        "measure": "chart",
    },
)
