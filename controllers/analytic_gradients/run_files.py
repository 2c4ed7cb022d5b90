"""The state of a run in one archive, after which it goes on exactly as it would have."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from pliant.controllers.learning import policy_files
from pliant.controllers.learning.policy import Policy
from pliant.plants.files import sealed_arrays

from .adam import Adam

ARRAYS, KIND, FORMAT = "checkpoint.npz", "checkpoint", 2  # as of the other algorithms, which tell by their words
BEST, READ = "best/", "std"
WANTED = {"scene", "algorithm", "settings", "seed", "stamp", "adam", "random", "spent", "curve", "best", "best_score"}


def exists(folder: Path) -> bool:
    """Whether a run has left its state here."""
    return (folder / ARRAYS).exists()


def save(
    folder: Path, words: dict[str, Any], adam: Adam, rng: np.random.Generator, std: np.ndarray, best: Policy
) -> None:
    """Write the file, whole or not at all."""
    best_words, best_arrays = policy_files.parts_of(best)
    arrays = {**adam.arrays(), READ: std, **{f"{BEST}{name}": value for name, value in best_arrays.items()}}
    content = {**words, "state": {}, "adam": adam.words(), "random": rng.bit_generator.state, "best": best_words}
    sealed_arrays.save(folder / ARRAYS, KIND, FORMAT, content, arrays)


def load(folder: Path) -> tuple[dict[str, Any], Adam, np.random.Generator, np.ndarray, Policy]:
    """What `save` was given. ValueError, which names the file, where there is none, or another algorithm's."""
    path = folder / ARRAYS
    try:
        found = sealed_arrays.load("resume", path, KIND, FORMAT, must=False)
    except FileNotFoundError:
        raise ValueError(f"resume: {str(folder)!r} holds no checkpoint ({ARRAYS})") from None
    words = found.about or {}
    if words.get("algorithm") != "apg":
        raise ValueError(f"resume: the checkpoint's algorithm = {words.get('algorithm')!r} must be 'apg'")
    if not set(words) >= WANTED:
        raise ValueError(f"resume: {str(path)!r} lacks {sorted(WANTED - set(words))}")
    own = {name.removeprefix(BEST): value for name, value in found.arrays.items() if name.startswith(BEST)}
    rng = np.random.default_rng()
    try:
        rng.bit_generator.state = words["random"]
        best = Policy(**policy_files.fields_of(words["best"], own))
        return words, Adam.again(found.arrays, words["adam"]), rng, np.array(found.arrays[READ]), best
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"resume: {str(path)!r} does not fit: {error}") from None
