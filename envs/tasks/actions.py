"""What an action of a policy asks of the inputs, where it is not simply a share of the limits.

A learner begins with actions of standard deviation 1 about zero, or uniform in [-1, 1]. As shares of the limits these
throw a machine about, and where gravity pulls, zero lets it fall. "midway" puts zero where the machine is half held,

    u = m + r a,    m = (u_start + u_goal) / 2,    r = max(limit / 2, MORE |u_goal - u_start| / 2),

with u_start and u_goal what holds the scene's start and goal at rest, so that both can be held with actions inside of
[-1, 1]; u is cut off at the limits. A machine that nothing pulls at has m = 0 and actions over half of its limits.
"""

from __future__ import annotations

import numpy as np

from pliant.envs.scenes.scene import Scene, once_per_scene

Array = np.ndarray
MORE = 1.5
KINDS = ("limits", "midway")


@once_per_scene
def midway(scene: Scene) -> tuple[Array, Array]:
    """(m, r), each (nu,), over the limits.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> m, r = midway(scenes.get("two-link-reach"))
    >>> m.round(3).tolist(), r.tolist()
    ([0.296, 0.276], [0.5, 0.5])
    """
    limits = np.array(scene.limits)
    start, goal = scene.initial[1] / limits, scene.target[1] / limits
    return (start + goal) / 2, np.maximum(0.5, MORE * np.abs(goal - start) / 2)


def placed(scene: Scene, kind: str) -> tuple[Array, Array]:
    """(m, r), each (nu,), over the limits, of actions of this kind.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> [part.tolist() for part in placed(scenes.get("single-link-slew"), "limits")]
    [[0.0], [1.0]]
    """
    nu = scene.plant.nu
    return (np.zeros(nu), np.ones(nu)) if kind == "limits" else midway(scene)


def shares(scene: Scene, kind: str, actions: Array) -> Array:
    """Actions (.., nu) as shares of the limits (.., nu), beyond [-1, 1] where they will be cut off.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> shares(scenes.get("single-link-slew"), "midway", np.array([0.5, 3.0])[:, None])[:, 0].tolist()
    [0.25, 0.5]
    """
    if kind == "limits":
        return actions
    m, r = midway(scene)
    return m + r * np.clip(actions, -1.0, 1.0)
