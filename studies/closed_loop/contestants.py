"""Who plays on the scoreboard, and what is played: controllers by name, scenes and scenes with tighter limits."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pliant import controllers
from pliant.controllers import Controller, Policy
from pliant.controllers.linear_quadratic.periodic_lqr import turning
from pliant.envs import scenes
from pliant.envs.scenes.registry import VARIANTS, is_file
from pliant.envs.scenes.scene import Scene
from pliant.plants import EquilibriumError, PliantError
from pliant.plants.core.argument_gates import require_names

from .rollout import nominal, rollout

EFFORTS = (1.0, 3.0, 10.0, 30.0, 100.0)  # times what the scene charges for its inputs
MARGIN = 0.1  # by which controllers are told tighter bounds than those that end a run
Maker = Callable[[Scene], Controller]
LACKS_OF_A_CYCLE = {
    "TVLQR": "cost to go at its nominal's end, nor law after it, that go round with a cycle",
    "MPC": "model, targets and cost to go at its horizon's end that go round with a cycle",
    "NMPC": "cost to go at its horizon's end that goes round with a cycle",
    "LQG": "gains, of its law and of its filter, that go round with a cycle",
}


@dataclass(frozen=True)
class Designed:
    """A class of pliant.controllers, by name: called with a scene, it is designed for it with these options."""

    name: str
    options: tuple[tuple[str, Any], ...] = ()

    def __call__(self, scene: Scene) -> Controller:
        try:
            made: Controller = getattr(controllers, self.name).for_scene(scene, **dict(self.options))
        except EquilibriumError as failure:
            if self.name not in LACKS_OF_A_CYCLE:
                raise
            try:
                angle, rate = turning(scene)
            except PliantError:
                raise failure from None
            raise EquilibriumError(
                f"the goal is a cycle, {scene.plant.states[angle].name} goes round at {rate:.4g} rad/s: {self.name} "
                f"has no {LACKS_OF_A_CYCLE[self.name]}; PeriodicLQR, which plays as LQR, holds it",
                failure.residual,
            ) from None
        return made


def regulator(scene: Scene) -> Controller:
    """LQR about the goal; where that is no point but a cycle, about the cycle."""
    try:
        return controllers.LQR.for_scene(scene)
    except EquilibriumError as failure:
        try:
            return controllers.PeriodicLQR.for_scene(scene)
        except PliantError:
            raise failure from None


def predictive(scene: Scene) -> Controller:
    """That law for inputs that act late."""
    return controllers.Predictive.for_scene(scene, law=regulator(scene))


def enduring(scene: Scene, reads: str = "states") -> Controller:
    """One gain for +-30 % of payload, stiffness and damping, on time and a period late, designed on the scene's own
    plant; its inputs made dearer until it stays within the bounds on that plant as it is, on time and late."""
    for effort in EFFORTS:
        law = controllers.MultiModelLQR.for_scene(scene, reads=reads, effort=effort)
        runs = (rollout(scene, law, dataclasses.replace(nominal(scene), delay=delay)) for delay in law.delays)
        if not any(run.failure for run in runs):
            break
    return law


def enduring_by_sensors(scene: Scene) -> Controller:
    """The same from what sensors read."""
    return enduring(scene, "sensors")


def trained(scene: Scene) -> Controller:
    """The policy that is shipped for the scene. ValueError for a scene without one."""
    return Policy.for_scene(scene.name)


def robust(scene: Scene) -> Controller:
    """The same of one that was trained under delay, noise and other parameters."""
    return Policy.for_scene(scene.name, robust=True)


@dataclass(frozen=True)
class OfSeed:
    """The policy that training with one seed left in `folder`, under SCENE-SEED/policy. ValueError for a scene without
    one."""

    folder: str
    seed: int

    def __call__(self, scene: Scene) -> Controller:
        path = Path(self.folder) / f"{scene.name}-{self.seed}" / "policy.npz"
        if not path.is_file():
            raise ValueError(f"no policy of seed {self.seed} was trained on {scene.name}")
        return Policy.load(path)


CONTESTANTS: Mapping[str, Maker] = {
    "LQR": regulator,
    "LQR, delay known": predictive,
    "TVLQR": Designed("TVLQR"),
    "MPC": Designed("MPC"),
    "NMPC": Designed("NMPC"),
    "LQG": Designed("LQG"),
    "PD": Designed("PD"),
    "PD, shaped": Designed("PD", (("shape", "zvd"),)),
    "computed torque": Designed("ComputedTorque"),
    "multi-model LQR": enduring,
    "multi-model, sensors": enduring_by_sensors,
    "trained policy": trained,
    "robust policy": robust,
}


def designed(scene: Scene, make: Maker) -> Controller | str:
    """The controller, or the reason why there is none. It is told bounds that are tighter by MARGIN.

    A trained policy plays only the limits that it was trained for, and nothing is played at another period than its
    own.
    """
    told = dataclasses.replace(scene, bounds=tuple((name, (1 - MARGIN) * value) for name, value in scene.bounds))
    try:
        made = make(told)
        if isinstance(made, Policy) and not np.array_equal(made.limits, scene.limits):
            raise ValueError(f"it was trained for limits of {made.limits}, the scene's are {np.array(scene.limits)}")
        if made.dt is not None and abs(made.dt - scene.dt) > 1e-9 * scene.dt:
            raise ValueError(f"it acts every {made.dt} s, the scene's period is {scene.dt} s")
    except (PliantError, ValueError) as failure:
        return in_one_line(failure)
    return made


def in_one_line(failure: Exception) -> str:
    """What failed and its message's first line."""
    return f"{type(failure).__name__}: {str(failure).splitlines()[0]}"


def playable(names: tuple[str, ...] | None = None) -> tuple[Scene, ...]:
    """The scenes with inputs, and those with tighter limits, by name or by a scene's file; all where None."""
    known = (*scenes.names(), *VARIANTS)
    wanted = known if names is None else require_names("playable.names", names)
    require_names("playable.names", [name for name in wanted if not is_file(name)], known, "scene")
    found = [scenes.get(name) for name in wanted]
    return tuple(scene for scene in found if scene.plant.nu)
