"""Motions from rest to rest compared: what each profile asks of the inputs and leaves swinging."""

from .comparison import Slew, compare_slews
from .picture import slews_picture

__all__ = ["Slew", "compare_slews", "slews_picture"]
