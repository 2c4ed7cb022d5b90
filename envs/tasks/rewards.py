"""The bounded reward, for learners with their defaults.

The scene's own reward, minus its cost, falls without bound: a policy that begins with noise as large as the limits
throws the machine about, pays for it by the square, and what ends its episode charges thousands. The normalised one is

    r = 1 / (1 + log(1 + c / k)),    c the stage cost's rate in the period, k a KNEE-th of that at the scene's start,

1 at the goal, 1/(1 + log(1 + KNEE)) = 0.31 at the start, and above zero wherever the machine is; 0 in a period in which
an episode ends early. What is left of such an episode is not charged: it is lost, so that ending never pays. The
logarithm leaves a slope where costs are hundreds of times those of the start, as on an arm that noise has thrown round.
On the arms k is about the mean rate that LQR pays over an episode.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene, once_per_scene

KNEE = 8.0


@once_per_scene
def knee_cost(scene: Scene) -> float:
    """k dt. Of a start that costs nothing, the rate charged for early ends stands in."""
    rate = float(scene.stage_cost(*scene.initial, scene.plant.measure(*scene.initial)))
    return scene.dt * (rate or scene.early_end_rate) / KNEE


def normalised(scene: Scene, cost: Any, ended: Any) -> Any:
    """The reward of control periods that cost `cost`, without the charge for the time left; 0 where `ended` early.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> slew = scenes.get("single-link-slew")
    >>> float(normalised(slew, 0.0, False)), round(float(normalised(slew, slew.dt * 10.0, False)), 3)
    (1.0, 0.313)
    """
    with np.errstate(over="ignore"):
        return np.where(ended, 0.0, 1.0 / (1.0 + np.log1p(cost / knee_cost(scene))))
