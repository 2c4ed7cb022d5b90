"""The sampled models of a scene's goal over a box of the plant's parameters and a set of delays.

Each model   x+ = A x + B u(k - d) about the goal, the cost of the scene integrated exactly over the period, and the
             inputs of the last `past` periods as states that the law knows: it gave them itself
Drive        the way from start to goal once, each input off by PUSH of its limit in every period (what the linear model
             does not know pushes), and every reading off by its sensor's deviation, or READ of the way that it goes
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.goal_model import away, goal_model
from pliant.controllers.base.quadratic_weights import weight_matrices
from pliant.controllers.base.scene_protocol import CostedScene
from pliant.controllers.estimation.sensors import Sensor
from pliant.controllers.linear_quadratic.lqr import LQR
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import names, rows_by_name
from pliant.plants.dynamics.plant import Plant
from pliant.plants.linear.lti import LinearModel

from .many_models import Models

Array = np.ndarray
PUSH = 0.01
READ = 1e-3
CORNERS = 32  # of the box; where it has more, so many of them, drawn


@dataclass(frozen=True)
class Known:
    """What the law reads and remembers: names, standard deviations of readings and typical sizes (ny,), past inputs."""

    reads: tuple[str, ...]
    deviation: Array
    size: Array
    past: int


def corners(ranges: Mapping[str, tuple[float, float]]) -> list[Array]:
    """Factors (np,) at the middle of all, and at the corners of the box."""
    ends = list(ranges.values())
    if 2 ** len(ends) <= CORNERS:
        found = [np.array(c) for c in itertools.product(*ends)]
    else:
        sides = np.random.default_rng(0).integers(0, 2, (CORNERS // 2, len(ends)))
        found = [np.array([end[i] for end, i in zip(ends, side)]) for side in (*sides, *(1 - sides))]
    return [np.ones(len(ends)), *found]


def known_of(scene: CostedScene, sensors: Sequence[Sensor] | None, past: int) -> Known:
    """The states of the goal's model where `sensors` is None, else what the sensors read without feedthrough.

    Sizes are those of the motion from the start under the scene's LQR, linear and without limits.
    """
    model, drift = goal_model(scene)
    if drift.any():
        raise PliantError("the goal moves: many models are one goal's")
    reads = model.state_names
    if sensors is not None:
        there = [s.output for s in sensors if s.output in (*model.state_names, *model.output_names)]
        reads = tuple(name for name, D in zip(there, rows_by_name(model, there).D) if not D.any())
        if not reads:
            raise PliantError("no sensor reads without feedthrough of an input")
    law, held = LQR.for_scene(scene), model.discretize(scene.dt)
    x, motion = away(scene, model), []
    for _ in range(scene.steps):
        motion.append(x)
        x = (held.A - held.B @ law.K) @ x
    C = rows_by_name(model, reads).C
    size = np.abs(np.array(motion) @ C.T).max(axis=0)
    units = [s.unit for s in (*model.states, *model.outputs) for name in reads if s.name == name]
    order = [s.name for s in (*model.states, *model.outputs) for name in reads if s.name == name]
    by_unit = {unit: max(size[reads.index(n)] for n, u in zip(order, units) if u == unit) for unit in units}
    floor = np.array([1e-3 * by_unit[units[order.index(name)]] for name in reads])
    size = np.maximum(np.maximum(size, floor), 1e-9)
    told = {s.output: s.deviation(scene.dt) for s in sensors or ()}
    return Known(tuple(reads), np.array([told.get(n, READ * z) for n, z in zip(reads, size)]), size, past)


def models_over(
    scene: CostedScene,
    plants: Sequence[tuple[Plant, tuple[Array, Array]]],
    ranges: Mapping[str, tuple[float, float]],
    delays: Sequence[int],
    known: Known,
    effort: float = 1.0,
) -> Models:
    """All of `plants` (each with its goal (x0, u0)), at all corners of `ranges`, for all delays [periods]; `effort` is
    a factor on what the inputs cost."""
    wanted = goal_model(scene)[0].state_names
    own = set(names(scene.plant.states)) - set(wanted)  # states that the goal's model leaves out
    parts = []
    for plant, goal in plants:
        varied = plant.vary(*ranges)
        for factors in corners(ranges):
            model = varied.feedback_model(*goal, p=varied.nominal_parameters * factors)
            keep = [i for i, name in enumerate(model.state_names) if name not in own]
            parts += [_part(scene, model, keep, delay, known, effort) for delay in delays]
    return Models.of(parts)


def _part(
    scene: CostedScene, model: LinearModel, keep: Sequence[int], delay: int, known: Known, effort: float
) -> tuple[Array, ...]:
    """(A, B, C, Q, R, N, X, V) with the last inputs, the newest first, as states."""
    Q, R, N = weight_matrices("many models", model, dict(scene.weights), {n: effort * v for n, v in scene.effort})
    C = rows_by_name(model, known.reads).C[:, keep]
    pick = np.ix_(keep, keep)
    A, B, Q, R, N = riccati.sampled(model.A[pick], model.B[keep], Q[pick], R, N[keep], dt=scene.dt)
    (nx, nu), past = B.shape, known.past
    n = nx + past * nu
    wide = {name: np.zeros(shape) for name, shape in {"A": (n, n), "B": (n, nu), "Q": (n, n), "N": (n, nu)}.items()}
    wide["A"][:nx, :nx], wide["Q"][:nx, :nx] = A, Q
    if delay:
        acts = slice(nx + (delay - 1) * nu, nx + delay * nu)
        wide["A"][:nx, acts], wide["Q"][:nx, acts], wide["Q"][acts, :nx], wide["Q"][acts, acts] = B, N, N.T, R
        R = np.zeros_like(R)  # it is charged when it acts
    else:
        wide["B"][:nx], wide["N"][:nx] = B, N
    for k in range(past):
        now = slice(nx + k * nu, nx + (k + 1) * nu)
        if k:
            wide["A"][now, nx + (k - 1) * nu : nx + k * nu] = np.eye(nu)
        else:
            wide["B"][now] = np.eye(nu)
    reads = np.block([[C, np.zeros((len(C), n - nx))], [np.zeros((n - nx, nx)), np.eye(n - nx)]])
    start, push = away(scene, model)[keep], B * (PUSH * np.array(scene.limits))
    X, V = np.zeros((n, n)), np.zeros((len(reads), len(reads)))
    X[:nx, :nx] = scene.steps * push @ push.T
    V[: len(C), : len(C)] = scene.steps * np.diag(known.deviation**2)
    return wide["A"], wide["B"], reads, wide["Q"], R, wide["N"], X, V, np.append(start, np.zeros(n - nx))[:, None]
