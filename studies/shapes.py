"""The lines of an arm in the plane, for drawing."""

from __future__ import annotations

import numpy as np

from pliant.plants import Plant

POINTS = 25  # along each link


def has_shape(plant: Plant) -> bool:
    """Whether the plant says where its links are, by `outline(x, points)` -> (links, points, 2)."""
    return hasattr(plant, "outline")


def lines(plant: Plant, x: np.ndarray, points: int = POINTS) -> np.ndarray:
    """(B, n, 2) [m]: the arm as one line from root to tip, at states x (B, nx)."""
    drawn = [plant.outline(state, points) for state in np.atleast_2d(x)]  # type: ignore[attr-defined]
    return np.array([np.concatenate(links) for links in drawn])
