"""A linear-quadratic regulator designed on a scene's plant, run on that plant and on plants that differ.

Stability is told by the sampled loop about the goal: the eigenvalues of A_d - g B_d K S, with S picking what the
regulator reads and g raised from 0 to 1, so that each is known by the mode of the plant that it starts from.
Spillover is a mode that the design model lacks and that the loop makes unstable. A mode that the design model has at
another frequency can grow too, above all where sampling folds the two frequencies apart.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from pliant.controllers import LQR
from pliant.envs.scenes import Scene
from pliant.plants import EquilibriumError, LinearModel, Plant, PliantError, Trajectory, parameters
from pliant.plants.signals import names

from . import points
from .motions import Progress, silent

PAYLOAD = "payload.mass"
FACTORS = (0.5, 1.5)
MANY_MODES = 6  # of each link, in the dearer plant
RTOL = 1e-8
GAINS = 100  # steps in which the feedback is raised
LONG = 8_000  # steps above which the stiff method is cheaper


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
    """The scene's cost as an LQR about its goal, sampled at the control period, within the limits.

    UncontrollableError where the inputs cannot hold the goal or the cost does not see it, EquilibriumError where
    nothing can, because the goal moves.
    """
    limits = np.array(scene.limits)
    Q, R = scene.quadratic()
    law = LQR.for_plant(scene.plant, *scene.target, Q, R, dt=scene.dt, limits=(-limits, limits))
    model = scene.plant.linearize(*scene.target)
    left = "" if scene.goal_at_rest else points.residual(model)
    if left:
        raise EquilibriumError(
            f"the goal of scene {scene.name!r} is no equilibrium, {left} there: a regulator about it would pull back "
            "what has to move on",
            float(np.abs(model.f0).max()),
        )
    return law


def driven_to_goal(scene: Scene) -> tuple[str, ...]:
    """The signals whose end error is told: what the goal names, or what the scene compares where it names nothing."""
    return tuple(name for name, _ in scene.goal) or scene.compare


def variations(scene: Scene) -> list[tuple[str, Plant]]:
    """The scene's plant, with other payloads (without one: the first randomised parameter), and with more modes."""
    plant = scene.plant
    found: list[tuple[str, Plant]] = [("the design plant", plant)]
    loaded = PAYLOAD in parameters.quantities(plant) and parameters.get(plant, PAYLOAD)
    path = PAYLOAD if loaded else next(iter(scene.randomise), (None,))[0]
    if path is not None and parameters.get(plant, path):
        for factor in FACTORS:
            changed = parameters.put(plant, path, factor * parameters.get(plant, path))
            found.append((f"{path} {factor - 1:+.0%}", changed))
    dear = dearer(plant)
    found.append((f"{dear.label}", dear))
    return found


def dearer(plant: Plant) -> Plant:
    """The plant with many modes a link; the finest of its ladder where that adds no state."""
    modes, more = getattr(plant, "modes", None), plant
    if isinstance(modes, tuple):
        many = tuple(max(MANY_MODES, n) for n in modes)
        more = dataclasses.replace(plant, modes=many)  # type: ignore[call-arg]
    elif isinstance(modes, int):
        more = dataclasses.replace(plant, modes=max(MANY_MODES, modes))  # type: ignore[call-arg]
    return more if more.nx > plant.nx else plant.ladder()[-1]


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
        motion = _run(played, law)
    except PliantError as failure:
        return dataclasses.replace(loop, failure=f"{type(failure).__name__}: {failure}")
    told = driven_to_goal(scene)
    goal, ended = scene.goal_values(told), np.array([motion[name][-1] for name in told])
    at_limit = np.isclose(np.abs(motion.u[:-1]), np.array(scene.limits), rtol=1e-9).any(axis=1)
    return dataclasses.replace(
        loop,
        cost=played.cost(motion),
        final_error=float(np.abs(ended - goal).max()),
        saturated=float(at_limit.mean()),
        motion=motion,
    )


def _run(scene: Scene, law: LQR) -> Trajectory:
    plant, x0 = scene.plant, scene.initial[0]
    fastest = np.abs(np.linalg.eigvals(plant.jacobians(*scene.target)[0])).max(initial=0.0)
    # An explicit method of order 8 takes steps of about 5 over the fastest rate
    method = "cvodes" if fastest * scene.duration / 5 > LONG else "dop853"
    return plant.simulate(x0, law, scene.times, method=method, rtol=RTOL, atol=RTOL / 100)


def _stability(scene: Scene, law: LQR, design: Plant) -> tuple[float, str, bool]:
    """(largest |z|, its mode in words, whether the design model lacks it) of the loop about the plant's own goal."""
    plant = scene.plant
    model = plant.linearize(*scene.target)
    sampled = model.discretize(scene.dt)
    known = names(plant.states + plant.outputs)
    rows = np.vstack([np.eye(plant.nx), model.C])
    S = rows[[known.index(name) for name in law.reads]]
    feedback = sampled.B @ law.K[:, : len(law.reads)] @ S
    values = np.linalg.eigvals(sampled.A - feedback)
    k = int(np.argmax(np.abs(values)))
    radius, rate = float(np.abs(values[k])), float(np.log(np.abs(values[k])) / scene.dt)
    size = abs(_origin(model, sampled.A, feedback, values[k], scene.dt)) / (2 * np.pi)
    own, had = model.modes(), design.linearize(*scene.with_plant(design).target).modes()
    number = int(np.argmin([abs(m.frequency_hz - size) for m in own]))
    words = f"mode {number + 1} of the plant, {size:.3g} Hz ({own[number].dominant_state}), "
    words += f"{'grows' if radius >= 1 else 'decays'} at {abs(rate):.3g} 1/s"
    lacking = number >= len(had)
    if radius >= 1 and lacking:
        words += f"; the design model has only {len(had)}"
    elif radius >= 1 and plant is not design:
        words += f"; the design model has it at {had[number].frequency_hz:.3g} Hz"
    return radius, words, lacking


def _origin(model: LinearModel, A: np.ndarray, feedback: np.ndarray, z: complex, dt: float) -> complex:
    """The plant's own eigenvalue [1/s] that becomes z as the feedback is raised from nothing to its full gain."""
    start = model.eigenvalues
    now = np.exp(start * dt)
    for gain in np.linspace(0.0, 1.0, GAINS + 1)[1:]:
        after = np.linalg.eigvals(A - gain * feedback)
        now = after[linear_sum_assignment(np.abs(now[:, None] - after))[1]]
    return complex(start[np.argmin(np.abs(now - z))])
