"""From Stable-Baselines3's networks to a Policy's arrays. Imported only where one was trained or is read."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.vec_env import VecNormalize

if TYPE_CHECKING:
    from pliant.controllers.base.scene_protocol import TrainableScene

ALGORITHMS: dict[str, type[BaseAlgorithm]] = {"ppo": PPO, "sac": SAC}
KINDS = {torch.nn.Tanh: "tanh", torch.nn.ReLU: "relu"}


def describe(model: BaseAlgorithm, scene: TrainableScene, statistics: VecNormalize | None) -> dict[str, Any]:
    """Policy's keywords for the deterministic actions of `model`, whose observations `statistics` normalised."""
    actor: Any = model.policy
    if isinstance(model, SAC):
        parts = [*actor.actor.latent_pi, actor.actor.mu]
    else:
        parts = [*actor.mlp_extractor.policy_net, actor.action_net]
    linear = [part for part in parts if isinstance(part, torch.nn.Linear)]
    between = [part for part in parts if not isinstance(part, torch.nn.Linear)]
    kinds = {KINDS.get(type(part), type(part).__name__) for part in between}
    if len(kinds) > 1 or len(between) != len(linear) - 1:
        raise ValueError(f"network of {[type(p).__name__ for p in parts]} must be linear layers with one activation")
    ny, nu = len(scene.observe), scene.plant.nu
    if (linear[0].in_features, linear[-1].out_features) != (ny, nu):
        raise ValueError(
            f"network from {linear[0].in_features} to {linear[-1].out_features} numbers must be from {ny} to {nu} "
            f"for scene {scene.name!r}"
        )
    given = statistics is not None and statistics.norm_obs
    mean, std, clip = np.zeros(ny), np.ones(ny), np.inf
    if given:
        assert statistics is not None
        found: Any = statistics.obs_rms
        mean, std, clip = found.mean, np.sqrt(found.var + statistics.epsilon), statistics.clip_obs
    return {
        "weights": tuple(_array(part.weight) for part in linear),
        "biases": tuple(_array(part.bias) for part in linear),
        "mean": np.array(mean, dtype=float),
        "std": np.array(std, dtype=float),
        "scene": scene.name,
        "reads": scene.observe,
        "goal": scene.goal_values(scene.observe),
        "inputs": tuple(signal.name for signal in scene.plant.inputs),
        "limits": np.array(scene.limits),
        "dt": scene.dt,
        "clip": float(clip),
        "activation": kinds.pop() if kinds else "tanh",
        "squash": isinstance(model, SAC),
    }


def read_zip(path: Path, scene: TrainableScene, algorithm: str, statistics: Path | None) -> dict[str, Any]:
    """`describe` for a zip, and a pickled VecNormalize; the caller has said that both may be trusted."""
    model: Any = _unpickled(lambda: ALGORITHMS[algorithm].load(path, device="cpu"), path)
    found: Any = None
    if statistics is not None:
        found = _unpickled(lambda: VecNormalize.load(str(statistics), scene.sb3_env(1)), statistics)
    return describe(model, scene, found)


def _unpickled(read: Callable[[], Any], path: Path) -> Any:
    """What `read` gives; ValueError, which names the file, for damaged and foreign ones."""
    try:
        return read()
    except (FileNotFoundError, PermissionError):
        raise
    except Exception as error:  # what a damaged pickle raises is anybody's guess
        words = f"{type(error).__name__}: {error}"
        raise ValueError(f"Policy.from_sb3_zip: {str(path)!r} cannot be read: {words}") from None


def _array(tensor: torch.Tensor) -> np.ndarray:
    return tensor.detach().cpu().numpy().astype(float)
