"""The lines of an arm in the plane, for drawing."""

from __future__ import annotations

import numpy as np
from pliant.plants import Plant, SingleLinkArm, TwoLinkArm

POINTS = 25  # along each arm


def has_shape(plant: Plant) -> bool:
    """Whether the plant's lines are known."""
    return hasattr(plant, "outline") or isinstance(plant, (SingleLinkArm, TwoLinkArm))


def lines(plant: Plant, x: np.ndarray, points: int = POINTS) -> np.ndarray:
    """(B, n, 2) [m] positions along the arm at states x (B, nx)."""
    x = np.atleast_2d(np.asarray(x, dtype=float))
    if hasattr(plant, "outline"):
        return np.asarray(plant.outline(x, points))
    if isinstance(plant, SingleLinkArm):
        return _link(plant.elastic, x[:, 1 : plant.nx // 2], x[:, 0], np.zeros((len(x), 2)), points)
    assert isinstance(plant, TwoLinkArm)
    n1 = plant.mode_counts[0]
    q1, q2 = x[:, 2 : 2 + n1], x[:, 2 + n1 : plant.nx // 2]
    first = _link(plant.links[0], q1, x[:, 0], np.zeros((len(x), 2)), points)
    slope = q1 @ plant.links[0].basis.tip_slope / plant.link1.length if plant.tip_slope else 0.0
    second = _link(plant.links[1], q2, x[:, 0] + x[:, 1] + slope, first[:, -1], points)
    return np.concatenate([first, second[:, 1:]], axis=1)


def _link(link, q, angle, root, points):  # type: ignore[no-untyped-def]
    xi = np.linspace(0.0, 1.0, points)
    along = np.tile(link.beam.length * xi, (len(q), 1))
    across = q @ link.basis.phi(xi).T
    if link.stiffened:
        slope = q @ link.basis.phi(xi, 1).T
        steps = (slope[:, 1:] ** 2 + slope[:, :-1] ** 2) / 2 * np.diff(xi) / (2 * link.beam.length)
        along[:, 1:] -= np.cumsum(steps, axis=1)
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return root[:, None] + np.stack([c * along - s * across, s * along + c * across], axis=-1)
