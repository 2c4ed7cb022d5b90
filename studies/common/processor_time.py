"""The clock that limits are told by: processor time, which other programs on the machine do not shorten."""

from __future__ import annotations

import os
import time


def processor_time() -> float:
    """[s] of this thread, and of programs that it waited for, as a compiler."""
    took = os.times()
    return time.thread_time() + took.children_user + took.children_system
