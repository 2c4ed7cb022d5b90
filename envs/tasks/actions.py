"""What an action of a policy asks of the inputs, where it is not simply a share of the limits.

A learner begins with actions of standard deviation 1 about zero, or uniform in [-1, 1]. As shares of the limits these
throw a machine about, and where gravity pulls, zero lets it fall. "midway" puts zero where the machine is half held,

    u = m + r a,    m = (u_start + u_goal) / 2,    r = max(limit / 2, MORE |u_goal - u_start| / 2),

with u_start and u_goal what holds the scene's start and goal at rest, so that both can be held with actions inside of
[-1, 1]; u is cut off at the limits. A machine that nothing pulls at has m = 0 and actions over half of its limits.
"nominal" has the same m, and a reach that goes by what the task takes, where limits are far larger,

    r = max(ROOM max_t |u_nominal(t) - m|, MORE |u_goal - u_start| / 2),

so that noise moves each joint about as far as its own move is; half of the limit where the nominal motion leaves an
input at m, as where it is let go.
"""

from __future__ import annotations

import warnings

import numpy as np

from pliant.envs.scenes.nominal_inputs import sampled
from pliant.envs.scenes.scene import Scene, once_per_scene
from pliant.plants import NominalWarning

Array = np.ndarray
MORE, ROOM = 1.5, 1.25
LEAST = 1e-6  # of a limit, below which the nominal motion leaves an input where it is
KINDS = ("limits", "midway", "nominal")


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


@once_per_scene
def nominal(scene: Scene) -> tuple[Array, Array]:
    """(m, r), each (nu,), over the limits, r by the scene's nominal inputs, cut off at the limits.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> m, r = nominal(scenes.get("spin-up"))  # 0.8 rad/s^2 of 2 at most
    >>> m.tolist(), r.round(3).tolist()
    ([0.0], [0.5])
    """
    m, half = midway(scene)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NominalWarning)  # beyond the limits: cut off here
        _, u = sampled(scene, scene.nominal_input)
    limits = np.array(scene.limits)
    most = np.abs(np.clip(u / limits, -1.0, 1.0) - m).max(axis=0)
    held = MORE * np.abs(scene.target[1] - scene.initial[1]) / limits / 2
    return m, np.where(most > LEAST, np.maximum(ROOM * most, held), half)


def placed(scene: Scene, kind: str) -> tuple[Array, Array]:
    """(m, r), each (nu,), over the limits, of actions of this kind.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> [part.tolist() for part in placed(scenes.get("single-link-slew"), "limits")]
    [[0.0], [1.0]]
    """
    nu = scene.plant.nu
    if kind == "limits":
        return np.zeros(nu), np.ones(nu)
    return midway(scene) if kind == "midway" else nominal(scene)


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
    m, r = placed(scene, kind)
    return m + r * np.clip(actions, -1.0, 1.0)
