"""A spacecraft in three dimensions as lines and faces, for drawing: hub, panels bent as often as one can see it.

The hub is drawn as the homogeneous box of its mass and inertia. A panel is drawn from the one edge that the plant
outlines to the opposite one, parallel to it: twisting is not shown. Deflections may be exaggerated.
"""

from __future__ import annotations

import dataclasses
from typing import cast

import casadi as ca
import numpy as np

from pliant.envs.scenes.scene import Scene, once_per_scene
from pliant.plants import FlexibleSpacecraft, PliantError
from pliant.plants.core.quaternions import matrix_of

Array = np.ndarray
FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
SEEN = 0.06  # share of the reach that the largest deflection should take
FACTORS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
ROUGH = 1e-5  # relative tolerance of the motion that the exaggeration is chosen from


@dataclasses.dataclass(frozen=True)
class Scenery:
    """In reference axes [m]: corners of the hub's six faces (6, 4, 3), and a sheet (m, 2, 3) or line (m, 1, 3) each."""

    box: Array
    sheets: list[Array]
    roots: Array  # (2 n, 3): pairs of points that join a sheet to the hub's centre


def scenery(craft: FlexibleSpacecraft, x: Array, factor: float = 1.0, *, from_hub: bool = False) -> Scenery:
    """At a state x (nx,), deflections times `factor`; `from_hub`: in hub axes."""
    x, at = np.array(x, dtype=float), craft.layout
    for modes in at.modes:
        x[modes] *= factor
    if craft.translation:
        x[at.position] = 0.0
    R = np.eye(3) if from_hub else matrix_of(x[at.quaternion])
    if from_hub:
        x[at.quaternion] = [1.0, 0.0, 0.0, 0.0]
    corners = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]) * box_of(craft) / 2
    sheets, roots = [], []
    for i, (line, body) in enumerate(zip(craft.outline(x), craft.appendages)):
        offset = 2 * body.data.outline[0, 1]
        C = _numbers(body.turn(ca.SX(ca.DM(x[at.hinges[i]]))))
        across = R @ C @ np.array([0.0, -offset, 0.0])
        sheets.append(np.stack([line, line + across], axis=1) if offset else line[:, None])
        roots += [np.zeros(3), R @ np.asarray(body.position, dtype=float)]
    return Scenery(corners[np.array(FACES)] @ R.T, sheets, np.array(roots).reshape(-1, 3))


def _numbers(expression: ca.SX) -> Array:
    return np.array(ca.DM(ca.densify(ca.evalf(expression))))


def box_of(craft: FlexibleSpacecraft) -> Array:
    """Edges (3,) [m] of the homogeneous box of the hub's mass and principal moments."""
    own = craft.nominal
    I = np.diag(np.array(own.hub.inertia, dtype=float))
    return np.sqrt(np.maximum(6 * (I.sum() - 2 * I) / float(own.hub.mass), 0.01))


def reach_of(craft: FlexibleSpacecraft) -> float:
    """Largest distance [m] of a drawn point from the hub's centre, undeflected."""
    drawn = scenery(craft, craft.consistent(np.zeros(craft.nx)))
    return float(max(np.linalg.norm(points.reshape(-1, 3), axis=1).max() for points in (drawn.box, *drawn.sheets)))


@once_per_scene
def exaggeration(scene: Scene) -> int:
    """What the largest deflection of the scene's open-loop motion is drawn as many times as, so that it can be seen."""
    craft = cast(FlexibleSpacecraft, scene.plant)  # as it is drawn as one
    try:
        motion = scene.open_loop(rtol=ROUGH, atol=ROUGH / 1e4)
    except PliantError:
        return 1
    largest = max((float(np.abs(motion[name]).max()) for name in craft.tips), default=0.0)
    wanted = SEEN * reach_of(craft) / max(largest, 1e-12)
    return max((f for f in FACTORS if f <= wanted), default=1)
