"""Motions from rest to rest, 0 to 1 over s in [0, 1]: smooth ones, and the quickest that a torque allows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import real_array, require_choice, require_number


def minimum_jerk(s: np.ndarray | float) -> tuple[Any, Any, Any]:
    """The quintic from 0 to 1 over s in [0, 1], end rates and accelerations zero, and its two derivatives.

    ValueError where s has NaN.

    Example
    -------
    >>> [round(float(part), 4) for part in minimum_jerk(0.5)]
    [0.5, 1.875, 0.0]
    """
    if type(s) is float and s == s:
        s = min(max(s, 0.0), 1.0)
    elif isinstance(s, (np.ndarray, list, tuple)):
        s = np.clip(real_array("minimum_jerk.s", s), 0.0, 1.0)
        if np.isnan(s).any():
            raise ValueError("minimum_jerk.s has NaN, must be numbers")
    else:
        s = min(max(require_number("minimum_jerk.s", s), 0.0), 1.0)
    return (
        10 * s**3 - 15 * s**4 + 6 * s**5,
        30 * s**2 - 60 * s**3 + 30 * s**4,
        60 * s - 180 * s**2 + 120 * s**3,
    )


def jerk_limited(s: np.ndarray | float, ramp: float = 0.125) -> tuple[Any, Any, Any]:
    """Acceleration that rises over `ramp` (of the time, up to 1/4), holds, falls to zero at 1/2, then the same braking:
    way, rate, acceleration. Its largest acceleration is 4 / (1 - 2 ramp), its jerk that over ramp.
    """
    r = require_number("jerk_limited.ramp", ramp, "nonnegative")
    if r > 0.25:
        raise ValueError(f"jerk_limited.ramp = {ramp!r} must be >= 0 and <= 0.25")
    s = real_array("jerk_limited.s", s)
    if np.isnan(s).any():
        raise ValueError("jerk_limited.s has NaN, must be numbers")
    later = s >= 0.5
    x = np.clip(np.where(later, 1 - s, s), 0.0, 0.5)  # the second half is the first one backwards
    top, y = 4 / (1 - 2 * r), 0.5 - x
    fastest = top * (0.5 - r)
    rising, falling = x < r, y < r
    safe = r if r else 1.0
    a = np.where(rising, top * x / safe, np.where(falling, top * y / safe, top))
    v = np.where(rising, top * x**2 / (2 * safe), top * (x - r / 2))
    v = np.where(falling, fastest - top * y**2 / (2 * safe), v)
    way = np.where(rising, top * x**3 / (6 * safe), top * (r**2 / 6 + (x - r) * r / 2 + (x - r) ** 2 / 2))
    way = np.where(falling, 0.5 - fastest * y + top * y**3 / (6 * safe), way)
    moves = (s >= 0) & (s < 1)
    found = np.where(later, 1 - way, way), v * moves, np.where(later, -a, a) * moves
    return found if s.ndim else tuple(float(part) for part in found)  # type: ignore[return-value]


def bang_bang(s: np.ndarray | float) -> tuple[Any, Any, Any]:
    """Full acceleration, 4, up to 1/2, then full braking: the quickest under a limit, and what bends most."""
    return jerk_limited(s, 0.0)


Profile = Callable[[Any], tuple[Any, Any, Any]]
PROFILES: dict[str, Profile] = {
    "minimum-jerk": minimum_jerk,
    "jerk-limited": jerk_limited,
    "bang-bang": bang_bang,
}


def profile_of(owner: str, name: Any) -> Profile:
    """The motion of that name; ValueError lists them."""
    require_choice(owner, "profile", name, tuple(PROFILES))
    return PROFILES[name]
