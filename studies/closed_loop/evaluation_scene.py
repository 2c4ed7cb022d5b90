"""The scene that a controller is scored on: its own, on a plant that knows more than the design model.

The rule   every elastic body gets one more mode, a body of a tree one more of each family in which it bends, twists or
           stretches: the plant then holds the first mode that the design model leaves out, the one that spillover is
           about. Where a body holds no more modes, the next variant of the plant's ladder. Shapes and parameters stay,
           so that states of the same name are the same quantities. A tree whose mass matrix would be lost where the
           design plant moves under LQR (what second-order shortening leaves of the added shapes' inertia) has exact
           rotations in the place of that shortening.
Varied     what the plant calls uncertain (payload, stiffness, damping), each by +-30 %, beside what the scene itself
           randomises
Steps      RK4, as many in a control period as the fastest mode and the accuracy of the compared outputs ask for
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant, PliantError
from pliant.plants.core import parameters
from pliant.plants.core.signals import names
from pliant.plants.integration.step_maps import step_limit
from pliant.plants.multibody_parts.tree_body import MOST_MODES, TreeBody

from .closed_loop import regulator, run

SPREAD = 0.3  # of payload, stiffness and damping
CORNERS = 64  # parameter corners at which the step limit is looked at, at most
SAFE = 0.7  # share of RK4's step limit that is used
ACCURATE = 0.1  # largest error by the step in the compared outputs, in tolerances of the scene
MOST_SUBSTEPS = 4096
SAME = 1e-3  # relative difference of what an output gains from a state that both plants have


def finer(plant: Plant) -> Plant:
    """The plant one fidelity higher, by the rule above. ValueError where there is none."""
    found = _one_more_mode(plant)
    if found is not None and found.nx > plant.nx:
        return found
    ladder = plant.ladder()
    rest = ladder[ladder.index(plant) + 1 :] if plant in ladder else ()
    for variant in rest:
        if variant.nx >= plant.nx:
            return variant
    raise ValueError(f"{type(plant).__name__} ({plant.label}) is the finest that there is")


def finer_plant(scene: Scene) -> tuple[Plant, str]:
    """(the scene's plant one fidelity higher, a remark). ValueError where there is none."""
    plant: Any = finer(scene.plant)
    if not hasattr(plant, "bodies") or plant.kinematics != "stiffened" or _holds(scene, plant):
        return plant, ""
    remark = "With exact rotations, as with second-order shortening the mass matrix is lost on what LQR plays"
    return dataclasses.replace(plant, kinematics="strain"), remark


def _holds(scene: Scene, plant: Any) -> bool:
    """Whether the mass matrix is positive definite in all states through which the design plant goes under LQR."""
    try:
        motion = run(scene, regulator(scene))
    except PliantError:  # nobody knows where it would go
        return True
    M = plant.mass_matrix(motion.x @ plant.embedding(scene.plant).T)
    size = np.diagonal(M, axis1=1, axis2=2)
    if not (size > 0).all():
        return False
    unit = M / np.sqrt(size[:, :, None] * size[:, None, :])
    return bool(np.linalg.eigvalsh(unit)[:, 0].min() > 0)


def _one_more_mode(plant: Any) -> Plant | None:
    if hasattr(plant, "appendages"):
        return dataclasses.replace(plant, appendages=tuple(_longer(a) for a in plant.appendages))
    if hasattr(plant, "bodies"):
        return dataclasses.replace(plant, bodies=tuple(_richer(b) for b in plant.bodies))
    modes = getattr(plant, "modes", None)
    if modes is None:
        return None
    more = tuple(n + 1 for n in modes) if isinstance(modes, tuple) else modes + 1
    return dataclasses.replace(plant, modes=more)


def _longer(appendage: Any) -> Any:
    """The appendage with one more mode; itself where its modal data hold no more."""
    modes = appendage.modes
    if isinstance(modes, tuple):  # of a boom: in x-y, whose modes come last
        return dataclasses.replace(appendage, modes=(modes[0] + 1, *modes[1:]))
    if modes is None or modes >= getattr(appendage.body, "n", modes + 1):
        return appendage
    return dataclasses.replace(appendage, modes=modes + 1)


def _richer(body: TreeBody) -> TreeBody:
    """The body of a tree with one more shape in each family that it has, or one more of its modes."""
    if body.modal is not None and body.modal_modes:
        return dataclasses.replace(body, modal_modes=min(body.modal_modes + 1, body.modal.n))
    if body.beam is None:
        return body
    return dataclasses.replace(body, modes=tuple(min(n + 1, MOST_MODES) if n else 0 for n in body.modes))


def differing_states(design: Scene, played: Scene) -> tuple[str, ...]:
    """Names of states that both plants have but that are not the same quantity in both.

    Told by the outputs that inputs do not move at once: what each gains from the state, at the design model's goal with
    its bodies straight (bent, exact rotations gain a little else than second-order shortening), must agree.
    """
    known, plants = names(design.plant.states), (design.plant, played.plant)
    x = np.zeros(played.plant.nx)
    both = [name for name in names(played.plant.states) if name in known]
    places = [[names(plant.states).index(name) for name in both] for plant in plants]
    kept = {name for name, _ in (*design.goal, *design.goal_rates)} | set(design.plant.attitude_states)
    goal = np.where([name in kept for name in known], design.target[0], 0.0)
    x[places[1]] = goal[places[0]]
    slopes = [plant.jacobians(at)[3:] for plant, at in zip(plants, (goal, x), strict=True)]
    known = names(played.plant.outputs)
    outputs = [name for name, row in zip(names(design.plant.outputs), slopes[0][1]) if name in known and not row.any()]
    rows = [[names(plant.outputs).index(name) for name in outputs] for plant in plants]
    mine, theirs = (C[row][:, place] for (C, *_), row, place in zip(slopes, rows, places, strict=True))
    apart = np.abs(mine - theirs).max(axis=0, initial=0.0) > SAME * np.abs(mine).max(axis=0, initial=1e-12)
    return tuple(name for name, other in zip(both, apart, strict=True) if other)


def varied_ranges(scene: Scene, spread: float = SPREAD) -> tuple[tuple[str, float, float], ...]:
    """(parameter, smallest, largest factor): the plant's `uncertain` ones by +-spread, and the scene's own others."""
    own = {path: (low, high) for path, low, high in scene.randomise}
    own |= {path: (1 - spread, 1 + spread) for path in scene.plant.uncertain if parameters.get(scene.plant, path)}
    return tuple((path, low, high) for path, (low, high) in own.items())


@lru_cache(maxsize=32)
def play(scene: Scene, plant: Plant | None = None) -> Scene:
    """The scene on `plant` (None: its own), with the varied parameters and enough substeps.

    The plant must have the inputs and the named signals of the scene.
    """
    plant = scene.plant if plant is None else plant
    found = dataclasses.replace(scene, plant=plant)
    found = dataclasses.replace(found, randomise=varied_ranges(found))
    return dataclasses.replace(found, substeps=max(scene.substeps, stable_substeps(found)))


def harsher(scene: Scene) -> Scene:
    """The scene as the scoreboard's hardest columns play it, but for delay and noise: the plant one fidelity higher
    where there is one, its uncertain parameters +-30 %, other starts. What a policy that must survive is trained on.
    """
    try:
        plant = finer_plant(scene)[0]
    except ValueError:
        plant = scene.plant
    return accurate(play(scene, plant))[0]


def stable_substeps(scene: Scene) -> int:
    """RK4 steps in a control period that keep SAFE below the step limit, at start and goal, for all parameters."""
    plant = scene.varied_plant
    factors = [(low, high) for _, low, high in scene.randomise]
    limit = np.inf
    for corner in itertools.islice(itertools.product(*factors), CORNERS):
        p = plant.nominal_parameters * np.array(corner)
        for x, u in (scene.initial, scene.target):
            limit = min(limit, step_limit(plant, x, "rk4", u=u, p=p))
    return min(max(1, int(np.ceil(scene.dt / (SAFE * limit)))), MOST_SUBSTEPS)


def step_error(scene: Scene) -> float:
    """Largest change of the compared outputs [their unit] when the open-loop motion is played with half the step.

    RK4 is of order 4: the error that is left is a fifteenth of it.
    """
    places = [names(scene.plant.outputs).index(name) for name in scene.compare]
    coarse, fine = (_open_loop(scene, scene.substeps * k)[1][:, places] for k in (1, 2))
    return float(np.abs(coarse - fine).max())


def signal_ranges(scene: Scene) -> np.ndarray:
    """How far each state and output (nx + ny,) moves under the nominal input: highest less lowest value."""
    return np.ptp(np.hstack(_open_loop(scene, scene.substeps)), axis=0)


def _open_loop(scene: Scene, substeps: int) -> tuple[np.ndarray, np.ndarray]:
    """States (steps + 1, nx) and outputs (steps + 1, ny) under the nominal input held over each control period."""
    plant = scene.varied_plant
    step = plant.stepper(scene.dt, substeps=substeps)
    x = np.array(scene.initial[0], ndmin=2)
    states, limits = [x[0].copy()], np.array(scene.limits)
    for t in scene.times[:-1]:
        x = step(x, np.clip(scene.nominal_input(float(t)), -limits, limits), t=float(t))
        states.append(x[0].copy())
    motion = np.array(states)
    if not np.isfinite(motion).all():
        raise PliantError(f"scene {scene.name!r} on {plant.label}: the nominal input makes it diverge")
    return motion, plant.measure(motion)


@lru_cache(maxsize=32)
def accurate(scene: Scene) -> tuple[Scene, float]:
    """The scene with so many substeps that halving the step changes no compared output by ACCURATE tolerances.

    Returned with that change. PliantError where MOST_SUBSTEPS do not suffice.
    """
    while True:
        error = step_error(scene)
        if error <= ACCURATE * scene.tolerance:
            return scene, error
        if 2 * scene.substeps > MOST_SUBSTEPS:
            raise PliantError(
                f"scene {scene.name!r} on {scene.plant.label}: {scene.substeps} steps a control period leave an error "
                f"of {error:.3g}, must be {ACCURATE * scene.tolerance:.3g}"
            )
        scene = dataclasses.replace(scene, substeps=2 * scene.substeps)


def require_signals(reads: Sequence[str], design: Scene, played: Scene) -> None:
    """ValueError where a controller reads what the played plant does not have, or has as another quantity."""
    known, label = names(played.signals), played.plant.label
    missing = [name for name in reads if name not in known]
    if missing:
        raise ValueError(f"it reads {', '.join(missing)}, which {label} does not have")
    changed = [name for name in reads if name in differing_states(design, played)]
    if changed:
        raise ValueError(f"it reads {', '.join(changed)}, which in {label} is another shape's coordinate")
