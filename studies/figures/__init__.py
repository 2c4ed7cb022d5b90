"""Every picture, by what it shows, in one style. Importing the room loads no matplotlib."""

from .controllers import controllers
from .ladder import effects, ladder, settings
from .linear_models import eigenvalues, frozen
from .motion import histories, strobe_in_space, stroboscopic, tip_path
from .speed_accuracy import speed_accuracy
from .stability import evidence
from .style import inline, save

__all__ = [
    "controllers",
    "effects",
    "eigenvalues",
    "evidence",
    "frozen",
    "histories",
    "inline",
    "ladder",
    "save",
    "settings",
    "speed_accuracy",
    "strobe_in_space",
    "stroboscopic",
    "tip_path",
]
