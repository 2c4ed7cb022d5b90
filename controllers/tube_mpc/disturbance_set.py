"""What is taken to act beside the model: w_k in the convex hull of points and zero, readings off by a box.

    x_{k+1} = A_k x_k + B_k u_k + c_k + w_k,   x^_k = x_k + e_k,   w_k in conv(0, W_k),   |e_k| <= noise

All that is asked of the set is how far it goes in a direction, its support function h(d) = sup d'w.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from pliant.plants.core.argument_gates import require_finite, require_number
from pliant.plants.core.signals import OwnsArrays, read_only

Array = np.ndarray
MOST_SIDES = 12  # of a box given by its corners


@final
@dataclass(frozen=True, eq=False)
class DisturbanceSet(OwnsArrays):
    """points (T, nv, nx): of each period, the last of which stays; noise (nx,) >= 0 of readings, in the states' units.

    Example
    -------
    >>> DisturbanceSet.box([0.0, 0.1]).support(0, np.array([[1.0, 2.0]]))
    array([0.2])
    """

    points: Array
    noise: Array

    def __post_init__(self) -> None:
        points = read_only("DisturbanceSet.points", self.points, (-1, -1, -1))
        if not points.shape[0] or not points.shape[1]:
            raise ValueError(f"DisturbanceSet.points has shape {points.shape}, must hold a period and a point")
        noise = read_only("DisturbanceSet.noise", self.noise, (points.shape[2],))
        if not (noise >= 0).all():
            raise ValueError(f"DisturbanceSet.noise = {noise} must be >= 0")
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "noise", noise)

    @classmethod
    def box(cls, size: Any, noise: Any = None) -> DisturbanceSet:
        """|w_i| <= size_i at all times: size (nx,) >= 0, noise (nx,) >= 0 or None, in the states' units. ValueError for
        more than 12 states.

        Example
        -------
        >>> DisturbanceSet.box([0.1, 0.2]).points.shape
        (1, 4, 2)
        """
        size = require_finite("DisturbanceSet.box.size", size, (-1,))
        if not (size >= 0).all():
            raise ValueError(f"DisturbanceSet.box.size = {size} must be >= 0")
        n = len(size)
        if not 1 <= n <= MOST_SIDES:
            raise ValueError(
                f"DisturbanceSet.box.size has {n} entries, must have 1 to {MOST_SIDES}: name points instead"
            )
        signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * n, indexing="ij")).reshape(n, -1).T
        return cls((signs * size)[None], np.zeros(n) if noise is None else noise)

    def support(self, k: int, directions: Any) -> Array:
        """h (m,) of w_k in directions (m, nx); never below zero.

        Example
        -------
        >>> DisturbanceSet(np.array([[[1.0, 0.0]]]), np.zeros(2)).support(5, np.array([[2.0, 0.0], [-2.0, 0.0]]))
        array([2., 0.])
        """
        k = min(max(int(require_number("DisturbanceSet.support.k", k)), 0), len(self.points) - 1)
        d = require_finite("DisturbanceSet.support.directions", directions, (-1, len(self.noise)))
        return np.asarray(np.maximum((d @ self.points[k].T).max(axis=1), 0.0))

    def scaled(self, share: float) -> DisturbanceSet:
        """The set `share` >= 0 times as large, noise included.

        Example
        -------
        >>> DisturbanceSet.box([1.0]).scaled(0.5).support(0, np.array([[1.0]]))
        array([0.5])
        """
        share = require_number("DisturbanceSet.scaled.share", share, "nonnegative")
        return DisturbanceSet(share * self.points, share * self.noise)
