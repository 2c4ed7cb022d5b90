"""How an episode starts: parameters and start drawn at random, the plant at rest there where the scene says so."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, cast

import casadi as ca
import numpy as np

from pliant.envs.scenes.scene import Scene, once_per_scene
from pliant.plants import EquilibriumError
from pliant.plants.core.errors import unstable_rests_untold
from pliant.plants.dynamics.equilibrium import with_joints
from pliant.plants.native.batch_kernels import CHECKED, random_points

from .control_period import observe_function, reference
from .row_kernels import Iteration, Rows

TOLERANCE = 1e-9  # relative change of a Newton step whose successor would only move rounding errors
STEPS, MOST_ROUNDS = 6, 5  # Newton steps between looks at their size, and how often is looked
SMALL = 1e-3  # [m, rad, N m] below which a change counts absolutely


def draw(scene: Scene, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(starts (n, len(scene.start)), w (n, nw), p (n, np)) of n episodes.

    Uniform within the start's spread, the gusts and the parameters' factors.
    """
    return _scaled(scene, [rng.random((n, count)) for count in _counts(scene)])


def draw_each(
    scene: Scene, generators: Sequence[np.random.Generator], counts: Sequence[int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `draw`, so many episodes from each generator: those that `draw(scene, generator, 1)` gives one by one."""
    sizes = _counts(scene)
    width = sum(sizes)
    shares = np.concatenate([rng.random(count * width) for rng, count in zip(generators, counts)]).reshape(-1, width)
    return _scaled(scene, np.split(shares, np.cumsum(sizes)[:-1], axis=1))


def _counts(scene: Scene) -> list[int]:
    """How many numbers an episode draws: for its start, its parameters and its disturbances, in this order."""
    return [len(scene.start), len(scene.varied_plant.varied), scene.plant.nw]


def _scaled(scene: Scene, shares: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(starts, w, p) from shares (n, count) in [0, 1) of their ranges, in the order of `_counts`."""
    own, low, high = _ranges(scene)
    of_start, of_p, of_w = shares
    starts = own + scene.spread * (2.0 * of_start - 1.0)
    return starts, scene.largest_gusts * (2.0 * of_w - 1.0), low + (high - low) * of_p


def begin(scene: Scene, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(x (n, nx), obs (n, no), w (n, nw), p (n, np)) of n randomised episodes, from where drawn."""
    return _begun(scene, *draw(scene, rng, n))


def begin_each(
    scene: Scene, generators: Sequence[np.random.Generator], counts: Sequence[int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """As `begin`, so many episodes from each generator: those that `draw(scene, generator, 1)` gives one by one."""
    return _begun(scene, *draw_each(scene, generators, counts))


def _begun(
    scene: Scene, starts: np.ndarray, w: np.ndarray, p: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    x = initial_states(scene, starts, p)
    return x, first_observations(scene, x, p), w, p


def first_observations(scene: Scene, x: np.ndarray, p: np.ndarray, goal: Scene | None = None) -> np.ndarray:
    """obs (n, no) at states x (n, nx), before any input or disturbance; less the goal's values in the scene `goal`,
    where that is another one.
    """
    n, ref = len(x), reference(scene if goal is None else goal)
    still = np.zeros((n, scene.plant.nu)), np.tile(ref, (n, 1)), np.zeros((n, scene.plant.nw))
    return _observing(scene)(x, *still, p)[0]


def early_end_cost(scene: Scene, done: Any, cost: Any) -> Any:
    """What an episode that ends after `done` periods, its last one costing `cost`, is charged for the time left."""
    return (scene.steps - done) * (scene.dt * scene.early_end_rate + cost)


def initial_states(scene: Scene, starts: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Rest states (n, nx) with the coordinates of scene.start held at the rows of `starts`, for p (n, np).

    Newton's method on the statics, all lanes at once, from the scene's own start. Raises EquilibriumError.
    Where the scene does not start at rest, its own start with the rows of `starts` written into it, a quaternion made
    unit.
    """
    starts, p = np.asarray(starts, dtype=float), np.asarray(p, dtype=float)
    plant = scene.varied_plant
    for name, value, width in (("starts", starts, len(scene.start)), ("p", p, len(plant.varied))):
        if value.ndim != 2 or value.shape[1] != width or len(value) != len(starts):
            raise ValueError(f"initial_states: {name} has shape {value.shape}, must be (n, {width})")
        if not np.isfinite(value).all():
            raise ValueError(f"initial_states: {name} must be finite")
    if not scene.start_at_rest:
        x = np.tile(scene.initial[0], (len(starts), 1))
        x[:, scene.positions(name for name, _ in scene.start)] = starts
        return plant.consistent(x)
    return rest_points(scene, starts, p)[0]


def rest_points(scene: Scene, starts: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(x (n, nx), u (n, nu)) at rest with the coordinates of scene.start held at the rows of `starts`."""
    plant = scene.varied_plant
    if plant.statics() is None or plant.prescribed or len(scene.start) != plant.nu:
        given = ({name: v for (name, _), v in zip(scene.start, row)} for row in starts)
        with unstable_rests_untold():
            found = [plant.equilibrium(with_joints(plant, row), p=q) for row, q in zip(given, p)]
        x, u = (np.array(part) for part in zip(*found)) if found else (np.zeros(0), np.zeros(0))
        return x.reshape(-1, plant.nx), u.reshape(-1, plant.nu)

    columns, free = _split(scene)
    x0, u0 = scene.initial
    z = np.tile(np.concatenate([x0[free], u0]), (len(starts), 1))
    moving = np.arange(len(starts))  # a lane stops on its own: its digits depend on no other lane
    for _ in range(MOST_ROUNDS):
        z[moving], change = _newton(scene)(z[moving], starts[moving], p[moving], count=STEPS)
        moving = moving[~((np.abs(change) / (np.abs(z[moving]) + SMALL)).max(axis=1) < TOLERANCE)]
        if not len(moving):
            break
    else:
        k = int(moving[0])
        held = ", ".join(f"{name} = {value:.4g}" for (name, _), value in zip(scene.start, starts[k]))
        worst = float(np.abs(change).max())
        raise EquilibriumError(
            f"scene {scene.name!r} has no rest state with {held} and p = {p[k]}: Newton's steps still change "
            f"it by {worst:.3g}; narrow start_spread or randomise",
            worst,
        )
    x = np.zeros((len(starts), plant.nx))
    x[:, columns], x[:, free] = starts, z[:, : len(free)]
    return x, z[:, len(free) :]


@once_per_scene
def _split(scene: Scene) -> tuple[list[int], list[int]]:
    """Indices of the coordinates that scene.start holds, and of the others."""
    held = scene.positions(name for name, _ in scene.start)
    coordinates = scene.positions(tuple(scene.plant.rates))
    return held, [i for i in coordinates if i not in held]


@once_per_scene
def _ranges(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The start's own values, and the least and largest values of the randomised parameters."""
    own = np.array([value for _, value in scene.start])
    low, high = np.array([pair for _, *pair in scene.randomise]).reshape(-1, 2).T
    nominal = scene.varied_plant.nominal_parameters
    return own, nominal * low, nominal * high


@once_per_scene
def _observing(scene: Scene) -> Rows:
    return Rows(observe_function(scene), partial(_observed_points, scene))


def _observed_points(scene: Scene, rng: np.random.Generator) -> list[np.ndarray]:
    _, x, u, w, p = random_points(scene.varied_plant, rng)
    return [x, u, np.tile(reference(scene)[:, None], x.shape[1]), w, p]


@once_per_scene
def _newton(scene: Scene) -> Iteration:
    """(z, start, p) -> Newton's change of z = [free coordinates; inputs] towards no net force at rest."""
    plant = scene.varied_plant
    t, x, u, w, p = plant.symbols
    columns, free = _split(scene)
    z, start = ca.SX.sym("z", len(free) + plant.nu), ca.SX.sym("start", len(columns))
    rest = ca.SX.zeros(plant.nx)
    rest[columns] = start
    if free:  # a rigid arm has none
        rest[free] = z[: len(free)]
    force = cast(ca.SX, plant.statics())
    at_rest = ca.vertcat(0, rest, z[len(free) :], ca.SX.zeros(plant.nw))
    force = ca.substitute(force, ca.vertcat(t, x, u, w), at_rest)
    newton = ca.Function("newton", [z, start, p], ca.cse([-ca.solve(ca.jacobian(force, z), force)]))
    return Iteration(newton, partial(_starting_points, scene))


def _starting_points(scene: Scene, rng: np.random.Generator) -> list[np.ndarray]:
    free = _split(scene)[1]
    own = np.concatenate([scene.initial[0][free], scene.initial[1]])[:, None]
    starts, _, ps = draw(scene, rng, CHECKED)
    return [own + 0.01 * rng.uniform(-1, 1, (len(own), CHECKED)), starts.T, ps.T]
