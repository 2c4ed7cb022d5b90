"""How a policy is judged while it learns and after: the scene's own cost, and what a run keeps of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pliant.controllers.base.joint_reference import values_of
from pliant.controllers.base.scene_protocol import TrainableScene, require_scene
from pliant.plants.core.argument_gates import require_instance
from pliant.plants.files import sealed_json

from .policy import Policy
from .settings import CURVE_FORMAT


@dataclass(frozen=True)
class Evaluation:
    """The deterministic policy on the scene as it is: nothing drawn at random. `cost` is in the scene's own unit."""

    steps: int  # of training so far
    seconds: float  # of training so far
    cost: float  # the scene's, with the charge for an early end


@dataclass(frozen=True)
class Training:
    """What a run made: `policy` is the one that did best of those evaluated. `seconds` is what it took [s].

    A run of "apg" never ends more than a permille above the law that it began from, on the scene as it is and without
    delay and noise in training: where no network does better, `policy` is that law, as one layer that reads the plant's
    states, and `words` say so.
    """

    policy: Policy
    cost: float  # of `policy`
    curve: tuple[Evaluation, ...]
    steps: int
    seconds: float  # since `train` was called, and what former runs took where this one went on
    rate: float  # environment steps a second of this run, learning and evaluations included
    threads: str  # how many torch used, and why
    law_cost: float | None = None  # of the scene's LQR, played in the same way; None where none was asked
    words: str = ""  # what a reader must know of the policy; empty where it did better than the law


def read_curve(path: str | Path) -> tuple[Evaluation, ...]:
    """The evaluations of a run, from the curve.json in its folder.

    ValueError, which names the file, where it is damaged or something else.

    Example
    -------
    >>> try:
    ...     read_curve("curve.json")
    ... except OSError as error:
    ...     print(type(error).__name__)
    FileNotFoundError
    """
    told = sealed_json.load("read_curve", path, CURVE_FORMAT)
    try:
        found = tuple(Evaluation(**point) for point in told["curve"])
        if not all(isinstance(v, (int, float)) for point in found for v in (point.steps, point.seconds, point.cost)):
            raise TypeError("an evaluation is steps, seconds and cost")
    except (KeyError, TypeError) as error:
        raise ValueError(f"read_curve: {str(path)!r} holds no curve: {error}") from None
    return found


def evaluate(policy: Policy, scene: TrainableScene, env: Any = None) -> float:
    """The scene's cost under the policy, by its environment: RK4 and the charge for an early end.

    env: one lane of the scene that may be used again, made where not given. The cost is in the scene's own unit. A
    policy that reads other signals than the scene shows is given the plant's own.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> from pliant.controllers import Policy
    >>> bool(evaluate(Policy.for_scene("single-link-slew"), scenes.get("single-link-slew")) < 5.0)
    True
    """
    require_instance("evaluate.policy", policy, Policy)
    require_scene("evaluate", scene, ("plant", "observe", "limits", "dt", "stage_cost"))
    env = scene.vector_env(1, threads=1) if env is None else env
    goal = scene.goal_values(scene.observe)
    obs, _ = env.reset()
    cost, u = 0.0, scene.initial[1]
    policy.reset()
    for k in range(scene.steps):
        observed = policy.reads == scene.observe
        y = obs[0] + goal if observed else values_of(scene.plant, env.states[0], u, policy.reads)
        u = policy.act(k * scene.dt, y)
        obs, reward, terminated, truncated, _ = env.step((u / policy.limits)[None])
        cost -= float(reward[0])
        if terminated[0] or truncated[0]:
            break
    return cost
