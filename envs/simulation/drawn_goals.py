"""Other goals of a scene: what observations and costs are measured from where the plant is to rest elsewhere."""

from __future__ import annotations

import dataclasses

import numpy as np

from pliant.envs.scenes.scene import Scene, once_per_scene

from .episode_start import rest_points

Array = np.ndarray


def require_goals(scene: Scene) -> None:
    """ValueError for a scene whose goal is no rest point of coordinates."""
    if not scene.goal_at_rest or scene.goal_rates:
        raise ValueError(f"scene {scene.name!r}: its goal is no rest point, goal_spread must be 0")


@once_per_scene
def _goal_scene(scene: Scene) -> Scene:
    """The scene whose starts are this one's goals."""
    require_goals(scene)
    return dataclasses.replace(
        scene, start=scene.goal, start_at_rest=True, nominal_start=None, start_spread=0.0, spreads=()
    )


def allowed_offsets(scene: Scene, offsets: Array) -> Array:
    """The offsets (n, ng) of goals that can be: where these are a quaternion's coordinates, off by (n, ng), of the unit
    one that they point to.
    """
    require_goals(scene)
    own, places = np.array([value for _, value in scene.goal]), scene.positions(name for name, _ in scene.goal)
    if not set(scene.plant.attitude_states) & {name for name, _ in scene.goal}:
        return offsets
    x = np.tile(scene.target[0], (len(offsets), 1))
    x[:, places] = own + offsets
    return scene.plant.consistent(x)[:, places] - own


def goal_references(scene: Scene, offsets: Array) -> Array:
    """The references (n, nr), as `control_period.reference`, of goals off the scene's own by `allowed_offsets`."""
    goals = np.array([value for _, value in scene.goal]) + offsets
    plant = scene.plant
    p = np.tile(scene.varied_plant.nominal_parameters, (len(goals), 1))
    x, u = rest_points(_goal_scene(scene), goals, p)
    y = np.array([plant.measure(*pair) for pair in zip(x, u)])
    shown = [scene.signal_values(x, y, names) for names in (scene.observe, scene.weighted)]
    return np.hstack([*shown, u[:, scene.priced_inputs]])
