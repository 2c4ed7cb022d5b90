"""Who plays on the scoreboard, and what is played: controllers by name, scenes and scenes with tighter limits."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from pliant import controllers
from pliant.controllers import Controller, Policy
from pliant.controllers.base.goal_model import goal_model
from pliant.controllers.cycles.cycle import turning
from pliant.controllers.robust_design.many_model_lqr import box_of
from pliant.envs import scenes
from pliant.envs.scenes.registry import VARIANTS, is_file
from pliant.envs.scenes.scene import Scene
from pliant.plants import EquilibriumError, PliantError
from pliant.plants.core.argument_gates import require_names

from .evaluation_scene import play
from .rollout import nominal, rollout

LATE = (0, 1)  # periods
EFFORTS = (1.0, 3.0, 10.0, 30.0, 100.0)  # times what the scene charges for its inputs
MARGIN = 0.1  # by which controllers are told tighter bounds than those that end a run
Maker = Callable[[Scene], Controller]
IN_A_CYCLE = {  # what plays where the goal is no point but a cycle
    "LQR": "PeriodicLQR.for_scene",
    "TVLQR": "PeriodicTVLQR.for_scene",
    "MPC": "PeriodicMPC.for_scene",
    "NMPC": "periodic_nmpc",
    "LQG": "PeriodicLQG.for_scene",
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
            if self.name not in IN_A_CYCLE or not goes_round(scene):
                raise failure
            made = attrgetter(IN_A_CYCLE[self.name])(controllers)(scene, **dict(self.options))
        return made


def goes_round(scene: Scene) -> bool:
    """Whether the goal is a cycle, and no point even of what the cost sees."""
    try:
        goal_model(scene)
    except EquilibriumError:
        try:
            turning(scene)
        except EquilibriumError:
            return False
        return True
    return False


def regulator(scene: Scene) -> Controller:
    """LQR about the goal; where that is no point but a cycle, about the cycle."""
    return Designed("LQR")(scene)


def predictive(scene: Scene) -> Controller:
    """That law for inputs that act late."""
    return controllers.Predictive.for_scene(scene, law=regulator(scene))


def enduring(scene: Scene, reads: str = "states") -> Controller:
    """One gain for +-30 % of payload, stiffness and damping, on time and a period late, designed on the scene's own
    plant; its inputs made dearer until it stays within the bounds on that plant, as it is and with all that is
    uncertain at its least and at its most, on time and late; or led along a nominal motion that keeps a reserve of
    them, where that lasts and costs less. About a cycle the periodic gain, by sensors on a periodic filter."""
    if goes_round(scene):
        return enduring_cycle(scene, reads)
    played = play(scene)
    candidates: list[tuple[float, Controller]] = []
    law: Controller
    for effort in EFFORTS:
        law = controllers.MultiModelLQR.for_scene(scene, reads=reads, effort=effort)
        cost = _cost_if_it_lasts(played, law, law.delays)
        if effort == 1.0:
            first = law
            if cost is not None:
                return law
        elif cost is not None:
            candidates.append((cost, law))
            break
    try:
        led = controllers.Led.for_scene(scene, first)
        if (cost := _cost_if_it_lasts(played, led, first.delays)) is not None:
            candidates.append((cost, led))
    except PliantError:
        pass
    return min(candidates, key=lambda pair: pair[0])[1] if candidates else law


def enduring_cycle(scene: Scene, reads: str) -> Controller:
    """The same about a cycle."""
    ranges = box_of(scene, None, "enduring")
    if reads == "states":
        return lasting(scene, lambda e: controllers.PeriodicLQR.for_scene(scene, effort=e, delay=LATE, ranges=ranges))
    return lasting(scene, lambda e: controllers.PeriodicLQG.for_scene(scene, effort=e, input_delay=LATE, ranges=ranges))


def _cost_if_it_lasts(played: Scene, law: Controller, delays: Sequence[int]) -> float | None:
    """Mean over the extremes, None where one fails."""
    own, p = nominal(played), played.varied_plant.nominal_parameters
    ends = np.array([(1.0, low, high) for _, low, high in played.randomise]).reshape(-1, 3).T
    costs = []
    for end in ends:
        for delay in delays:
            run = rollout(played, law, dataclasses.replace(own, p=p * end, delay=delay))
            if run.failure:
                return None
            costs.append(run.cost)
    return float(np.mean(costs))


def enduring_by_sensors(scene: Scene) -> Controller:
    """The same from what sensors read."""
    return enduring(scene, "sensors")


def robust_lqg(scene: Scene) -> Controller:
    """LQG whose noises were chosen for +-30 % and inputs on time or a period late. Where that is refused, as about a
    goal that is no point of all states, LQG whose inputs were made dearer until it lasts: see `lasting_lqg`."""
    try:
        return controllers.robust_lqg(scene).law
    except PliantError as refused:
        try:
            return lasting_lqg(scene)
        except PliantError:
            raise refused from None


def lasting_lqg(scene: Scene) -> Controller:
    """`lasting` LQG; about a cycle, for inputs on time and late."""
    late = (("input_delay", LATE),) if goes_round(scene) else ()
    return lasting(scene, lambda e: Designed("LQG", (("effort", e), *late))(scene))


def lasting(scene: Scene, design: Callable[[float], Controller]) -> Controller:
    """The law whose inputs cost the least of EFFORTS with which it stays within the bounds on the scene's own plant, as
    it is and with all that is uncertain at its least and at its most, on time and late; without noise. PliantError
    where none does."""
    played = play(scene)
    for effort in EFFORTS:
        law = design(effort)
        if _cost_if_it_lasts(played, law, LATE) is not None:
            return law
    raise PliantError(
        f"{type(law).__name__} stays within the bounds of scene {scene.name!r} with inputs at none of {EFFORTS} times "
        "the price"
    )


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
    "LQR, delay 0 to 1": Designed("LQR", (("delay", (0, 1)),)),
    "TVLQR": Designed("TVLQR"),
    "MPC": Designed("MPC"),
    "MPC, delay 0 to 1": Designed("MPC", (("delay", (0, 1)),)),
    "tube MPC": Designed("TubeMPC"),
    "NMPC": Designed("NMPC"),
    "LQG": Designed("LQG"),
    "robust LQG": robust_lqg,
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
