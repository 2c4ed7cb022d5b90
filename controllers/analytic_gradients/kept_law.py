"""The law that training begins from, as a policy of one layer: what a run ends with where it finds nothing better.

LQR about the goal, u = u0 - K (x - x0) within the limits, is the policy whose one layer has W = -K / limits and
b = u0 / limits, its goal x0; it reads the plant's states. The network reads only what the scene shows, and is what is
wanted where it costs at most CLOSE times as much.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.controllers.base.controller import Controller
from pliant.controllers.learning.policy import Policy
from pliant.controllers.linear_quadratic.lqr import LQR

CLOSE = 1.001
ENOUGH = 3  # times what a run took that learned nothing


def as_policy(law: Controller | None, scene: Any, made: dict[str, Any]) -> Policy | None:
    """The law as a policy; None where it has memory, a goal that moves, or there is none."""
    if not isinstance(law, LQR) or law.drift is not None or len(law.target):
        return None
    limits = np.array(scene.limits)
    if not (np.array_equal(law.limits[0], -limits) and np.array_equal(law.limits[1], limits)):
        return None
    return Policy(
        weights=(-law.K / limits[:, None],),
        biases=(law.u0 / limits,),
        mean=np.zeros(len(law.reads)),
        std=np.ones(len(law.reads)),
        scene=scene.name,
        reads=law.reads,
        goal=law.x0,
        inputs=tuple(signal.name for signal in scene.plant.inputs),
        limits=limits,
        dt=scene.dt,
        made=made,
    )


def words(kept: bool, cost: float, law_cost: float | None, idle: float | None = None) -> str:
    """What is told of a run's policy of this cost beside the law's, both on the scene as it is; `idle`: seconds of a
    run that ended before its first gradient.
    """
    told = _beside(kept, cost, law_cost)
    if idle is None:
        return told
    first = (
        f"no gradient was followed: compiling, playing the scene's law and imitating it took {idle:.0f} s, which were "
        f"all; with {ENOUGH * max(idle, 1.0):.0f} s most of the time is for learning"
    )
    return f"{first}. {told}" if told else first


def _beside(kept: bool, cost: float, law_cost: float | None) -> str:
    if kept:
        return f"no network came near the scene's LQR, {cost:.5g}: that law is kept, which reads the plant's states"
    if law_cost is not None and cost > CLOSE * law_cost:
        return f"on the scene as it is the scene's LQR costs less: {law_cost:.5g}"
    return ""
