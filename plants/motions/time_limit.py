"""A limit of processor time for what is done inside: motions, on the virtual machine and in compiled code, stop at it.

    with time_limit(2.0):
        plant.simulate(...)  # TooLong after 2 s of processor time, whatever it is doing

Processor time is what other programs on the machine do not shorten. Of limits inside each other the first to end holds.
A long motion asks after every step on the virtual machine and after ASKED steps of compiled code; nothing is compiled
that is expected to take longer than is left.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from pliant.plants.core.errors import PliantError

ASKED = 10_000  # steps of one native call at most, under a limit
_ends: ContextVar[float | None] = ContextVar("processor time at which it ends", default=None)


class TooLong(PliantError):
    """What was given up when its time was over."""


def processor_time() -> float:
    """[s] of this thread, and of programs that it waited for, as a compiler."""
    took = os.times()
    return time.thread_time() + took.children_user + took.children_system


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """What this thread, or task, does inside ends after so many seconds [s] of processor time; inf sets no limit."""
    outer, own = _ends.get(), processor_time() + seconds
    before = _ends.set(min(own if outer is None else min(own, outer), 1e300))
    try:
        yield
    finally:
        _ends.reset(before)


def time_left() -> float:
    """[s] until the limit; inf where there is none."""
    ends = _ends.get()
    return math.inf if ends is None else ends - processor_time()


def limited() -> bool:
    """Whether there is one."""
    return _ends.get() is not None


def check_time(t: float | None = None) -> None:
    """TooLong where the time is over; t [s]: how far the motion has come."""
    ends = _ends.get()
    if ends is not None and processor_time() > ends:
        raise TooLong("its time was over" if t is None else f"the motion had come to {t:.3g} s when its time was over")


def steps_of_a_call(most: int) -> int:
    """Steps of one native call: fewer under a limit, which is looked at between calls."""
    return most if _ends.get() is None else min(most, ASKED)
