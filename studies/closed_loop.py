"""A linear-quadratic regulator designed on a scene's plant, run on that plant and on plants that differ.

Spillover is a mode that the design model lacks and that the loop makes unstable. It is looked for in the
sampled loop about the goal: eigenvalues of A_d - B_d K S, with S picking what the regulator reads.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.controllers import LQR
from pliant.envs.scenes import Scene
from pliant.plants import Plant, PliantError, Trajectory, modal, parameters
from pliant.plants.signals import names

from .motions import Progress, silent

PAYLOAD = "payload.mass"
FACTORS = (0.5, 1.5)
MANY_MODES = 6  # of each link, in the dearer plant
RTOL = 1e-8
LONG = 8_000  # steps above which the stiff method is cheaper


@dataclass(frozen=True)
class Loop:
    """The regulator on one plant. Signals that were driven to the goal: the scene's goal names."""

    name: str
    variant: str
    states: int
    stable: bool | None  # about the goal; None where it could not be told
    radius: float | None  # largest |z| of the sampled loop
    worst_mode: str  # the least damped mode of the loop, or the unstable one
    spillover: bool
    cost: float | None
    final_error: float | None  # largest of the goal's coordinates at the end [rad or m]
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
    """The scene's cost as an LQR about its goal, sampled at the control period, within the limits."""
    limits = np.array(scene.limits)
    Q, R = scene.quadratic()
    return LQR.for_plant(scene.plant, *scene.target, Q, R, dt=scene.dt, limits=(-limits, limits))


def variations(scene: Scene) -> list[tuple[str, Plant]]:
    """The scene's plant, with other payloads (or the first randomised parameter), and with more modes."""
    plant = scene.plant
    found: list[tuple[str, Plant]] = [("the design plant", plant)]
    path = PAYLOAD if PAYLOAD in parameters.quantities(plant) else next(iter(scene.randomise), (None,))[0]
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
        radius, worst, state = _stability(played, law)
        stable = radius < 1
        # A state that the design model lacks, or knows only under another name
        spills = not stable and state not in names(scene.plant.states)
        loop = dataclasses.replace(loop, stable=stable, radius=radius, worst_mode=worst, spillover=spills)
        motion = _run(played, law)
    except PliantError as failure:
        return dataclasses.replace(loop, failure=f"{type(failure).__name__}: {failure}")
    goal = np.array([value for _, value in scene.goal])
    ended = np.array([motion[name][-1] for name, _ in scene.goal])
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


def _stability(scene: Scene, law: LQR) -> tuple[float, str, str]:
    """(largest |z|, its mode in words, its dominant state) of the sampled loop about the plant's own goal."""
    plant = scene.plant
    model = plant.linearize(*scene.target)
    sampled = model.discretize(scene.dt)
    known = names(plant.states + plant.outputs)
    rows = np.vstack([np.eye(plant.nx), model.C])
    S = rows[[known.index(name) for name in law.reads]]
    loop = sampled.A - sampled.B @ law.K[:, : len(law.reads)] @ S
    found = modal.modes(loop, names(plant.states), scene.dt)
    radius = float(np.abs(np.linalg.eigvals(loop)).max())
    worst = max(found, key=lambda m: m.eigenvalue.real)
    # Above half the sampling rate a mode shows a folded frequency: the plant's own mode names it better.
    coordinate = worst.dominant_state.removesuffix("_rate")
    own = [m.frequency_hz for m in model.modes() if m.dominant_state.removesuffix("_rate") == coordinate]
    frequency = own[0] if own and own[0] > 0.5 / scene.dt else worst.frequency_hz
    grows = "grows" if radius >= 1 else "decays"
    words = f"{frequency:.3g} Hz ({worst.dominant_state}) {grows} at {abs(worst.eigenvalue.real):.3g} 1/s"
    return radius, words, worst.dominant_state
