"""Train a policy on a scene by reinforcement learning; Stable-Baselines3 learns, what comes out needs only NumPy.

`train` imports Stable-Baselines3 and torch when it is called, not before; `pip install "pliant[rl]"` brings them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pliant.plants.core.parameters import require_choice, require_count

from .policy import Policy

if TYPE_CHECKING:
    from pliant.controllers.base.scene_protocol import TrainableScene

Progress = Callable[[float, str], None]
SECONDS = 300.0  # what a run may take where nothing is said
CURVE, POLICY = "curve.json", "policy"


@dataclass(frozen=True, kw_only=True)
class PPOSettings:
    """Proximal policy optimisation on many short rollouts. Found by trial on this package's scenes."""

    num_envs: int = 1024
    n_steps: int = 20  # control periods of a rollout
    batch_size: int = 4096
    n_epochs: int = 4
    learning_rate: float = 1e-3  # at first; it falls linearly to FLOOR of it
    gamma: float = 0.98  # a control period's discount
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    noise: float = 0.135  # first standard deviation of the actions, of the limits
    width: int = 64  # units of each of two tanh layers
    spread: float = 1.5  # of training's starts: times the largest distance from start to goal


@dataclass(frozen=True, kw_only=True)
class SACSettings:
    """Soft actor-critic: fewer steps, each dearer."""

    num_envs: int = 64
    buffer_size: int = 500_000
    batch_size: int = 512
    gradient_steps: int = 8  # after each control period of all lanes
    learning_starts: int = 20_000  # steps before the first
    learning_rate: float = 1e-3
    gamma: float = 0.99
    tau: float = 0.01  # of the target networks' moving average
    width: int = 64  # units of each of two ReLU layers
    spread: float = 1.5


FLOOR = 0.02  # share of the learning rate that is left at the end
SETTINGS: dict[str, type[PPOSettings] | type[SACSettings]] = {"ppo": PPOSettings, "sac": SACSettings}


@dataclass(frozen=True)
class Evaluation:
    """The deterministic policy on the scene as it is: nothing drawn at random."""

    steps: int  # of training so far
    seconds: float  # of training so far
    cost: float  # the scene's, with the charge for an early end


@dataclass(frozen=True)
class Training:
    """What a run made: `policy` is the one that did best of those evaluated."""

    policy: Policy
    cost: float  # of `policy`
    curve: tuple[Evaluation, ...]
    steps: int
    seconds: float  # since `train` was called, and what former runs took where this one went on
    rate: float  # environment steps a second of this run, learning and evaluations included
    threads: str  # how many torch used, and why


def train(
    scene: TrainableScene,
    algorithm: str = "ppo",
    *,
    seed: int = 0,
    seconds: float | None = None,
    steps: int | None = None,
    num_envs: int | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    threads: int | None = None,
    settings: PPOSettings | SACSettings | None = None,
    command: str = "",
    progress: Progress | None = None,
) -> Training:
    """Learn to play `scene` with "ppo" or "sac", for so many `seconds` (300 by default) or `steps` of all lanes.

    folder    gets policy.npz and policy.json (the best so far), curve.json and the checkpoint, all renewed at every
              evaluation. resume=True goes on from its checkpoint; `seconds` and `steps` count from the first start.
              Nothing in the folder is a pickle
    num_envs  lanes; the algorithm's own number where not given
    threads   of torch; where not given, one on a busy machine, else as many as measure fastest
    progress  told a share in [0, 1] and a few words; pliant.studies.train shows them as a bar
    command   kept in the policy, for whoever wants to make it again

    With `steps` the same seed gives the same policy on the same machine with the same `threads`. Global generators
    and torch's threads are left as they were found. ValueError for bad input; ImportError without
    Stable-Baselines3.
    """
    require_choice("train", "algorithm", algorithm, tuple(SETTINGS))
    require_count("train", "seed", seed, 0, 2**32 - 1)
    if seconds is not None and steps is not None:
        raise ValueError(f"train: seconds = {seconds} and steps = {steps}: give one of them")
    if seconds is None and steps is None:
        seconds = SECONDS
    if seconds is not None and not 0 < seconds < float("inf"):
        raise ValueError(f"train: seconds = {seconds!r} must be finite and > 0")
    if steps is not None:
        require_count("train", "steps", steps, 1, 10**12)
    if threads is not None:
        require_count("train", "threads", threads, 1, 1024)
    if resume and folder is None:
        raise ValueError("train: resume = True needs the folder of the run to go on with")
    chosen = SETTINGS[algorithm]() if settings is None else settings
    if not isinstance(chosen, SETTINGS[algorithm]):
        raise ValueError(f"train: settings = {type(chosen).__name__} must be {SETTINGS[algorithm].__name__}")
    if num_envs is not None:
        require_count("train", "num_envs", num_envs, 1, 1_000_000)
        chosen = dataclasses.replace(chosen, num_envs=num_envs)
    if not scene.observe:
        raise ValueError(f"scene {scene.name!r}: observe = () must name at least one signal")
    if not scene.plant.nu:
        raise ValueError(f"scene {scene.name!r}: its plant has no inputs, so there is nothing to learn")
    if not _installed():
        raise ImportError('training needs Stable-Baselines3 and torch: pip install "pliant[rl]"')
    from .training import learn

    return learn(
        scene,
        algorithm,
        chosen,
        seed=seed,
        seconds=seconds,
        steps=steps,
        folder=None if folder is None else Path(folder),
        resume=resume,
        threads=threads,
        command=command,
        progress=progress or _silent,
    )


def evaluate(policy: Policy, scene: TrainableScene, env: Any = None) -> float:
    """The scene's cost under the policy, by its environment: RK4 and the charge for an early end.

    env: one lane of the scene that may be used again, made where not given.
    """
    env = scene.vector_env(1, threads=1) if env is None else env
    goal = scene.goal_values(scene.observe)
    obs, _ = env.reset()
    cost = 0.0
    policy.reset()
    for k in range(scene.steps):
        u = policy.act(k * scene.dt, obs[0] + goal)
        obs, reward, terminated, truncated, _ = env.step((u / policy.limits)[None])
        cost -= float(reward[0])
        if terminated[0] or truncated[0]:
            break
    return cost


def _installed() -> bool:
    from importlib.util import find_spec

    return find_spec("stable_baselines3") is not None and find_spec("torch") is not None


def _silent(share: float, words: str) -> None:
    """Tell nobody."""
