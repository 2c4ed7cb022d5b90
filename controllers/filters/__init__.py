"""Notch and roll-off filters, continuous or sampled, in series with a controller."""

from .filter import Filter
from .filtered import Filtered
from .shapes import lag, notch, roll_off

__all__ = ["Filter", "Filtered", "lag", "notch", "roll_off"]
