"""The state of a training run in one archive: networks, optimisers, statistics, the best policy. No pickle.

One file, because its parts are worth nothing without each other: a kill leaves the former moment or the new one. What
else stands in a run's folder (policy, curve) follows from it.

Random generators and the lanes' states are not kept: a run that goes on draws new ones, so it does not repeat what
an uninterrupted run would have done. Nor is SAC's replay buffer: it fills again before learning goes on.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.vec_env import VecNormalize

from pliant.plants.files import sealed_arrays, sealed_json

from . import policy_files
from .policy import Policy

ARRAYS = "checkpoint.npz"
WORDS = "checkpoint.json"  # of format 1, version 0.1: there the words stand in a file of their own
KIND, FORMAT = "checkpoint", 2
BEST = "best/"  # the best policy's arrays


def exists(folder: Path) -> bool:
    """Whether a run has left its state here."""
    return (folder / ARRAYS).exists() or (folder / WORDS).exists()


def save(folder: Path, model: BaseAlgorithm, env: VecNormalize, words: dict[str, Any], best: Policy) -> None:
    """Write the file, whole or not at all; `words` is what the caller wants back."""
    arrays: dict[str, np.ndarray] = {}
    state = _flatten({"model": model.get_parameters(), "variables": _variables(model)}, "", arrays)
    for name in ("mean", "var", "count"):
        arrays[f"observations.{name}"] = np.asarray(getattr(env.obs_rms, name))
    stamp = int(model.num_timesteps)
    arrays["stamp"] = np.array(stamp)
    best_words, best_arrays = policy_files.parts_of(best)
    arrays |= {f"{BEST}{name}": value for name, value in best_arrays.items()}
    content = {"stamp": stamp, "state": state, "best": best_words, **words}
    sealed_arrays.save(folder / ARRAYS, KIND, FORMAT, content, arrays)
    (folder / WORDS).unlink(missing_ok=True)  # version 0.1's, which is now of another moment


def read_words(folder: Path) -> dict[str, Any]:
    """What `save` was given, with `stamp` (time steps done) and `state`. ValueError where there is no checkpoint."""
    return _read(folder)[0]


def _read(folder: Path) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    try:
        found = sealed_arrays.load("resume", folder / ARRAYS, KIND, FORMAT, must=False)
        words = sealed_json.load("resume", folder / WORDS, 1) if found.about is None else found.about
    except FileNotFoundError as error:
        raise ValueError(f"resume: {str(folder)!r} holds no checkpoint ({Path(error.filename).name})") from None
    wanted = {"stamp", "state", "scene", "algorithm", "best_cost", "spent", "curve"}
    if not wanted <= set(words):
        raise ValueError(f"resume: {str(folder / ARRAYS)!r} lacks {sorted(wanted - set(words))}")
    return words, found.arrays


def best_of(folder: Path) -> Policy | None:
    """The best policy at the checkpoint's moment; None of version 0.1, where only the policy's own files have it."""
    words, arrays = _read(folder)
    if "best" not in words:
        return None
    own = {name.removeprefix(BEST): value for name, value in arrays.items() if name.startswith(BEST)}
    try:
        return Policy(**policy_files.fields_of(words["best"], own))
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"resume: {str(folder / ARRAYS)!r} holds no policy: {error}") from None


def restore(folder: Path, words: dict[str, Any], model: BaseAlgorithm, env: VecNormalize) -> None:
    """Put the saved state into a fresh model and its environment."""
    _, arrays = _read(folder)
    try:
        if int(arrays["stamp"]) != words["stamp"]:
            raise ValueError("its arrays and words are of different moments")
        state = _gather(words["state"], arrays)
        model.set_parameters(state["model"])
        for name, value in state["variables"].items():
            getattr(model, name).data.copy_(value)
        for name in ("mean", "var", "count"):
            setattr(env.obs_rms, name, np.array(arrays[f"observations.{name}"])[()])
    except Exception as error:  # torch has its own
        raise ValueError(f"resume: {str(folder / ARRAYS)!r} does not fit: {error}") from None
    model.num_timesteps = int(words["stamp"])


def _variables(model: BaseAlgorithm) -> dict[str, torch.Tensor]:
    names = model._get_torch_save_params()[1]
    return {name: getattr(model, name) for name in names if getattr(model, name, None) is not None}


def _flatten(value: Any, path: str, arrays: dict[str, np.ndarray]) -> Any:
    """The value with its tensors put into `arrays` and named: {"array": path}; keys that are numbers are marked."""
    if isinstance(value, torch.Tensor):
        arrays[path] = value.detach().cpu().numpy()
        return {"array": path}
    if isinstance(value, dict):
        return {"items": [[k, _flatten(v, f"{path}/{k}", arrays)] for k, v in value.items()]}
    if isinstance(value, (list, tuple)):
        return [_flatten(v, f"{path}/{i}", arrays) for i, v in enumerate(value)]
    return value


def _gather(value: Any, arrays: dict[str, np.ndarray]) -> Any:
    if isinstance(value, dict):
        if "array" in value:
            return torch.from_numpy(np.array(arrays[value["array"]]))
        return {k: _gather(v, arrays) for k, v in value["items"]}
    if isinstance(value, list):
        return [_gather(v, arrays) for v in value]
    return value
