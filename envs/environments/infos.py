"""What a vector environment tells of its lanes beside observations and rewards, as Gymnasium lays it out.

Every value is an array (num_envs,) with a mask of its name after "_", True where it is said of a lane. Nothing here is
a view of an environment's own arrays, nor of another value's.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_kernel import ControlStep

Array = np.ndarray


def _masked(mask: Array, **values: Array) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in values.items():
        found[name], found[f"_{name}"] = value.copy(), mask.copy()
    return found


def of_episodes(scene: Scene, step: ControlStep, mask: Array) -> dict[str, Any]:
    """Of the lanes (num_envs,) whose episodes begin or end: the randomised parameters, by name, that they have."""
    values = _masked(mask, **dict(zip(scene.varied_plant.varied, step.p.astype(float))))
    return {"parameters": values, "_parameters": mask.copy()}


def of_end(cost: Array, early: tuple[Array, Array], diverged: Array, over: Array) -> dict[str, Any]:
    """Of the lanes whose episodes are over: the last period's cost, and of it the charge early = (lanes, costs) for the
    time left; whether the state diverged.
    """
    charged = np.zeros(len(cost))
    charged[early[0]] = early[1]
    return _masked(over, cost=cost, early_end_cost=charged, diverged=diverged)


def of_both(scene: Scene, step: ControlStep, found: dict[str, Any], obs: Array, over: Array) -> dict[str, Any]:
    """Where lanes start again in the step that ends them: what is told of the end, before the start overwrites it."""
    final = {key: value.copy() for key, value in found.items()}
    if "_validity" in final:
        final["_validity"] &= over
    final |= of_episodes(scene, step, over)
    return {**found, **_masked(over, final_obs=obs), "final_info": final, "_final_info": over.copy()}


def of_lanes(found: dict[str, Any], lanes: Array) -> list[dict[str, Any]]:
    """What the infos of a vector environment say of each of the lanes (k,), as infos of single environments."""
    each: list[dict[str, Any]] = [{} for _ in range(len(lanes))]
    for key, value in found.items():
        if key[0] == "_":
            continue
        values = of_lanes(value, lanes) if isinstance(value, dict) else value[lanes].tolist()
        for own, item, said in zip(each, values, found["_" + key][lanes].tolist()):
            if said:
                own[key] = item
    return each
