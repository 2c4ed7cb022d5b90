"""The units in which a learner with its defaults sees a scene: readings over their spread, actions over a gentle push.

A network starts with weights, and a policy with noise, of order one. A deflection of 20 mm beside an angle of one
radian is not seen by it, and noise of one, as large as the limits, throws a machine about. With `reward="normalised"`
readings are over the range of their signal in the scene's nominal motion, those of a signal that hardly moves over
LEAST of the largest of its unit; and an action of 1 asks for GENTLE of an input's limit, so that actions reach from
-1/GENTLE to 1/GENTLE.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from gymnasium import spaces

from pliant.envs.scenes.scene import Scene, once_per_scene
from pliant.plants import NominalWarning
from pliant.plants.core.signals import OwnsArrays

Array = np.ndarray
GENTLE = 0.25
LEAST = 0.2


def nominal_ranges(scene: Scene) -> Array:
    """Largest less smallest (no,) of each reading of the scene in its nominal motion, in its unit.

    To three digits: the same on every machine and with every method of integration.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NominalWarning)  # of the motion's range alone
        motion = scene.open_loop(method="rk4", step=scene.dt / scene.substeps)
    ranges = np.ptp(scene.signal_values(motion.x, motion.y, scene.observe), axis=0)
    return np.array([float(f"{value:.3g}") for value in ranges])


@once_per_scene
def observation_scale(scene: Scene) -> Array:
    """What each reading (no,) is divided by, in its unit.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> bool(observation_scale(scenes.get("single-link-slew"))[0] == 1.0)  # [rad], of one radian's slew
    True
    """
    ranges = nominal_ranges(scene)
    units = {signal.name: signal.unit for signal in scene.signals}
    own = [units[name] for name in scene.observe]
    same = [max(r for r, other in zip(ranges, own) if other == unit) for unit in own]
    found: Array = np.maximum(ranges, LEAST * np.array(same))
    return np.where((found > 0) & np.isfinite(found), found, 1.0)


@dataclass(frozen=True, eq=False)
class Units(OwnsArrays):
    """What is shown is over `scale` (width,), where there is one; actions are over 1/`largest` of the limits.

    Example
    -------
    >>> Units(np.array([2.0, 1.0]), 4.0).shown(np.array([2.0, 3.0])).tolist()
    [1.0, 3.0]
    """

    scale: Array | None = None
    largest: float = 1.0

    def shown(self, seen: Array) -> Array:
        """A copy of what is read (.., width), in these units."""
        return seen.copy() if self.scale is None else (seen / self.scale).astype(seen.dtype)

    def asked(self, action: Array) -> Array:
        """Shares of the limits (.., nu) that an action in these units asks for."""
        return action if self.largest == 1.0 else action / self.largest

    def actions(self, nu: int) -> spaces.Box:
        """The space of actions (nu,)."""
        return spaces.Box(-self.largest, self.largest, (nu,), np.float32)
