"""The lines of an arm in the plane, for drawing."""

from __future__ import annotations

import numpy as np

from pliant.plants import Plant, Trajectory
from pliant.plants.core.signals import index

POINTS = 25  # along each link


def has_shape(plant: Plant) -> bool:
    """Whether the plant says where its links are, by `outline(x, points)` -> (links, points, 2)."""
    return not in_space(plant) and len(plant.outline(plant.consistent(np.zeros(plant.nx)), 2)) > 0


def in_space(plant: Plant) -> bool:
    """Whether the plant's outline is not one in a plane."""
    return plant.drawn_as == "spacecraft"


def lines(plant: Plant, x: np.ndarray, points: int = POINTS, *, from_hub: bool = False) -> np.ndarray:
    """(B, n, 2) [m]: the arm as one line from root to tip, at states x (B, nx); `from_hub`: that angle zero."""
    x = np.atleast_2d(x)
    drawn = [plant.outline(state, points) for state in x]
    found = np.array([np.concatenate(links) for links in drawn])
    if from_hub and plant.seen_from is not None:
        turned = x[:, index(plant.states, plant.seen_from, "state")]
        c, s = np.cos(turned), np.sin(turned)
        found = np.einsum("bni,bij->bnj", found, np.moveaxis(np.array([[c, -s], [s, c]]), -1, 0))
    return found


def whirls(plant: Plant, motion: Trajectory) -> bool:
    """Whether a hub turns more than once: in space the shapes would hide each other."""
    return plant.seen_from is not None and bool(np.ptp(motion[plant.seen_from]) > 2 * np.pi)


def first_turn(plant: Plant, motion: Trajectory) -> float | None:
    """Time [s] of a crank's first full turn; None where nothing turns that far, or it is seen from the hub."""
    if plant.cycle is None:
        return None
    angle = motion[plant.cycle]
    turned = np.abs(angle - angle[0]) >= 2 * np.pi
    if not turned.any():
        return None
    return float(motion.t[np.argmax(turned)])
