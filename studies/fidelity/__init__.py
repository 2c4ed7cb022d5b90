"""Speed against accuracy, the choice of a model, stiffening, the number of modes."""

from .choice import Choice, choose
from .mode_count import ModeCount, ModesNeeded, modes_needed
from .speed_accuracy import Chart, Row
from .stiffening import Stiffening, stiffening_needed

__all__ = [
    "Chart",
    "Choice",
    "ModeCount",
    "ModesNeeded",
    "Row",
    "Stiffening",
    "choose",
    "modes_needed",
    "stiffening_needed",
]
