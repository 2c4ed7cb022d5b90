"""One gain for all machines of a box: multi-model LQR, from states or from what sensors read.

    u = u0 - K [y_k - y0; u_{k-1} - u0, ..; y_{k-1} - y0, ..], within the limits

The gain minimises the mean of the scene's quadratic cost over the corners of the box, with each of the delays (see
`many_models`): what a delay or another payload does to the loop is in the design, where LQR and LQG meet it unprepared.
From states one reading and the last inputs will do; from sensors a few past readings stand for an observer.

Guarantee   stable in the linear model about the goal at the corners of the box, its middle and the given delays, which
            was computed there (`radius`). None between them, none for the nonlinear plant, none under limits: play it
            (`monte_carlo`, `robustify`), or bound it (`robust_stability`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from pliant.controllers.base.controller import reading
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.estimation.sensors import Sensor, sensors_of
from pliant.controllers.linear_quadratic.lqr import LQR
from pliant.plants.core.argument_gates import (
    require_all,
    require_choice,
    require_count,
    require_instance,
    require_mapping,
    require_number,
    shown,
)
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays, names
from pliant.plants.dynamics.plant import Plant

from .box_models import Known, known_of, models_over
from .many_models import Structure, descend

Array = np.ndarray
SPREAD = 0.3  # of what a plant calls uncertain
HISTORY = {"states": 1, "sensors": 5}  # readings that the law knows
PAST = {"states": 1, "sensors": 2}  # inputs, at least; as many as the longest delay
EFFORTS = (100.0, 10.0, 1.0, 1000.0)  # of the LQR that the search starts from, times the scene's
ITERATIONS = 400


@final
@dataclass(eq=False)
class MultiModelLQR(OwnsArrays):
    """Made by `for_scene`. It reads the states of the goal's model, or outputs of sensors.

    Example
    -------
    >>> many = MultiModelLQR.for_scene(scene)
    >>> many.reset()
    >>> many.act(0.0, np.zeros(len(many.reads))).shape
    (1,)
    """

    K: Array  # (nu, ny history + nu past)
    y0: Array  # (ny,)
    u0: Array  # (nu,)
    reads: tuple[str, ...]
    limits: tuple[Array, Array]  # lowest, highest (nu,)
    dt: float  # [s]
    past: int  # inputs that it remembers
    start: Array  # (nu,) what acted before the first act
    radius: float  # largest |z| of the linear loops that it was designed on
    cost: float  # their mean cost [-]
    delays: tuple[int, ...]
    ranges: Mapping[str, tuple[float, float]]

    def __post_init__(self) -> None:
        self.reset()

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        *,
        reads: str = "states",
        ranges: Mapping[str, tuple[float, float]] | None = None,
        delays: Sequence[int] = (0, 1),
        plants: Sequence[tuple[Plant, tuple[Array, Array]]] | None = None,
        sensors: Sequence[Sensor] | None = None,
        effort: float = 1.0,
        iterations: int = ITERATIONS,
    ) -> MultiModelLQR:
        """About a scene's goal, with its cost, limits and period.

        reads: "states", or "sensors", those of the plant or the given ones, without feedthrough of an input. ranges:
        smallest and largest factor by name of parameter; +-30 % of what the plant calls uncertain where None. delays
        [periods] of the inputs: those that may be. plants: (plant, its goal (x0, u0)) in place of the scene's own, as
        finer ones. effort: a factor on what the inputs cost. PliantError where no gain was found that is stable on all.

        Example
        -------
        >>> MultiModelLQR.for_scene(scene).radius < 1
        True
        """
        require_scene("MultiModelLQR.for_scene", scene)
        require_choice("MultiModelLQR.for_scene", "reads", reads, tuple(HISTORY))
        late = delays_of(delays, "MultiModelLQR.delays")
        box = box_of(scene, ranges, "MultiModelLQR.ranges")
        effort = require_number("MultiModelLQR.for_scene.effort", effort, "positive")
        iterations = require_count("MultiModelLQR.for_scene", "iterations", iterations, 1, 100_000)
        if sensors is not None:
            sensors = require_all("MultiModelLQR.sensors", sensors, Sensor)
        read = (sensors_of(scene.plant) if sensors is None else sensors) if reads == "sensors" else None
        known = known_of(scene, read, max(PAST[reads], *late))
        models = models_over(scene, plants or ((scene.plant, scene.target),), box, late, known, effort)
        history = HISTORY[reads]
        models = models.with_history(len(known.reads), history - 1)
        nu, high = scene.plant.nu, np.array(scene.limits, dtype=float)
        structure, shape = _structure(known, nu, history), (nu, models.C.shape[1])
        scale = _scale(known, high, history)
        for begin in EFFORTS:
            first = _first(scene, known, history, begin)
            theta, found = descend(models, first.ravel(), structure, scale.ravel(), iterations=iterations)
            if np.isfinite(found.cost):
                break
        else:
            raise PliantError(
                f"no gain was found that is stable on all {len(models.A)} models: narrow ranges or delays {late}, or "
                "raise effort"
            )
        plant, (x, u) = scene.plant, scene.target
        told = dict(zip(names(plant.states + plant.outputs), np.concatenate([x, plant.measure(x, u)])))
        return cls(
            theta.reshape(shape),
            np.array([told[name] for name in known.reads]),
            np.array(u, dtype=float),
            known.reads,
            (-high, high),
            scene.dt,
            known.past,
            np.clip(scene.initial[1], -high, high),
            float(found.radii.max()),
            found.cost,
            late,
            box,
        )

    def reset(self) -> None:
        """Forget readings and inputs."""
        ny, nu = len(self.y0), len(self.u0)
        self._z = np.empty(self.K.shape[1])
        self._z[ny : ny + nu * self.past] = np.tile(self.start - self.u0, self.past)
        self._old = ny + nu * self.past
        self._begun = False

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from y (len(reads),); `t` does not matter."""
        e, z, old = reading("MultiModelLQR.y", y, len(self.reads)) - self.y0, self._z, self._old
        ny, nu = len(e), len(self.u0)
        if not self._begun:
            z[old:] = np.tile(e, (len(z) - old) // ny)
            self._begun = True
        z[:ny] = e
        u = np.minimum(np.maximum(self.u0 - self.K.dot(z), self.limits[0]), self.limits[1])
        if len(z) > old:
            z[old + ny :] = z[old:-ny].copy()
            z[old : old + ny] = e
        z[ny + nu : old] = z[ny : old - nu].copy()
        z[ny : ny + nu] = u - self.u0
        return u


def delays_of(delays: Sequence[int], name: str) -> tuple[int, ...]:
    """Periods, each once. ValueError that begins with `name`."""
    if not isinstance(delays, (tuple, list)) or not delays:
        raise ValueError(f"{name} = {shown(delays)} must be a tuple of periods: (0, 1)")
    owner, _, field = name.rpartition(".")
    return tuple(sorted({require_count(owner, field, d, 0, 16) for d in delays}))


def box_of(
    scene: CostedScene, ranges: Mapping[str, tuple[float, float]] | None, owner: str
) -> dict[str, tuple[float, float]]:
    """(smallest, largest) factor by name of parameter. ValueError that begins with `owner`."""
    plant = require_instance(owner, scene.plant, Plant)
    if ranges is None:
        return dict.fromkeys(plant.uncertain, (1 - SPREAD, 1 + SPREAD))
    found = {}
    for path, pair in require_mapping(owner, ranges).items():
        if not isinstance(pair, (tuple, list)) or len(pair) != 2:
            raise ValueError(f"{owner}[{path!r}] = {shown(pair)} must be (smallest, largest) factor")
        low, high = (require_number(f"{owner}[{path!r}]", value, "positive") for value in pair)
        if not low <= high:
            raise ValueError(f"{owner}[{path!r}] = ({low!r}, {high!r}) must be smallest <= largest")
        found[path] = (low, high)
    return found


def _structure(known: Known, nu: int, history: int) -> Structure:
    """The gain is free, the memory of readings moves on by one."""
    ny, past = len(known.reads), known.past * nu
    shift = np.zeros((ny * (history - 1), ny * history + past))
    for k in range(history - 1):
        begin = 0 if k == 0 else ny + past + (k - 1) * ny
        shift[k * ny : (k + 1) * ny, begin : begin + ny] = np.eye(ny)

    def law(theta: Array) -> tuple[Array, object]:
        return np.vstack([-theta.reshape(nu, -1), shift]), lambda slope: -slope[:nu].ravel()

    return law  # type: ignore[return-value]


def _scale(known: Known, high: Array, history: int) -> Array:
    """What moves an input by half its limit."""
    one = 0.5 * high[:, None] / known.size[None]
    return np.hstack([one, np.full((len(high), known.past * len(high)), 0.3), np.tile(one, (1, history - 1))])


def _first(scene: CostedScene, known: Known, history: int, effort: float) -> Array:
    """The LQR's gains of what is read; of rates that are not, by the difference of the readings that are known."""
    law = LQR.for_scene(scene, effort=effort)
    gains, ny, nu = dict(zip(law.reads, law.K.T)), len(known.reads), len(law.K)
    K = np.zeros((nu, ny * history + known.past * nu))
    for j, name in enumerate(known.reads):
        K[:, j] = gains.get(name, 0.0)
        rate = gains.get(f"{name}_rate")
        if history > 1 and rate is not None:
            slope = rate / (scene.dt * (history - 1))
            K[:, j] += slope
            K[:, K.shape[1] - ny + j] -= slope
    return K
