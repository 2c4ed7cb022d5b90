"""The state of a training run as arrays plus JSON: networks, optimisers, statistics. No pickle.

Random generators and the lanes' states are not kept: a run that goes on draws new ones, so it does not repeat what
an uninterrupted run would have done. Nor is SAC's replay buffer: it fills again before learning goes on.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.vec_env import VecNormalize

ARRAYS, WORDS = "checkpoint.npz", "checkpoint.json"


def save(folder: Path, model: BaseAlgorithm, env: VecNormalize, words: dict[str, Any]) -> None:
    """Write both files, each whole or not at all; `words` is what the caller wants back."""
    arrays: dict[str, np.ndarray] = {}
    state = _flatten({"model": model.get_parameters(), "variables": _variables(model)}, "", arrays)
    for name in ("mean", "var", "count"):
        arrays[f"observations.{name}"] = np.asarray(getattr(env.obs_rms, name))
    stamp = int(model.num_timesteps)
    arrays["stamp"] = np.array(stamp)
    content = {"stamp": stamp, "state": state, **words}
    with (folder / f".{ARRAYS}").open("wb") as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]
    (folder / f".{WORDS}").write_text(json.dumps(content, allow_nan=False) + "\n")
    for name in (ARRAYS, WORDS):
        os.replace(folder / f".{name}", folder / name)


def read_words(folder: Path) -> dict[str, Any]:
    """What `save` was given, with `stamp` (time steps done) and `state`. ValueError where there is no checkpoint."""
    path = folder / WORDS
    if not path.is_file():
        raise ValueError(f"resume: {str(folder)!r} holds no checkpoint ({WORDS})")
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"resume: {WORDS} cannot be read: {error}") from None


def restore(folder: Path, words: dict[str, Any], model: BaseAlgorithm, env: VecNormalize) -> None:
    """Put the saved state into a fresh model and its environment."""
    try:
        with np.load(folder / ARRAYS, allow_pickle=False) as found:
            arrays = {name: found[name] for name in found.files}
        if int(arrays["stamp"]) != words["stamp"]:
            raise ValueError(f"{ARRAYS} and {WORDS} are of different moments")
        state = _gather(words["state"], arrays)
        model.set_parameters(state["model"])
        for name, value in state["variables"].items():
            getattr(model, name).data.copy_(value)
        for name in ("mean", "var", "count"):
            setattr(env.obs_rms, name, arrays[f"observations.{name}"][()])
    except Exception as error:  # numpy, torch and zipfile each have their own
        raise ValueError(f"resume: {ARRAYS} does not fit: {error}") from None
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
