"""A linear-quadratic regulator designed on a scene's plant, run on that plant and on plants that differ.

Stability is told by the sampled loop about the goal, the modes named and told apart as in
controllers/analysis/spillover.py.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.controllers import LQR, Controller
from pliant.controllers.analysis.spillover import case_of
from pliant.controllers.base.goal_model import goal_model
from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant, PliantError, Trajectory
from pliant.plants.core import parameters
from pliant.plants.native import kernel_loader
from pliant.studies.common.processor_time import processor_time
from pliant.studies.common.reference_motions import Progress, silent

PAYLOAD = "payload.mass"
FACTORS = (0.5, 1.5)
MANY_MODES = 6  # of each link, in the dearer plant
RTOL = 1e-8
LONG = 8_000  # steps above which the stiff method is cheaper on the virtual machine ..
LONG_COMPILED = 200_000  # .. and in compiled code, which it has none of
PATIENCE = 20.0  # [s] that a run may take


@dataclass(frozen=True)
class Loop:
    """The regulator on one plant."""

    name: str
    variant: str
    states: int
    stable: bool | None  # about the goal; None where it could not be told
    radius: float | None  # largest |z| of the sampled loop
    worst_mode: str  # the least damped mode of the loop, or the unstable one
    spillover: bool
    cost: float | None
    final_error: float | None  # largest of the signals `driven_to_goal` at the end [their unit]
    saturated: float | None  # share of control times at a limit
    failure: str | None = None
    motion: Trajectory | None = field(default=None, repr=False)

    def to_json(self) -> dict[str, Any]:
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(self) if f.name != "motion"}

    @property
    def verdict(self) -> str:
        """In words."""
        if self.stable is None:
            return f"not known: {self.failure}"
        if self.stable:
            return f"stable, largest |z| {self.radius:.4f}"
        why = "unstable by spillover" if self.spillover else "unstable"
        return f"{why}: {self.worst_mode}"


def regulator(scene: Scene) -> LQR:
    """`LQR.for_scene`, which makes every LQR of a scene: UncontrollableError where the inputs cannot hold the goal or
    the cost does not see it, EquilibriumError where the goal moves otherwise than its `goal_rates` say.
    """
    return LQR.for_scene(scene)


def driven_to_goal(scene: Scene) -> tuple[str, ...]:
    """The signals whose end error is told: what the goal names, or what the scene compares where it names nothing.

    For a quaternion the attitude's outputs, where they are weighed.
    """
    named = tuple(name for name, _ in scene.goal if name not in scene.plant.attitude_states)
    moved = tuple(name for name, _ in scene.goal_rates)
    attitude = tuple(name for name in scene.weighted if name in scene.plant.attitude_outputs)
    return (*attitude, *moved, *(() if attitude else named)) or scene.compare


def variations(scene: Scene) -> list[tuple[str, Plant]]:
    """The scene's plant, with other payloads (without one: the first randomised parameter, or that is uncertain), and
    with more modes where there are more.
    """
    plant = scene.plant
    found: list[tuple[str, Plant]] = [("the design plant", plant)]
    loaded = PAYLOAD in parameters.quantities(plant) and parameters.get(plant, PAYLOAD)
    others = (*(path for path, _, _ in scene.randomise), *plant.uncertain)
    path = PAYLOAD if loaded else next(iter(others), None)
    if path is not None and parameters.get(plant, path):
        for factor in FACTORS:
            changed = parameters.put(plant, path, factor * parameters.get(plant, path))
            found.append((f"{path} {factor - 1:+.0%}", changed))
    if (dear := dearer(plant)) != plant:
        found.append((f"{dear.label}", dear))
    return found


def dearer(plant: Plant) -> Plant:
    """The plant with many modes a link; where that adds no state the finest of its ladder, of its own kinematics where
    there is one.
    """
    modes, more = getattr(plant, "modes", None), plant
    if isinstance(modes, tuple):
        many = tuple(max(MANY_MODES, n) for n in modes)
        more = dataclasses.replace(plant, modes=many)  # type: ignore[call-arg]
    elif isinstance(modes, int):
        more = dataclasses.replace(plant, modes=max(MANY_MODES, modes))  # type: ignore[call-arg]
    if more.nx > plant.nx:
        return more
    own = getattr(plant, "kinematics", None)
    finer = [rung for rung in plant.ladder() if rung.nx > plant.nx and getattr(rung, "kinematics", None) == own]
    return (*plant.ladder(), *finer)[-1]


def closed_loop(
    scene: Scene, law: LQR | None = None, *, progress: Progress | None = None
) -> tuple[LQR, tuple[Loop, ...]]:
    """The regulator and its loops, the design plant first."""
    told, law = progress or silent, law or regulator(scene)
    cases = variations(scene)
    loops = []
    for i, (case, plant) in enumerate(cases):
        told(i / len(cases), case)
        loops.append(_loop(scene, law, case, plant))
    told(1.0, "closed loop")
    return law, tuple(loops)


def _loop(scene: Scene, law: LQR, name: str, plant: Plant) -> Loop:
    played = scene.with_plant(plant)
    loop = Loop(name, plant.label, plant.nx, None, None, "", False, None, None, None)
    try:
        radius, worst, lacking = _stability(played, law, scene.plant)
        stable = radius < 1
        loop = dataclasses.replace(
            loop, stable=stable, radius=radius, worst_mode=worst, spillover=lacking and not stable
        )
        motion = run(played, law)
    except PliantError as failure:
        return dataclasses.replace(loop, failure=f"{type(failure).__name__}: {failure}")
    at_limit = np.isclose(np.abs(motion.u[:-1]), np.array(scene.limits), rtol=1e-9).any(axis=1)
    return dataclasses.replace(
        loop,
        cost=played.cost(motion),
        final_error=end_error(scene, motion),
        saturated=float(at_limit.mean()),
        motion=motion,
    )


def end_error(scene: Scene, motion: Trajectory) -> float:
    """Largest distance from the goal at the motion's end of the signals `driven_to_goal` [their unit]."""
    told = driven_to_goal(scene)
    goal = scene.goal_values(told) + scene.goal_drift(told) * motion.t[-1]
    ended = np.array([motion[name][-1] for name in told])
    return float(np.abs(ended - goal).max())


def run(scene: Scene, law: Controller, *, patience: float = PATIENCE) -> Trajectory:
    """The scene under a controller that reads the true signals; raises what simulation or controller raise, and
    PliantError where it takes longer than `patience` [s] of processor time.
    """
    plant, x0, began = scene.plant, scene.initial[0], processor_time()
    fastest = np.abs(np.linalg.eigvals(plant.jacobians(*scene.target)[0])).max(initial=0.0)
    # An explicit method of order 8 takes steps of about 5 over the fastest rate
    steps, most = fastest * scene.duration / 5, LONG_COMPILED if kernel_loader.wanted() else LONG

    def reached(t: float) -> None:
        spent = processor_time() - began
        if spent > patience and t < scene.times[-1]:
            raise PliantError(
                f"given up: its first {t:.3g} of {scene.duration:g} s have taken {spent:.0f} s of "
                f"processor time, of which it has {patience:g}; its fastest mode asks for {steps:.2g} steps"
            )

    options: dict[str, Any] = {"rtol": RTOL, "atol": RTOL / 100, "progress": reached}
    return plant.simulate(x0, law, scene.times, method="cvodes" if steps > most else "dop853", **options)


def _stability(scene: Scene, law: LQR, design: Plant) -> tuple[float, str, bool]:
    """(largest |z|, its mode in words, whether the design model lacks it) of the loop about the plant's own goal."""
    model, own = goal_model(scene)[0], scene.plant is design
    case = case_of(model, law, model if own else goal_model(scene.with_plant(design))[0])
    return float(np.exp(case.growth * scene.dt)), case.mode, case.lacking
