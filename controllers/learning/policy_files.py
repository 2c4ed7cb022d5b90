"""A policy's files: NAME.npz, which is the policy, and NAME.json, its words once more for people and other programs.

All that is read back stands in the one archive: a kill between the two files leaves the former policy or the new one,
never a mixture. The JSON is then that of another moment, which `load` says. Of version 0.1 (format 1) both files are
read: its archives hold arrays alone.
"""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants.files import sealed_arrays, sealed_json
from pliant.plants.files.atomic_files import Together, require_path

FORMAT = 2
OWNER, KIND = "Policy.load", "policy"
WORDS = (
    "scene", "reads", "goal", "inputs", "limits", "dt", "clip", "activation", "squash", "history", "hold", "middle",
    "reach", "made",
)  # fmt: skip
LATER = {"history": 0, "hold": 1, "middle": None, "reach": None}  # what files may lack, and what it then is
Parts = tuple[dict[str, Any], dict[str, np.ndarray]]  # words as JSON knows them, arrays by name


def parts_of(policy: Any) -> Parts:
    """A Policy's words and arrays."""
    arrays = {f"W{k}": W for k, W in enumerate(policy.weights, 1)}
    arrays |= {f"b{k}": b for k, b in enumerate(policy.biases, 1)}
    arrays |= {"mean": policy.mean, "std": policy.std}
    words = {name: getattr(policy, name) for name in WORDS}
    words |= {"goal": policy.goal.tolist(), "limits": policy.limits.tolist(), "made": dict(policy.made)}
    for name in ("middle", "reach"):
        words[name] = None if words[name] is None else words[name].tolist()
    words["clip"] = None if np.isinf(policy.clip) else float(policy.clip)
    return json.loads(json.dumps(words, allow_nan=False)), arrays


def fields_of(words: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """Policy's keywords from its parts. ValueError where something is missing or unknown."""
    layers = sum(name.startswith("W") for name in arrays)
    words = {**LATER, **words}
    wanted = {"mean", "std", *(f"{kind}{k}" for kind in "Wb" for k in range(1, layers + 1))}
    for what, have, must in (("arrays", set(arrays), wanted), ("words", set(words), set(WORDS))):
        if have != must:
            raise ValueError(f"{what} {sorted(have ^ must)} are missing or unknown")
    for name in ("reads", "inputs"):
        if not isinstance(words[name], list) or not all(isinstance(word, str) for word in words[name]):
            raise ValueError(f"{name} = {words[name]!r} must be names")
    kinds = {"scene": str, "activation": str, "squash": bool, "history": int, "hold": int, "made": dict}
    for name, kind in kinds.items():
        if not isinstance(words[name], kind):
            raise ValueError(f"{name} = {words[name]!r} must be a {kind.__name__}")
    return {
        **words,
        "clip": np.inf if words["clip"] is None else words["clip"],
        "weights": tuple(arrays[f"W{k}"] for k in range(1, layers + 1)),
        "biases": tuple(arrays[f"b{k}"] for k in range(1, layers + 1)),
        "mean": arrays["mean"],
        "std": arrays["std"],
    }


def save(policy: Any, path: str | os.PathLike[str]) -> None:
    """Write both files; the folder is made if missing. OSError, which names the file."""
    words, arrays = parts_of(policy)
    arrays_path, words_path = files(path)
    arrays_path.parent.mkdir(parents=True, exist_ok=True)
    with Together() as together:
        with together.file(arrays_path) as file:
            sealed_arrays.write(file, KIND, FORMAT, words, arrays)
        together.text(words_path, sealed_json.dumps({"format": FORMAT, **words}))


def load(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Policy's keywords. ValueError, which names the file, where one is damaged or something else.

    FileNotFoundError where there is no archive, or, of format 1, no JSON.
    """
    arrays_path, words_path = files(path)
    found = sealed_arrays.load(OWNER, arrays_path, KIND, FORMAT, must=False)
    words: dict[str, Any] = found.about or {}
    if found.about is None:
        words = sealed_json.load(OWNER, words_path, FORMAT)
        if words["format"] > 1:
            raise ValueError(f"{OWNER}: {str(arrays_path)!r} lacks the words that format {words['format']} has")
    elif words_path.exists():
        beside = sealed_json.load(OWNER, words_path, FORMAT)
        if set(beside) | set(LATER) != {*WORDS, "format"}:
            raise ValueError(f"{OWNER}: {str(words_path)!r} holds {sorted(beside)[:9]}, which are no policy's words")
        if {k: v for k, v in words.items() if k != "kind"} != beside:
            warnings.warn(
                f"{str(words_path)!r} belongs to another policy than {arrays_path.name}, which is what is read: "
                "a run was killed between the two files, or one was copied; saving it again makes both the same",
                stacklevel=3,
            )
    words = {name: value for name, value in words.items() if name not in ("kind", "format")}
    try:
        return fields_of(words, found.arrays)
    except ValueError as error:
        raise ValueError(f"{OWNER}: {str(arrays_path)!r}: {error}") from None


def files(path: str | os.PathLike[str]) -> tuple[Path, Path]:
    """The two files of a policy from its name, or from either file's."""
    path = require_path("Policy: path", path)
    stem = path.name.removesuffix(".npz").removesuffix(".json")
    if not stem:
        raise ValueError(f"Policy: path = {str(path)!r} must end with a file's name")
    return path.with_name(stem + ".npz"), path.with_name(stem + ".json")
