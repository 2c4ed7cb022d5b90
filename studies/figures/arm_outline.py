"""The lines of an arm in the plane, for drawing."""

from __future__ import annotations

import numpy as np

from pliant.plants import FlexibleSpacecraft, Plant, Trajectory

POINTS = 25  # along each link


def has_shape(plant: Plant) -> bool:
    """Whether the plant says where its links are, by `outline(x, points)` -> (links, points, 2)."""
    return hasattr(plant, "outline") and not in_space(plant)


def in_space(plant: Plant) -> bool:
    """Whether the plant's outline is not one in a plane."""
    return isinstance(plant, FlexibleSpacecraft)


def lines(plant: Plant, x: np.ndarray, points: int = POINTS, *, from_hub: bool = False) -> np.ndarray:
    """(B, n, 2) [m]: the arm as one line from root to tip, at states x (B, nx); `from_hub`: its first angle zero."""
    x = np.atleast_2d(x)
    drawn = [plant.outline(state, points) for state in x]  # type: ignore[attr-defined]
    found = np.array([np.concatenate(links) for links in drawn])
    if from_hub:
        c, s = np.cos(x[:, 0]), np.sin(x[:, 0])
        found = np.einsum("bni,bij->bnj", found, np.moveaxis(np.array([[c, -s], [s, c]]), -1, 0))
    return found


def whirls(plant: Plant, motion: Trajectory) -> bool:
    """Whether a hub turns more than once: in space the shapes would hide each other."""
    return plant.states[0].name == "hub_angle" and bool(np.ptp(motion.x[:, 0]) > 2 * np.pi)


def first_turn(plant: Plant, motion: Trajectory) -> float | None:
    """Time [s] of a crank's first full turn; None where nothing turns that far, or it is seen from the hub."""
    turned = np.abs(motion.x[:, 0] - motion.x[0, 0]) >= 2 * np.pi
    if plant.states[0].name != "crank_angle" or not turned.any():
        return None
    return float(motion.t[np.argmax(turned)])
