"""Which model of a scene's machine each lane plays: drawn for each episode, by shares, from a stream of the lane's own.

The stream is beside those of the episodes' starts: a lane of a seed begins its episodes as it does without a mixture,
and draws the same models whatever the other lanes do.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant
from pliant.plants.core.argument_gates import shown
from pliant.plants.core.signals import OwnsArrays

from .rungs import plant_of, scene_on

Array = np.ndarray
STREAM = 2  # tells a lane's stream from that of its episodes, and of its readings


class Mixture(OwnsArrays):
    """`scenes`, the scene on each model; `rung` (lanes,), which of them each lane plays.

    fidelities: pairs of a word for a model, or a plant, and its share.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> mixture = Mixture(scenes.get("single-link-slew"), (("rigid", 1.0), ("own", 3.0)), 4)
    >>> mixture.labels.tolist(), mixture.shares.tolist()
    (['rigid', 'stiffened, payload 2'], [0.25, 0.75])
    """

    def __init__(self, scene: Scene, fidelities: Sequence[tuple[str | Plant, float]], lanes: int) -> None:
        self.scene, self.lanes = scene, lanes
        self.words = tuple(what if isinstance(what, str) else what.label for what, _ in fidelities)
        plants = [plant_of(scene, what) if isinstance(what, str) else what for what, _ in fidelities]
        for k, plant in enumerate(plants):
            if plant in plants[:k]:
                raise ValueError(f"Task.fidelities: {self.words[k]!r} is {plant.label!r} again, must be another model")
        self.scenes = tuple(scene_on(scene, plant) for plant in plants)
        self.labels = np.array(_distinct([plant.label for plant in plants]))
        self.widths = np.array([plant.nx for plant in plants])
        total = sum(share for _, share in fidelities)
        self.shares = np.array([share / total for _, share in fidelities])
        self.rung = np.zeros(lanes, dtype=np.int64)
        self._streams: list[np.random.Generator | None] = [None] * lanes

    def seed(self, lanes: Sequence[int] | Array, seeds: Sequence[Any]) -> None:
        """From now on the lanes draw from streams of these seeds."""
        for lane, seed in zip(lanes, seeds):
            self._streams[lane] = np.random.default_rng([STREAM, int(seed)])

    def unseeded(self, lanes: Array) -> list[int]:
        """Those of the lanes that have no stream yet."""
        return [lane for lane in lanes.tolist() if self._streams[lane] is None]

    def draw(self, lanes: Array) -> None:
        """New models in the lanes (k,)."""
        ends = np.cumsum(self.shares)[:-1]
        for lane in lanes.tolist():
            stream = self._streams[lane]
            assert stream is not None, "seeded before the first episode"
            self.rung[lane] = np.searchsorted(ends, stream.random(), side="right")

    def index(self, owner: str, word: Any) -> int:
        """Which of the models a label, or the word that it was asked for by, names; ValueError for others."""
        for known in (self.labels.tolist(), self.words):
            if isinstance(word, str) and word in known:
                return list(known).index(word)
        raise ValueError(f"{owner} = {shown(word)} must be one of {', '.join(map(repr, self.labels.tolist()))}")

    def groups(self, lanes: Array) -> list[tuple[int, Array]]:
        """(model, the places in `lanes` (k,) that play it) for each model that is played there."""
        rung = self.rung[lanes]
        return [(g, np.flatnonzero(rung == g)) for g in range(len(self.scenes)) if (rung == g).any()]


def _distinct(labels: list[str]) -> list[str]:
    """Labels, those of plants that differ in numbers alone with their count: "rigid", "rigid (2)"."""
    return [
        label if label not in labels[:k] else f"{label} ({labels[: k + 1].count(label)})"
        for k, label in enumerate(labels)
    ]
