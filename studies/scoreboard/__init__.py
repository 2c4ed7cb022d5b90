"""Every controller on every scene beside the full-information bound."""

from .scoreboard import Scoreboard, scoreboard

__all__ = ["Scoreboard", "scoreboard"]
