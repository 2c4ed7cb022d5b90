"""Speed against accuracy, the choice of a model, sources of error, stiffening, the number of modes."""

from typing import TYPE_CHECKING

from pliant.plants.core import imports

if TYPE_CHECKING:  # imported when they are first asked for
    from .choice import Choice, choose
    from .error_sources import ErrorSources, error_sources
    from .mode_count import ModeCount, ModesNeeded, modes_needed
    from .speed_accuracy import Chart, Row
    from .stiffening import Stiffening, stiffening_needed

__all__ = [
    "Chart",
    "Choice",
    "ErrorSources",
    "ModeCount",
    "ModesNeeded",
    "Row",
    "Stiffening",
    "choose",
    "error_sources",
    "modes_needed",
    "stiffening_needed",
]

imports.offer(
    __name__,
    {
        "choice": "Choice choose",
        "error_sources": "ErrorSources error_sources",
        "mode_count": "ModeCount ModesNeeded modes_needed",
        "speed_accuracy": "Chart Row",
        "stiffening": "Stiffening stiffening_needed",
    },
)
