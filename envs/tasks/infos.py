"""What a vector environment tells of its lanes beside observations and rewards, as Gymnasium lays it out.

Every value is an array (num_envs,) with a mask of its name after "_", True where it is said of a lane. Nothing here is
a view of an environment's own arrays, nor of another value's.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

Array = np.ndarray


class Ended(NamedTuple):
    """The k episodes that end in one step: rows for their lanes (k,), their last observations (k, no) and their
    randomised parameters (k, np), the last period's cost and of it the charge for the time left; the labels (k,) of
    their models where these are drawn.
    """

    lanes: Array
    cost: Array
    early_end_cost: Array
    diverged: Array
    obs: Array
    parameters: Array
    fidelity: Array | None = None


def masked(n: int, lanes: Array, **values: Array) -> dict[str, Any]:
    """Values (k,) of the lanes (k,) by name, as arrays (n,) with their masks."""
    found: dict[str, Any] = {}
    for name, value in values.items():
        found[name] = np.zeros(n, dtype=value.dtype)
        found[name][lanes] = value
        mask = found["_" + name] = np.zeros(n, dtype=bool)
        mask[lanes] = True
    return found


def of_end(n: int, ended: Ended) -> dict[str, Any]:
    """Of the lanes whose episodes are over: "cost", "early_end_cost", "diverged"."""
    return masked(n, ended.lanes, cost=ended.cost, early_end_cost=ended.early_end_cost, diverged=ended.diverged)


def of_parameters(n: int, lanes: Array, names: Sequence[str], p: Array) -> dict[str, Any]:
    """The randomised parameters p (k, np) of the lanes (k,), by name."""
    mask = np.zeros(n, dtype=bool)
    mask[lanes] = True
    return {"parameters": masked(n, lanes, **dict(zip(names, p.T))), "_parameters": mask}


def of_both(n: int, ended: Ended, names: Sequence[str], told: dict[str, Any], obs: Array) -> dict[str, Any]:
    """Where lanes start again in the step that ends them: what belongs to the end, beside what else is `told`.

    obs (n, no) are the observations that the step returns; final_obs holds the last ones of the lanes that ended.
    """
    final = of_end(n, ended) | of_parameters(n, ended.lanes, names, ended.parameters)
    final_obs = obs.copy()
    final_obs[ended.lanes] = ended.obs
    over = final["_cost"]
    if ended.fidelity is not None:
        final |= masked(n, ended.lanes, fidelity=ended.fidelity)
    if "validity" in told and (told["_validity"] & over).any():
        final |= {"validity": told["validity"].copy(), "_validity": told["_validity"] & over}
    return {"final_obs": final_obs, "_final_obs": over.copy(), "final_info": final, "_final_info": over.copy()}


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


def of_terms(n: int, lanes: Array, names: Sequence[str], terms: Array) -> dict[str, Any]:
    """What each term adds to minus the stage cost in the lanes (k,), from terms (k, nt) of their cost."""
    mask = np.zeros(n, dtype=bool)
    mask[lanes] = True
    return {"reward_terms": masked(n, lanes, **dict(zip(names, 0.0 - terms.T))), "_reward_terms": mask}


def of_both_periods(before: dict[str, Any], after: dict[str, Any]) -> dict[str, Any]:
    """What two periods under one action tell of single lanes: terms are summed, of all else the larger holds."""
    found = dict(before)
    for key, value in after.items():
        if key not in found:
            found[key] = value
        elif key == "reward_terms":
            found[key] = {name: _sum(found[key][name], own) for name, own in value.items()}
        else:
            found[key] = np.maximum(found[key], value)  # of masks: either
    return found


def _sum(before: Array, after: Array) -> Array:
    """Of values, or of masks where either holds."""
    return before | after if before.dtype == bool else before + after


def of_both_infos(before: dict[str, Any], after: dict[str, Any]) -> dict[str, Any]:
    """The same of a single environment's infos: costs and terms are summed, all else is that of the later period."""
    found = {**after, "cost": before["cost"] + after["cost"]}
    found["cost_constraint"] = max(before["cost_constraint"], after["cost_constraint"])
    if "reward_terms" in after:
        found["reward_terms"] = {
            name: own + before["reward_terms"][name] for name, own in after["reward_terms"].items()
        }
    return found
