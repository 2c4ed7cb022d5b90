"""Whether growth up to the end of a motion builds on itself, as a theorem: `transition_growth.compounds` on bounds.

Over some stretch up to the end the whole is at least DOUBLED times any half of it, and that SQUARED times what a half
is to any quarter; and some stretch to the end has an eigenvalue beyond REPEATED. Norms of products of blocks, each from
below where growth is asked for and from above where it is compared with.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from .balls import ends, flint, spectral_bounds
from .enclosed_multipliers import multipliers
from .enclosed_transition import Frames

BLOCKS = 32
DOUBLED, SQUARED = 4.0, 1.7
REPEATED = 2.0  # |eigenvalue| of some stretch: it grows where repeated, as drift does not


def compounds(begin: float, own: list[tuple[float, list[Any]]]) -> bool:
    """From (end of each interval [s], its enclosed steps)."""
    n = own[0][1][0].nrows()
    times = np.array([t for t, _ in own])
    wanted = np.searchsorted(times, np.linspace(begin, times[-1], min(len(own), BLOCKS) + 1)[1:-1] * (1 - 1e-12))
    edges = np.unique(np.r_[0, wanted + 1, len(own)])
    blocks = []
    for a, b in pairwise(edges):
        frames = Frames(n)
        for _, steps in own[a:b]:
            for P in steps:
                frames.times(P)
        blocks.append(frames.whole)
    at, count = np.r_[begin, times[edges[1:] - 1]], len(blocks)
    low, high = np.full((2, count + 1, count + 1), -np.inf)
    to_end = []
    for a in range(count):
        frames = Frames(n)
        for b in range(a, count):
            frames.times(blocks[b])
            whole = frames.whole
            low[a, b + 1], high[a, b + 1] = (_log(x, side) for side, x in enumerate(spectral_bounds(whole)))
        to_end.append(whole)
    if not builds_up(at, low, high):
        return False
    return any(multipliers(M, [np.arange(n)], []).least > REPEATED for M in reversed(to_end))


def builds_up(at: np.ndarray, low: np.ndarray, high: np.ndarray) -> bool:
    """Whether over some stretch up to the end the whole is DOUBLED times any half of it, and that SQUARED times what a
    half is to any quarter, from bounds (m + 1, m + 1) of ln |Phi| from each of the times `at` (m + 1,) [s] to each
    later one."""
    count = len(at) - 1
    for start in range(count - 3):
        half = (at[-1] - at[start]) / 2
        least = np.searchsorted(at, at + half * (1 - 1e-9))  # the first time a half later, and ..
        most = np.searchsorted(at, at + half / 2 * (1 + 1e-9), side="right") - 1  # .. the last within a quarter
        inside = np.flatnonzero(least[start:] <= count) + start
        later = np.arange(start, count + 1)
        of_half, of_quarter = high[inside, least[inside]].max(), low[later, most[later]].max()
        more = low[start, count] - of_half
        if more >= np.log(DOUBLED) and more - (of_half - of_quarter) >= np.log(SQUARED):
            return True
    return False


def _log(size: Any, side: int) -> float:
    """ln of a bound, outwards: side 0 below, 1 above."""
    if not size > 0:
        return -np.inf
    return ends(size.log())[side] if size < flint().arb.pos_inf() else np.inf
