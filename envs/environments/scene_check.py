"""`pliant check scene.toml`: whether a scene can be played, clause by clause, in words."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np

from pliant.envs.scenes.nominal_inputs import beyond_limits, far_from_goal, unheld
from pliant.envs.scenes.scene import Scene
from pliant.plants import NominalWarning, PliantError
from pliant.plants.contract.check import Checked, ContractError
from pliant.plants.core.argument_gates import require_instance
from pliant.plants.dynamics.equilibrium import growth_at_rest

from .env import PlantEnv

Array = np.ndarray


def check_scene(scene: Scene) -> Checked:
    """Play a scene once: its start and goal on every rung of the plant's ladder, its nominal inputs and their motion
    at the control period's own RK4 steps, one step of its environment.

    ContractError, which lists every fault in words. The plant's own word is `pliant.plants.check`'s.

    >>> print(check_scene(scene))
    scene 'single-link-slew'
      start        at rest without inputs
      goal         at rest without inputs
      rungs        start and goal on 10 of 10
      nominal      inputs within the limits
      open loop    runs, within the bounds
      environment  4 observations, one step runs
    """
    require_instance("check_scene.scene", scene, Scene)
    faults: list[str] = []
    found: list[tuple[str, str]] = []

    def clause(title: str, play: Callable[[], str]) -> bool:
        """Whether a clause holds; whatever is raised is a fault of the scene."""
        try:
            found.append((title, play()))
        except Exception as failed:
            faults.append(f"{title}: {' '.join(str(failed).split()) or type(failed).__name__}")
            return False
        return True

    rests = [clause(field, lambda field=field: _rest(scene, field)) for field in ("start", "goal")]  # type: ignore[misc]
    if all(rests):
        clause("rungs", lambda: _rungs(scene))
        if clause("nominal", lambda: _inputs(scene)):
            clause("open loop", lambda: _motion(scene))
        clause("environment", lambda: _step(scene))
    if faults:
        raise ContractError(
            "\n  ".join([f"scene {scene.name!r} cannot be played as it stands:", *faults]), tuple(faults)
        )
    return Checked(f"scene {scene.name!r}", tuple(found))


def _rest(scene: Scene, field: str) -> str:
    """The start or the goal, with what holds it."""
    x, u = scene.initial if field == "start" else scene.target
    if not (np.isfinite(x).all() and np.isfinite(u).all()):
        raise ValueError("has numbers that are not finite")
    signals = list(zip(scene.plant.inputs, u, scene.limits, strict=True))
    if more := [f"{s.name} = {v:.4g} {s.unit} (limit {most:g})" for s, v, most in signals if abs(v) > most]:
        raise ValueError(f"its rest takes {', '.join(more)}")
    held = ", ".join(f"{s.name} = {v:.4g} {s.unit}" for s, v, _ in signals if abs(v) > 1e-9)
    at_rest = scene.start_at_rest if field == "start" else scene.goal_at_rest
    if not at_rest:
        return "as given"
    grows = growth_at_rest(scene.plant, x, u)
    return (f"at rest with {held}" if held else "at rest without inputs") + (f"; unstable: {grows}" if grows else "")


def _rungs(scene: Scene) -> str:
    """Start and goal of every variant of the plant; of all but the cheapest some may lack them."""
    rungs, lacking = scene.plant.ladder(), []
    for k, rung in enumerate(rungs):
        played = scene.with_plant(rung)
        try:
            _ = played.initial, played.target
        except PliantError:
            if k == 0:
                raise
            lacking.append(repr(rung.label))
    told = f"start and goal on {len(rungs) - len(lacking)} of {len(rungs)}"
    return f"{told}; not on {', '.join(lacking)}" if lacking else told


def _inputs(scene: Scene) -> str:
    """The nominal inputs, within the limits."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NominalWarning)  # a fault here
        inputs = scene.nominal_input
    if beyond := beyond_limits(scene, inputs):
        raise ValueError(f"inputs beyond the limits: {beyond}; raise `limits`, or lengthen `move_time`")
    return "inputs within the limits"


def _motion(scene: Scene) -> str:
    """The open-loop motion, near the goal where it is made for it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NominalWarning)
        motion = scene.open_loop(method="rk4", step=scene.dt / scene.substeps)
    far = far_from_goal(scene, motion)
    if far and (held := unheld(scene)):
        return f"does not arrive: {far}; {held}"
    if far:
        raise ValueError(f"does not arrive: {far}; a longer move_time, or [motion] of its own")
    if scene.drive is None and scene.duration < scene.move_time and scene.start != scene.goal:
        raise ValueError(
            f"duration = {scene.duration:g} s ends it before it arrives, must be at least move_time = "
            f"{scene.move_time:g} s"
        )
    left = [
        f"{n} = {np.abs(motion[n]).max():.4g} (bound {b:g})" for n, b in scene.bounds if np.abs(motion[n]).max() > b
    ]
    return f"leaves bounds: {', '.join(left)}" if left else "runs, within the bounds"


def _step(scene: Scene) -> str:
    """One step of the scene's environment."""
    if not scene.observe:
        return "none: observe names nothing"
    env = PlantEnv(scene)
    seen, _ = env.reset(seed=0)
    after, reward, *_ = env.step(np.zeros(scene.plant.nu, np.float32))
    if not (np.isfinite(seen).all() and np.isfinite(after).all() and np.isfinite(float(reward))):
        raise ValueError("one step without inputs gives no numbers")
    return f"{len(seen)} observations, one step runs"
