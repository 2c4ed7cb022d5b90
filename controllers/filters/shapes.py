"""The filters that keep a bending mode out of a loop: a notch at its frequency, a roll-off below it."""

from __future__ import annotations

import numpy as np

from pliant.controllers.base.controller import share
from pliant.plants.core.argument_gates import require_count, require_number

from .filter import Filter


def notch(frequency: float, *, depth: float = 0.1, width: float = 1.0) -> Filter:
    """(s^2 + depth width w s + w^2) / (s^2 + width w s + w^2): 1 far from w = `frequency` [rad/s], `depth` there.

    width: of the band in which it takes more than 3 dB of what it takes at w, of w, if depth is small. A mode within
    width/2 of w is still attenuated; below w the notch costs phase: the wider, the more.

    Example
    -------
    >>> abs(notch(3.0, depth=0.05).at(3.0))
    array([0.05])
    """
    w = require_number("notch.frequency", frequency, "positive", "rad/s")
    depth, width = share("notch.depth", depth), require_number("notch.width", width, "positive")
    return Filter.from_coefficients([1.0, depth * width * w, w**2], [1.0, width * w, w**2], frequency=w)


def roll_off(frequency: float, *, order: int = 2) -> Filter:
    """Butterworth's filter: 1 at zero, 3 dB down at `frequency` [rad/s], by `order` times 20 dB a decade past it.

    Example
    -------
    >>> abs(roll_off(10.0).at([10.0])).round(4)
    array([0.7071])
    """
    w = require_number("roll_off.frequency", frequency, "positive", "rad/s")
    n = require_count("roll_off", "order", order, 1, 8)
    angles = np.pi * (2 * np.arange(n) + 1 + n) / (2 * n)
    bottom = np.real(np.poly(w * np.exp(1j * angles)))
    return Filter.from_coefficients([w**n], bottom, frequency=w)


def lag(slow: float, fast: float) -> Filter:
    """(s + fast) slow / ((s + slow) fast): 1 at zero, slow/fast at high frequencies; `slow` < `fast` [rad/s], a lead
    with (s + slow) above where `slow` > `fast`.

    Example
    -------
    >>> abs(lag(1.0, 10.0).at([0.001, 1000.0])).round(3)
    array([1. , 0.1])
    """
    slow = require_number("lag.slow", slow, "positive", "rad/s")
    fast = require_number("lag.fast", fast, "positive", "rad/s")
    return Filter.from_coefficients([slow / fast, slow], [1.0, slow], frequency=float(np.sqrt(slow * fast)))
