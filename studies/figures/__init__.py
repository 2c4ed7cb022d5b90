"""Every picture, by what it shows, in one style. Importing the room loads no matplotlib."""

from typing import TYPE_CHECKING

from pliant.plants.core import imports

if TYPE_CHECKING:  # imported when they are first asked for
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

imports.offer(
    __name__,
    {
        "controllers": "controllers",
        "ladder": "effects ladder settings",
        "linear_models": "eigenvalues frozen",
        "motion": "histories strobe_in_space stroboscopic tip_path",
        "speed_accuracy": "speed_accuracy",
        "stability": "evidence",
        "style": "inline save",
    },
)
