"""The bound: the least that any controller can be charged in a run, told everything beforehand.

A full-information optimal control problem on the played plant: its parameters, disturbance and start are known, and
during the input delay the first input acts, as it does for the controller. Up to local minima, and to the solver's
tolerance, no controller costs less. The search starts from the motion under the scene's LQR, or under its nominal
input where there is none or where it fails.
"""

from __future__ import annotations

import dataclasses
from functools import lru_cache
from typing import Any

import numpy as np

from pliant.controllers.base.objective import Objective
from pliant.controllers.optimal_control.optimal import Motion, optimal
from pliant.envs.scenes.scene import Scene
from pliant.plants import PliantError

from .rollout import Conditions, rollout

ITERATIONS = 200  # of the solver, at most


@lru_cache(maxsize=8)
def _objective(scene: Scene) -> Objective:
    """The scene's objective about its own goal, on the plant whose parameters are inputs."""
    return dataclasses.replace(Objective.of(scene), plant=scene.varied_plant)


def bound(scene: Scene, given: Conditions, law: Any = None) -> tuple[float, np.ndarray, np.ndarray]:
    """(cost, states (steps + 1, nx), inputs (steps, nu)) of the best motion. InfeasibleError where none is found.

    law: a controller of the scene whose motion the search starts from.
    """
    plant, limits = scene.varied_plant, np.array(scene.limits)
    held = np.clip(scene.initial[1], -limits, limits)
    step = plant.stepper(scene.dt, substeps=scene.substeps)
    states, cost = [np.array(given.x)], 0.0
    for _ in range(given.delay):
        y = plant.measure(states[-1], held, w=given.w, p=given.p)
        cost += scene.dt * float(scene.stage_cost(states[-1], held, y))
        states.append(step(states[-1][None], held, given.p, w=given.w)[0].copy())
    left = scene.steps - given.delay
    begin = dataclasses.replace(given, x=states[-1], delay=0, noise=np.zeros(len(given.noise)))
    found: Motion = optimal(
        _objective(scene),
        states[-1],
        left,
        substeps=scene.substeps,
        w=given.w,
        p=given.p,
        guess=_guess(scene, begin, law, left),
        iterations=ITERATIONS,
    )
    u = np.vstack([np.tile(held, (given.delay, 1)), found.u])
    return cost + found.cost, np.vstack([states[:-1], found.x]) if given.delay else found.x, u


def _guess(scene: Scene, begin: Conditions, law: Any, left: int) -> tuple[np.ndarray, np.ndarray] | None:
    """States (left + 1, nx) and inputs (left, nu) of a motion from `begin`; None where none stays within the bounds."""
    for chosen in (law, _Nominal(scene)):
        if chosen is None:
            continue
        try:
            run = rollout(scene, chosen, begin)
        except PliantError:  # the guess is for speed only
            continue
        if not run.failure:
            return run.signals[: left + 1, : scene.plant.nx], run.u[:left]
    return None


class _Nominal:
    """The scene's nominal input, as a controller."""

    def __init__(self, scene: Scene) -> None:
        self.dt, self.reads, self._law = scene.dt, (), scene.nominal_input

    def reset(self) -> None:
        """Nothing to forget."""

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) at time t."""
        return self._law(t)
