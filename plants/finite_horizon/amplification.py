"""The largest growth of a deviation over any part of a motion, from any time to any later one."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear import magnus

from .stretches import Stretches

Array = np.ndarray
BLOCKS = 100  # parts between which growth is compared first
LARGEST = 300.0  # logarithm of the growth
NEAR = 24  # ends of stretches about the best start and the best end that are compared then


@dataclass(frozen=True, eq=False)
class Amplification(OwnsArrays):
    """`factor` is attained by a deviation in `direction` at `start` [s], at `end` [s]; sizes are in the scale given.

    The largest over stretches: between their ends a mode of theirs turns by no more than half a radian.
    """

    factor: float
    start: float
    end: float
    direction: Array = field(repr=False)  # (nx,) in the states' own units, of size one in the scale
    whole: float  # from the start to the end of the motion


def amplification(on: Stretches, sizes: Array) -> Amplification:
    """Of |x / sizes|, the largest singular value of Phi(t, s) over all s <= t."""
    Phi = on.held[0] * sizes[None, None, :] / sizes[None, :, None]
    m = len(Phi)
    edges = np.unique(np.linspace(0, m, min(m, BLOCKS) + 1).astype(int))
    size, begin, end = _largest(magnus.grouped(Phi, edges), edges)
    whole = float(np.linalg.norm(magnus.product(Phi), 2))
    width = int(np.diff(edges).max())
    if width > 1:  # about the best pair, stretch by stretch
        near = {int(k) for e in (begin, end) for k in np.linspace(max(0, e - width), min(m, e + width), NEAR)}
        finer = np.array(sorted(near | {begin, end}))
        size, begin, end = max(
            (size, begin, end), _largest(magnus.grouped(Phi[finer[0] : finer[-1]], finer - finer[0]), finer)
        )
    if size <= 1.0:
        begin = end = 0
    right = np.linalg.svd(magnus.product(Phi[begin:end]))[2][0] if end > begin else np.eye(on.n)[0]
    return Amplification(max(size, 1.0), float(on.t[begin]), float(on.t[end]), right * sizes, whole)


def check_growth(on: Stretches, sizes: Array) -> None:
    """ValueError where |x / sizes| grows beyond the range of numbers."""
    if not grows_within(on.wholes * sizes[None, None, :] / sizes[None, :, None]):
        raise ValueError(
            f"finite_horizon: deviations grow by more than e^{LARGEST:g} from {on.t[0]:.4g} to {on.t[-1]:.4g} s, "
            "beyond the range of numbers: take a shorter part of the motion"
        )


def _largest(blocks: Array, edges: Array) -> tuple[float, int, int]:
    """The largest norm of a product of consecutive blocks, and the edges that it runs between."""
    best = (1.0, int(edges[0]), int(edges[0]))
    for length, products, logs in magnus.consecutive(blocks):
        sizes = np.linalg.norm(products, 2, axis=(1, 2)) * np.exp(logs)
        k = int(sizes.argmax())
        if sizes[k] > best[0]:
            best = float(sizes[k]), int(edges[k]), int(edges[k + length])
    return best


def grows_within(Phi: Array) -> bool:
    """Whether the product of transitions (m, n, n) stays within e^LARGEST, some of them taken together."""
    total, power, m = np.eye(Phi.shape[-1]), 0.0, len(Phi)
    with np.errstate(over="ignore", invalid="ignore"):  # what leaves the numbers within a part grows too far as well
        parts = magnus.grouped(Phi, np.unique(np.linspace(0, m, math.isqrt(m) + 1).astype(int)))
    for step in parts:
        total = step @ total
        size = float(np.abs(total).max())
        if not np.isfinite(size):
            return False
        if size > 1e100:
            total, power = total / size, power + float(np.log(size))
    return power + float(np.log(max(np.abs(total).max(), 1e-300))) <= LARGEST
