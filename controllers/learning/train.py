"""Train a policy on a scene, by exact gradients or by reinforcement learning; what comes out needs only NumPy.

"apg" needs no more either. For "ppo" and "sac" Stable-Baselines3 and torch are loaded when `train` is called, not
before; `pip install "pliant[rl]"` brings them.
"""

from __future__ import annotations

import dataclasses
from importlib.util import find_spec
from pathlib import Path

from pliant.controllers.base.scene_protocol import TrainableScene, require_scene
from pliant.plants.core.argument_gates import (
    require_choice,
    require_count,
    require_flag,
    require_function,
    require_path,
    require_seconds,
    require_text,
    shown,
)

from .evaluation import Training
from .settings import LEARNERS, SECONDS, SETTINGS, APGSettings, Progress, Settings

TRAINABLE = ("plant", "observe")  # what is asked for first


def train(
    scene: TrainableScene,
    algorithm: str | None = None,
    *,
    seed: int = 0,
    seconds: float | None = None,
    steps: int | None = None,
    num_envs: int | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    threads: int | None = None,
    settings: Settings | None = None,
    command: str = "",
    progress: Progress | None = None,
) -> Training:
    """Learn to play `scene` with "apg", "ppo" or "sac", for so many `seconds` or `steps` of all lanes.

    "apg", analytic policy gradients, differentiates whole episodes through the plant's native step, from a network that
    does what the scene's LQR does. It ends at most a permille above that law on the scene as it is, where it has to by
    keeping it, and says so in `words`; `law_cost` is what the law costs. Other laws may be cheaper still. It
    takes 60 s where nothing is said, the others 300. Where no algorithm is named it is that of the `settings`, else
    "apg", or "ppo" where the scene's goal moves.

    folder    gets the checkpoint, policy.npz and policy.json (the best so far) and curve.json, all renewed at every
              evaluation, each whole whenever the run is killed. resume=True goes on from the checkpoint and writes the
              rest from it; `seconds` and `steps` count from the first start. Nothing in the folder is a pickle
    num_envs  lanes; the algorithm's own number where not given
    threads   of torch; where not given, one on a busy machine, else as many as measure fastest
    progress  told a share in [0, 1] and a few words; `pliant train` shows them as a bar
    command   kept in the policy, for whoever wants to make it again

    With `steps` the same seed gives the same policy on the same machine with the same `threads`; with "apg" also where
    the run was killed and went on. Global generators and torch's threads are left as they were found. ValueError for
    bad input; ImportError where Stable-Baselines3 is asked for and missing.

    Example
    -------
    >>> from pliant.controllers import rl
    >>> found = rl.train(scene, steps=20_000)
    >>> round(found.cost, 1)
    3.5
    """
    require_scene("train", scene, TRAINABLE)
    if algorithm is None:
        given = [name for name, kind in SETTINGS.items() if isinstance(settings, kind)]
        algorithm = given[0] if given else "ppo" if getattr(scene, "goal_rates", ()) else "apg"
    require_choice("train", "algorithm", algorithm, tuple(SETTINGS))
    seed = require_count("train", "seed", seed, 0, 2**32 - 1)
    if seconds is not None and steps is not None:
        raise ValueError(f"train: seconds = {shown(seconds)} and steps = {shown(steps)}: give one of them")
    if seconds is None and steps is None:
        seconds = SECONDS[algorithm]
    seconds = None if seconds is None else require_seconds("train.seconds", seconds)
    steps = None if steps is None else require_count("train", "steps", steps, 1, 10**12)
    threads = None if threads is None else require_count("train", "threads", threads, 1, 1024)
    folder = None if folder is None else require_path("train.folder", folder)
    resume, command = require_flag("train.resume", resume), require_text("train.command", command, empty=True)
    if progress is not None:
        require_function("train.progress", progress)
    if resume and folder is None:
        raise ValueError("train: resume = True needs the folder of the run to go on with")
    chosen = SETTINGS[algorithm]() if settings is None else settings
    if not isinstance(chosen, SETTINGS[algorithm]):
        raise ValueError(f"train: settings = {type(chosen).__name__} must be {SETTINGS[algorithm].__name__}")
    if num_envs is not None:
        num_envs = require_count("train", "num_envs", num_envs, 1, 1_000_000)
        chosen = dataclasses.replace(chosen, num_envs=num_envs)
    if not scene.observe:
        raise ValueError(f"scene {scene.name!r}: observe = () must name at least one signal")
    if not scene.plant.nu:
        raise ValueError(f"scene {scene.name!r}: its plant has no inputs, so there is nothing to learn")
    if isinstance(chosen, APGSettings):
        if threads not in (None, 1):
            raise ValueError(f"train: threads = {threads}: apg uses no torch and one thread")
        return LEARNERS["apg"].learn(
            scene,
            chosen,
            seed=seed,
            seconds=seconds,
            steps=steps,
            folder=folder,
            resume=resume,
            command=command,
            progress=progress or _silent,
        )
    if not _installed():
        raise ImportError('training needs Stable-Baselines3 and torch: pip install "pliant[rl]"')
    from .training import learn  # the door to torch, which takes seconds to load: nothing before it needs that

    return learn(
        scene,
        algorithm,
        chosen,
        seed=seed,
        seconds=seconds,
        steps=steps,
        folder=folder,
        resume=resume,
        threads=threads,
        command=command,
        progress=progress or _silent,
    )


def _installed() -> bool:
    return find_spec("stable_baselines3") is not None and find_spec("torch") is not None


def _silent(share: float, words: str) -> None:
    """Tell nobody."""
