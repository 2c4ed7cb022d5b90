"""The clock that limits are told by: processor time, which other programs on the machine do not shorten."""

from __future__ import annotations

from pliant.plants.motions.time_limit import processor_time

__all__ = ["processor_time"]
