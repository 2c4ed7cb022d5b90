"""A nominal motion for a scene: from rest to rest, through points, or along a path, within limits.

Least effort, sum dt |(u - u_goal) / limit|^2, near the minimum-jerk way of the rigid plant or near a path; the end at
rest, elastic modes included, is a constraint. The solver starts from the motion and the inputs of the rigid plant.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.controllers.base.controller import ends, share
from pliant.controllers.base.goal_model import goal_model
from pliant.controllers.base.objective import Objective
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.plants.core.argument_gates import (
    require_by_name,
    require_finite,
    require_function,
    require_mapping,
    require_number,
    shown,
)
from pliant.plants.core.errors import PliantError
from pliant.plants.integration.minimum_jerk import minimum_jerk

from .optimal import Motion, optimal

if TYPE_CHECKING:
    from pliant.plants.dynamics.plant import Plant


MOST = 100_000  # control periods
NEARNESS = 10.0  # weight of a coordinate's deviation from its way, as a share of its travel: few iterations, low torque


def plan(
    scene: CostedScene,
    *,
    x0: Any = None,
    time: float | None = None,
    reserve: float = 0.1,
    bounds: Mapping[str, float | tuple[float, float]] | None = None,
    via: Mapping[float, Mapping[str, float]] | None = None,
    path: Callable[[float], Mapping[str, float]] | None = None,
    weights: Mapping[str, float] | None = None,
    effort: Mapping[str, float] | None = None,
    guess: Any = None,
    **options: Any,
) -> Motion:
    """The motion from x0 (nx,) to rest at the scene's goal in `time` [s] (None: from its start, in its move_time).

    reserve: share of every limit kept for feedback. bounds: {state or output: largest |value|, or (lowest, highest)},
    besides the scene's own (deflections, speeds). via: {time: {state or output: value}}, met at the control period
    nearest to the time. path: time -> values of the signals in `weights`, which the cost then tracks; weights alone
    are those of deviations from the goal. effort: weights of the inputs; None: 1 / limit^2. guess and further options
    as in `optimal`. InfeasibleError names what is violated.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> motion = plan(scenes.get("single-link-slew"))
    >>> motion.x.shape[1], motion.u.shape[1]
    (6, 1)
    """
    require_scene("plan", scene)
    plant, dt = scene.plant, scene.dt
    reserve = share("plan.reserve", reserve)
    time = scene.move_time if time is None else require_number("plan.time", time, unit="s")
    if not dt <= time <= MOST * dt:
        raise ValueError(f"plan.time = {time!r} must be at least the control period {dt} s, at most {MOST:,} of it")
    steps = round(time / dt)
    weights = None if weights is None else require_by_name("plan.weights", weights)
    effort = None if effort is None else require_by_name("plan.effort", effort)
    if path is not None:
        require_function("plan.path", path)
    if path is not None and not weights:
        raise ValueError("plan.weights must name the signals that the path gives")
    limits = np.array(scene.limits, dtype=float)
    allowed: dict[str, tuple[float, float]] = {name: (-value, value) for name, value in scene.bounds}
    for name, value in ({} if bounds is None else require_mapping("plan.bounds", bounds)).items():
        if not isinstance(value, (tuple, list, np.ndarray)) or np.ndim(value) == 0:
            largest = require_number(f"plan.bounds[{name!r}]", value)
            value = -largest, largest
        allowed[name] = ends(f"plan.bounds[{name!r}]", value)
    names = [s.name for s in plant.inputs]
    _, u_goal = scene.target
    x_goal = Objective.of(scene).goal_at(time)
    x0 = scene.initial[0] if x0 is None else require_finite("plan.x0", x0, (plant.nx,))
    rigid = rigid_motion(plant, x0, x_goal, u_goal, time, steps)
    reference: dict[str, np.ndarray] = {}
    if path is not None:
        along = [require_by_name(f"plan.path({k * dt:g})", path(k * dt)) for k in range(steps)]
        for values in along:
            if set(values) != set(along[0]):
                raise ValueError(f"plan.path gives {', '.join(values)}, must give the same signals at all times")
        reference = {name: np.array([values[name] for values in along]) for name in along[0]}
    elif weights is None:
        reference = {plant.states[i].name: rigid[0][:-1, i] for i in _travelled(plant, x0, x_goal)}
        weights = {name: NEARNESS / np.ptp(way) ** 2 for name, way in reference.items()}
    objective = Objective(
        plant=plant,
        x_goal=x_goal,
        u_goal=u_goal,
        weights=dict(weights or {}),
        effort=dict(effort) if effort else {n: 1 / limit**2 for n, limit in zip(names, limits)},
        dt=dt,
        limits=(-(1 - reserve) * limits, (1 - reserve) * limits),
        bounds=allowed,
    )
    at = {steps: _rest(scene, time)}
    if via is not None and not isinstance(via, Mapping):
        raise ValueError(f"plan.via = {shown(via)} must be values by name for each time [s]")
    for moment, passed in (via or {}).items():
        k = round(require_number("plan.via", moment, unit="s") / dt)
        if not 1 <= k < steps:
            raise ValueError(f"plan.via at {moment!r} s must be within [{dt:g}, {(steps - 1) * dt:g}] s")
        at[k] = require_by_name(f"plan.via[{moment!r}]", passed)
    return optimal(
        objective,
        x0,
        steps,
        at=at,
        reference=reference,
        guess=rigid if guess is None else guess,
        **{"substeps": scene.substeps, **options},
    )


def _rest(scene: CostedScene, time: float) -> dict[str, float]:
    """What the end must be: every state or output that a law about the goal has to hold, where it is at `time` [s]."""
    model, drift = goal_model(scene)
    return dict(zip(model.state_names, (model.x0 + time * drift).tolist()))


def rigid_motion(
    plant: Plant, x0: np.ndarray, x_goal: np.ndarray, u_goal: np.ndarray, time: float, steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """x (steps+1, nx) and u (steps, nu) of the rigid plant on a minimum-jerk way, in the states of `plant`.

    States that the rigid plant lacks go straight from start to goal. Where its inputs do not reach every coordinate,
    or it shares no coordinates, the inputs are those at the goal.
    """
    t = time / steps * np.arange(steps + 1)
    s, ds, dds = (np.asarray(v)[:, None] for v in minimum_jerk(t / time))
    x = x0 + s * (x_goal - x0)
    rigid, q = plant.ladder()[0], _coordinates(plant)
    n = len(q)
    if not n or rigid.nu != n or plant.nu != n:
        return x, np.tile(u_goal, (steps, 1))
    own = [s.name for s in plant.states]
    v = [own.index(name) for name in rigid.rates.values()]
    span = x_goal[q] - x0[q]
    x[:, v] = ds / time * span
    middle = (t[:-1] + t[1:]) / 2
    s, ds, dds = (np.asarray(each)[:, None] for each in minimum_jerk(middle / time))
    known = [s.name for s in rigid.states]  # in any order
    places, rates = ([known.index(name) for name in group] for group in (rigid.rates, rigid.rates.values()))
    state = np.zeros((steps, rigid.nx))
    state[:, places], state[:, rates] = x0[q] + s * span, ds / time * span
    B = rigid.jacobians(state)[1][:, rates]
    lacking = dds / time**2 * span - rigid.dynamics(state)[:, rates]
    try:
        return x, np.linalg.solve(B, lacking[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError as error:
        raise PliantError(
            f"plan: the rigid plant's inputs do not reach its coordinates ({error}); give a guess"
        ) from error


def _coordinates(plant: Plant) -> list[int]:
    """Where the rigid plant's coordinates stand in the plant's state; none where it does not know them."""
    rigid, own = plant.ladder()[0], [s.name for s in plant.states]
    shared = rigid.nx == 2 * len(rigid.rates) and all(s.name in own for s in rigid.states)
    return [own.index(name) for name in rigid.rates] if shared else []


def _travelled(plant: Plant, x0: np.ndarray, x_goal: np.ndarray) -> list[int]:
    return [i for i in _coordinates(plant) if x_goal[i] != x0[i]]
