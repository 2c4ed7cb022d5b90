"""Smooth rest-to-rest motions."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import real_array, require_number


def minimum_jerk(s: np.ndarray | float) -> tuple[Any, Any, Any]:
    """The quintic from 0 to 1 over s in [0, 1], end rates and accelerations zero, and its two derivatives."""
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
