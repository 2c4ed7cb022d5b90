"""How an episode starts: parameters and start drawn at random, the plant at rest there."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from pliant.plants import EquilibriumError, LagrangianPlant
from pliant.plants.functions import NumericFunction, function

from .scene import Scene

LANES = 16  # of a call: one mapped function serves every number of lanes
TOLERANCE = 1e-9  # relative change of a Newton step whose successor would only move rounding errors
MOST_STEPS = 30
SMALL = 1e-3  # [m, rad, N m] below which a change counts absolutely


def draw(scene: Scene, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    """(starts (n, len(scene.start)), p (n, np)): uniform within start_spread and the parameters' factors."""
    own = np.array([value for _, value in scene.start])
    starts = own + scene.start_spread * rng.uniform(-1.0, 1.0, (n, len(own)))
    low, high = np.array([pair for _, *pair in scene.randomise]).reshape(-1, 2).T
    return starts, scene.varied_plant.nominal_parameters * rng.uniform(low, high, (n, len(low)))


def initial_states(scene: Scene, starts: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Rest states (n, nx) with the coordinates of scene.start held at the rows of `starts`, for p (n, np).

    Newton's method on the statics, all lanes at once, from the scene's own start. Raises EquilibriumError.
    """
    starts, p = np.asarray(starts, dtype=float), np.asarray(p, dtype=float)
    plant = scene.varied_plant
    for name, value, width in (("starts", starts, len(scene.start)), ("p", p, len(plant.varied))):
        if value.ndim != 2 or value.shape[1] != width or len(value) != len(starts):
            raise ValueError(f"initial_states: {name} has shape {value.shape}, must be (n, {width})")
        if not np.isfinite(value).all():
            raise ValueError(f"initial_states: {name} must be finite")
    if not (isinstance(plant, LagrangianPlant) and not plant.driven and len(scene.start) == plant.nu):
        given = ({name: v for (name, _), v in zip(scene.start, row)} for row in starts)
        return np.array([plant.equilibrium(row, p=q)[0] for row, q in zip(given, p)]).reshape(-1, plant.nx)

    columns, free = _split(scene)
    x0, u0 = scene.initial
    z = np.tile(np.concatenate([x0[free], u0]), (len(starts), 1))
    moving = np.ones(len(starts), dtype=bool)  # a lane stops on its own: its digits depend on no other lane
    for _ in range(MOST_STEPS):
        change = _in_chunks(_newton(scene), z, starts, p)
        z[moving] += change[moving]
        moving &= ~(np.max(np.abs(change) / (np.abs(z) + SMALL), axis=1) < TOLERANCE)
        if not moving.any():
            break
    else:
        k = int(np.argmax(moving))
        held = ", ".join(f"{name} = {value:.4g}" for (name, _), value in zip(scene.start, starts[k]))
        worst = float(np.abs(change[k]).max())
        raise EquilibriumError(
            f"scene {scene.name!r} has no rest state with {held} and p = {p[k]}: Newton's steps still change "
            f"it by {worst:.3g}; narrow start_spread or randomise",
            worst,
        )
    x = np.zeros((len(starts), plant.nx))
    x[:, columns], x[:, free] = starts, z[:, : len(free)]
    return x


def _split(scene: Scene) -> tuple[list[int], list[int]]:
    """Indices of the coordinates that scene.start holds, and of the others."""
    held = scene.positions(name for name, _ in scene.start)
    return held, [i for i in range(scene.plant.nx // 2) if i not in held]


def _in_chunks(newton: NumericFunction, *arrays: np.ndarray) -> np.ndarray:
    n = len(arrays[0])
    if n == 1:
        return newton(*(a[0] for a in arrays))[0][None]
    rows = np.minimum(np.arange(-(-n // LANES) * LANES), n - 1).reshape(-1, LANES)
    return np.concatenate([newton(*(a[r] for a in arrays), batch=LANES)[0] for r in rows])[:n]


@lru_cache(maxsize=32)
def _newton(scene: Scene) -> NumericFunction:
    """(z, start, p) -> Newton's change of z = [free coordinates; inputs] towards no net force at rest."""
    plant = scene.varied_plant
    assert isinstance(plant, LagrangianPlant)
    t, x, u, w, p = plant.symbols
    columns, free = _split(scene)
    z, start = ca.SX.sym("z", len(free) + plant.nu), ca.SX.sym("start", len(columns))
    rest = ca.SX.zeros(plant.nx)
    rest[columns], rest[free] = start, z[: len(free)]
    force = plant.symbolic.equations(t, x, u, w)[1]
    force = ca.substitute(
        force, ca.vertcat(t, x, u, w), ca.vertcat(0, rest, z[len(free) :], ca.SX.zeros(plant.nw))
    )
    return function("newton", [z, start, p], [-ca.solve(ca.jacobian(force, z), force)])
