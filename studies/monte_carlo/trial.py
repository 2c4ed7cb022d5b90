"""One run: parameters drawn by seed and number, the loop's growth there, and the scene played."""

from __future__ import annotations

import dataclasses
import threading
from typing import Any

import numpy as np

from pliant.controllers import Controller
from pliant.controllers.analysis.linear_laws import law_of
from pliant.controllers.analysis.loops import closed_loop
from pliant.envs.scenes.scene import Scene
from pliant.plants import PliantError
from pliant.studies.closed_loop.rollout import Conditions, reading_noise, rollout
from pliant.studies.closed_loop.scores import score

Row = dict[str, Any]
PLAYING = threading.Lock()  # threads of one process share the controller and the buffers of a scene's kernel
MEASURED = ("growth", "cost", "settling", "peak", "residual", "at_limit", "beyond", "effort")


def drawn(scene: Scene, seed: int, number: int) -> np.ndarray:
    """Parameters (np,), each uniform between its factors times its own value. By (seed, number) alone."""
    low, high = (np.array([one[i] for one in scene.randomise], dtype=float) for i in (1, 2))
    factors = np.random.default_rng([seed, number]).uniform(low, high)
    return np.asarray(factors * scene.varied_plant.nominal_parameters)


def growth(scene: Scene, law: Controller, p: np.ndarray) -> float | None:
    """[1/s] of the slowest mode of the linear loop at the goal under parameters p (np,); None: the law has no linear
    form, or the goal's model none."""
    try:
        model = scene.varied_plant.feedback_model(*scene.target, p=p)
        poles = np.linalg.eigvals(closed_loop(model, law_of(law))).astype(complex)
    except (PliantError, ValueError):
        return None
    if law.dt is None:
        return float(poles.real.max())
    return float(np.log(np.maximum(np.abs(poles).max(), 1e-300)) / law.dt)


def trial(scene: Scene, law: Controller, seed: int, number: int, noise: bool, delay: int) -> Row:
    """What one run comes to, plain values."""
    p = drawn(scene, seed, number)
    plant = scene.varied_plant
    levels = reading_noise(scene) if noise else np.zeros(plant.nx + plant.ny)
    given = Conditions(x=scene.initial[0], w=np.zeros(plant.nw), p=p, noise=levels, delay=delay, seed=(seed, number))
    with PLAYING:
        found = dataclasses.asdict(score(scene, rollout(scene, law, given)))
    parameters = dict(zip(plant.varied, p.tolist(), strict=True))
    values = {name: None if value is None else float(value) for name, value in found.items() if name != "failure"}
    row: Row = {"number": number, "parameters": parameters, "failure": found["failure"], **values}
    return row | {"growth": growth(scene, law, p)}
