"""What a scene charges: the stage cost, the charge for an early end, the cost of a motion."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants import Trajectory
from pliant.plants.core.argument_gates import real_array, require_instance

from .checks import rows

if TYPE_CHECKING:
    from .scene import Scene


def weighed(weights: Iterable[tuple[str, float]], deviations: Iterable[Any]) -> Any:
    """Sum of weight times deviation squared: numbers, arrays or SX; 0 where nothing is weighed."""
    return sum(weight * e**2 for (_, weight), e in zip(weights, deviations))


def stage_cost(scene: Scene, x: np.ndarray, u: np.ndarray, y: np.ndarray, t: Any) -> Any:
    """Cost rate (...) [1/s] at x (..., nx), u (..., nu), y (..., ny) and t (...) [s]."""
    z0, u0 = scene.cost_origin
    plant, t = scene.plant, real_array("stage_cost.t", t)
    x, y, u = rows("stage_cost", x=(x, plant.nx), y=(y, plant.ny), u=(u, plant.nu))
    if t.shape not in ((), x.shape[:-1]) or not np.isfinite(t).all():
        raise ValueError(f"stage_cost.t has shape {t.shape}, must be a finite time or {x.shape[:-1]} of them [s]")
    z0 = z0 + np.multiply.outer(t, scene.goal_drift(scene.weighted))
    errors = scene.signal_values(x, y, scene.weighted) - z0
    excess = u[..., scene.priced_inputs] - u0
    rate = scene.cost_rate(np.moveaxis(errors, -1, 0), np.moveaxis(excess, -1, 0))
    return rate + np.zeros(errors.shape[:-1])


def early_end_rate(scene: Scene) -> float:
    """Cost rate [1/s] of the time left when an episode ends early.

    The stage cost with every input at its limit and every weighted signal as far from the goal as its
    bound lets it be, or, without a bound, as it is at the start: no motion that stays that near costs
    more. From states that have run away much farther, coming back could still cost more than ending.
    """
    (x, u), (z0, u0) = scene.initial, scene.cost_origin
    begin = scene.signal_values(x, scene.plant.measure(x, u), scene.weighted)
    bounds, spread = dict(scene.bounds), dict(zip([name for name, _ in scene.start], scene.spread))
    errors = [
        bounds[name] + abs(goal) if name in bounds else abs(first - goal) + spread.get(name, 0.0)
        for name, first, goal in zip(scene.weighted, begin, z0)
    ]
    return float(scene.cost_rate(errors, np.array(scene.limits)[scene.priced_inputs] + np.abs(u0)))


def of_motion(scene: Scene, motion: Trajectory) -> float:
    """The sum over the control periods of dt times the stage cost at their start.

    ValueError where the motion is not sampled at the control times.
    """
    require_instance("cost.motion", motion, Trajectory)
    if len(motion.t) != scene.steps + 1 or not np.allclose(motion.t, scene.times, atol=1e-9):
        raise ValueError(
            f"motion has {len(motion.t)} times, must have the scene's {scene.steps + 1} every {scene.dt} s"
        )
    return float(scene.dt * scene.stage_cost(motion.x, motion.u, motion.y, motion.t - motion.t[0])[:-1].sum())
