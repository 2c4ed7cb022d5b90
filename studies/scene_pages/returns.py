"""What doing nothing, chance, LQR and the laws of a kept scoreboard return on a scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pliant.controllers import LQR
from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.episode_start import early_end_cost
from pliant.plants import EquilibriumError, Trajectory
from pliant.plants.core.argument_gates import require_instance

from .tables import Cell, Table

EPISODES, SEED = 64, 0  # of random actions
HEAD = ("policy", "return", "cost over the bound")


def returns(scene: Scene, scoreboard: dict[str, Any] | None = None) -> Table:
    """Returns of an episode from the scene's own start, best first.

    Zero and random actions are played here: the latter uniform, the mean of EPISODES episodes. Laws, the shipped policy
    and the lower bound of any law's cost are those of a `scoreboard` json: played on the scene's own plant without
    noise or delay. Where it does not have LQR on the scene, or only as one that failed, and the goal is an equilibrium,
    LQR is played here too, and charged for an episode that ends where it leaves the bounds.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> [row[0] for row in returns(scenes.get("single-link-slew")).rows]
    ['LQR', 'zero actions', 'random actions']
    """
    require_instance("returns.scene", scene, Scene)
    kept = scoreboard or {"rows": [], "bounds": []}
    costs: dict[str, float] = {
        row["controller"]: row["cost"]
        for row in kept["rows"]
        if row["scene"] == scene.name and row["case"] == "exact" and row["failures"] == 0 and row["cost"] is not None
    }
    bound = next(
        (b["costs"][0] for b in kept["bounds"] if b["scene"] == scene.name and b["case"] == "exact" and b["costs"]),
        None,
    )
    regulated = None if "LQR" in costs else under_lqr(scene)
    if regulated is not None:
        costs["LQR"] = charged(scene, regulated)
    rng = np.random.default_rng(SEED)
    shape = scene.plant.nu
    costs["zero actions"] = _cost(scene, 1, lambda lanes: np.zeros((lanes, shape)))
    costs["random actions"] = _cost(scene, EPISODES, lambda lanes: rng.uniform(-1.0, 1.0, (lanes, shape)))
    rows: list[tuple[Cell, ...]] = [("bound: no law is better", -bound, 1.0)] if bound else []
    rows += [
        (name, -cost, cost / bound if bound else "") for name, cost in sorted(costs.items(), key=lambda item: item[1])
    ]
    return Table("returns", HEAD if bound else HEAD[:2], tuple(row if bound else row[:2] for row in rows))


def under_lqr(scene: Scene) -> Trajectory | None:
    """The scene's motion under LQR, at the control times; None where its goal is no equilibrium.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> under_lqr(scenes.get("slider-crank-run")) is None
    True
    """
    try:
        law = LQR.for_scene(scene)
    except EquilibriumError:
        return None
    return scene.plant.simulate(scene.initial[0], law, scene.times)


def charged(scene: Scene, motion: Trajectory) -> float:
    """What an environment charges for the scene's motion, at the control times: its cost, or where a bound is left the
    cost until then and what is charged for the time left. ValueError for a motion at other times.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> gentle = scenes.get("single-link-slew-gentle")  # the tip may bend by 10 mm, LQR bends it by 16
    >>> charged(gentle, under_lqr(gentle)) > 10 * gentle.cost(under_lqr(gentle))
    True
    """
    whole, beyond = scene.cost(motion), np.zeros(len(motion.t), dtype=bool)
    for name, bound in scene.bounds:
        beyond |= np.abs(motion[name]) > bound
    ends = np.flatnonzero(beyond[1:])
    if not len(ends):
        return whole
    done = int(ends[0]) + 1
    cost = scene.dt * scene.stage_cost(motion.x, motion.u, motion.y, motion.t - motion.t[0])[:done]
    return float(cost.sum() + early_end_cost(scene, done, cost[-1]))


def _cost(scene: Scene, lanes: int, action: Callable[[int], np.ndarray]) -> float:
    """Mean cost of one episode a lane."""
    env = scene.vector_env(lanes)
    env.reset(seed=SEED)
    total, playing = np.zeros(lanes), np.ones(lanes, bool)
    while playing.any():
        _, reward, ended, over, _ = env.step(action(lanes).astype(np.float32))
        total[playing] -= reward[playing]
        playing &= ~(ended | over)
    return float(total.mean())
