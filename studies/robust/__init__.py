"""Laws made to survive: detuned or designed again until no vertex of a box fails, and what that costs."""

from .robustify import Robustified, robustify

__all__ = ["Robustified", "robustify"]
