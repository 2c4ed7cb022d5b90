"""What acts beside the model of a scene where its machine is another: measured at the corners of what is known.

The law is played, one machine a lane, on the plant itself at the corners of the box of its parameters, from the corners
of the scene's starts and under its largest gusts. In each period k and lane

    w_k = z_{k+1} - z(model; z_k, u_k)

is all that the model did not foretell: other parameters (A_i - A) z + (B_i - B) u + c_i - c at that corner, the gust,
and what is nonlinear. The set of period k is the hull of zero and of the w of all lanes in periods k - 1, k and k + 1,
times GROWN. It holds what was met there; what other machines, starts and motions would meet was not.
"""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.controllers.base.controller import Controller
from pliant.controllers.base.scene_protocol import CostedScene
from pliant.plants.core.errors import DivergenceWarning, PliantError
from pliant.plants.core.signals import OwnsArrays, index, names

from .error_bounds import Course
from .late_tubes import on_their_way, put_on_their_way

Array = np.ndarray
LANES = 144  # most corners of all that is not known; where it has more, so many of them, drawn
GROWN = 1.1
LARGEST = 1e6  # times the size at the start: past it a lane has run away


@dataclass(frozen=True, eq=False)
class Corners(OwnsArrays):
    """x (lanes, nx) starts, w (lanes, nw) gusts, p (lanes, np) parameters of `plant`."""

    plant: Any  # with the box's parameters as inputs p
    x: Array
    w: Array
    p: Array


def corners_of(scene: CostedScene, ranges: Mapping[str, tuple[float, float]]) -> Corners:
    """The scene as it is, and the corners of its starts (`start`, `spread`), gusts and ranges."""
    plant, known = scene.plant.vary(*ranges), names(scene.plant.states)
    spread = zip(getattr(scene, "start", ()), getattr(scene, "spread", ()))
    moved = [(known.index(name), d) for (name, _), d in spread if d and name in known]
    blown = [(index(plant.disturbances, n, "gust"), v) for n, v in getattr(scene, "gusts", ()) if v]
    ends = [*[(-d, d) for _, d in moved], *[(-v, v) for _, v in blown], *ranges.values()]
    if 2 ** len(ends) < LANES:
        found = np.array(list(itertools.product(*ends))).reshape(-1, len(ends))
    else:
        sides = np.random.default_rng(0).integers(0, 2, (LANES // 2, len(ends)))
        found = np.array([[end[i] for end, i in zip(ends, side)] for side in (*sides, *(1 - sides))])
    middle = np.concatenate([np.zeros(len(moved) + len(blown)), np.ones(len(ranges))])
    found = np.vstack([middle, found])
    x = np.tile(scene.initial[0], (len(found), 1))
    w = np.zeros((len(found), plant.nw))
    for place, (i, _) in enumerate(moved):
        x[:, i] += found[:, place]
    for place, (i, _) in enumerate(blown, len(moved)):
        w[:, i] = found[:, place]
    return Corners(plant, x, w, plant.nominal_parameters * found[:, len(moved) + len(blown) :])


def unforetold(
    scene: CostedScene, corners: Corners, law: Controller, course: Course, origin: tuple[Array, ...], c: Array
) -> Array:
    """w (steps, lanes, nx) of the law's readings. origin: x0 (.., nz), u0 (.., nu), .. that the course counts from, by
    time, the last of which stays; c (.., nz) its affine term; nz - nx inputs on their way. PliantError where a lane is
    lost."""
    plant, lanes = corners.plant, len(corners.x)
    step = plant.stepper(scene.dt, substeps=scene.substeps, batch=lanes)
    places = [names(plant.states + plant.outputs).index(name) for name in law.reads]

    def read(x: Array, u: Array) -> Array:
        values: Array = np.hstack([x, plant.measure(x, u, w=corners.w, p=corners.p)])[:, places]
        return values

    x, u = corners.x, np.zeros((lanes, plant.nu))
    z, found = read(x, u), []
    most, way = LARGEST * (1.0 + np.abs(z).max()), np.tile(on_their_way(law), (lanes, 1))

    def asked(t: float, row: Array, waiting: Array) -> Array:
        put_on_their_way(law, waiting)  # of this lane
        return law.act(t, row)

    for k in range(scene.steps):
        u = np.array([asked(k * scene.dt, *lane) for lane in zip(z, way)])
        acting, later = np.hsplit(np.hstack([way, u]), [plant.nu])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DivergenceWarning)  # told below
            x = np.array(step(x, acting, w=corners.w, p=corners.p))
        new = read(x, acting) if np.abs(x).max() < LARGEST * most else np.full_like(z, np.inf)
        if not np.abs(new).max() < most:
            raise PliantError(f"TubeMPC.for_scene: a corner of what is uncertain runs away at {k * scene.dt:.3g} s")
        x0, x1 = (origin[0][min(k + i, len(origin[0]) - 1)] for i in (0, 1))
        u0 = origin[1][min(k, len(origin[1]) - 1)]
        A, B = course.at(k)[:2]
        foretold = x1 + (np.hstack([z, way]) - x0) @ A.T + (u - u0) @ B.T + c[min(k, len(c) - 1)]
        found.append(new - foretold[:, : len(places)])
        z, way = new, later
    law.reset()
    return np.array(found)


def points_of(w: Array) -> Array:
    """(steps, 3 lanes, nx): of each period with its neighbours, GROWN."""
    at = np.arange(len(w))
    around = [w[np.clip(at + shift, 0, len(w) - 1)] for shift in (-1, 0, 1)]
    return GROWN * np.concatenate(around, axis=1)
