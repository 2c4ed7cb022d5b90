"""The compiled library of a plant's motions by Rodas5P: what it is written from, and how it is compared.

Compared are the rates, their change along any direction, and one step, its estimate of the error and its dense output,
from a Jacobian that is given: what a library does with the numbers, apart from where it has them from.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.motions.compile_rule import OnDemand
from pliant.plants.native.batch_kernels import random_points
from pliant.plants.rounding.agreement import Reference, Trial, of_function
from pliant.plants.rounding.extended_evaluation import mover

from . import adaptive_source, plant_functions, step_source, tableaux
from .adaptive import METHOD, AdaptiveLibrary
from .tableaux import RosenbrockTableau, rodas3, rodas5p

Array = np.ndarray
LONGEST_TRIED, FASTER = 0.1, 2.0  # [s] a step, and how much longer than the fastest mode's time it may be
MIDDLE = 0.4  # of the step, where dense output is compared


@lru_cache(maxsize=64)
def adaptive_kernel(plant: PlantLike) -> OnDemand[AdaptiveLibrary]:
    """Motions of a plant by Rodas5P's own steps."""
    directional = lru_cache(maxsize=1)(lambda: plant_functions.directional_function(plant))

    def source() -> str:
        rate, timed = plant_functions.rate_function(plant), plant_functions.changing_in_time(plant)
        return adaptive_source.adaptive_source(METHOD, rodas5p(), rate, directional(), timed=timed)

    writers = (adaptive_source, step_source, tableaux, plant_functions)
    return OnDemand(
        lambda: ca.Function("rate", list(plant.symbols), [plant.expressions[0]]),
        lambda: plant._dynamics._function.n_instructions() + directional().n_instructions(),
        "\n".join(inspect.getsource(module) for module in writers),
        AdaptiveLibrary,
        source,
        lambda: trials(plant, directional()),
        f"motions of {type(plant).__name__} ({plant.label}) by {METHOD}",
    )


def trials(plant: PlantLike, directional: ca.Function) -> list[Trial]:
    """Of the rates, of their changes, and of a step."""
    rate = plant_functions.rate_function(plant)
    h = _telling_step(linearised_points(plant, np.random.default_rng(0))[-1], plant.nx)
    return [
        Trial(of_function(rate), partial(random_points, plant), entry="rates"),
        Trial(of_function(directional), partial(directed_points, plant), entry="directions"),
        Trial(
            partial(step_reference, rate),
            partial(linearised_points, plant),
            (h, MIDDLE),
            entry=f"compared_{METHOD}",
        ),
    ]


def directed_points(plant: PlantLike, rng: np.random.Generator) -> list[Array]:
    """Points with directions (dt, dx, du) of all sizes up to 1."""
    points = random_points(plant, rng)
    n = points[0].shape[1]
    return [*points, *(rng.uniform(-1.0, 1.0, (size, n)) for size in (1, plant.nx, plant.nu))]


def linearised_points(plant: PlantLike, rng: np.random.Generator) -> list[Array]:
    """Points with [df/dx, df/dt] there, row after row, (nx (nx + 1), n)."""
    points, nx = random_points(plant, rng), plant.nx
    n = points[0].shape[1]
    both, drift = plant_functions.slopes(plant)(*[a.T for a in points], batch=n)
    J = np.concatenate([both[:, :, :nx], drift], axis=2)
    return [*points, np.ascontiguousarray(J.reshape(n, -1).T)]


def _telling_step(J: Array, nx: int) -> float:
    """A step [s] that shows what every stage adds: as long as the fastest mode takes."""
    found = J.T.reshape(-1, nx, nx + 1)[:, :, :nx]
    found = found[np.isfinite(found).all(axis=(1, 2))]
    fastest = float(np.median(np.abs(np.linalg.eigvals(found)).max(axis=1))) if len(found) else 0.0
    return LONGEST_TRIED if fastest <= FASTER / LONGEST_TRIED else FASTER / fastest


def step_reference(rate: ca.Function, numeric: Callable[..., Any] = NumericFunction) -> Reference:
    """(t, x, u, w, p, J) -> the state after a step of scalars[0], its last stage, the state at scalars[1] of it, the
    defect.
    """
    f, moved, tableau = numeric(rate), mover(numeric, apart=True), rodas5p()

    def reference(t: Array, x: Array, u: Array, w: Array, p: Array, J: Array, scalars: Any, _: int) -> Sequence[Array]:
        nx, (h, middle) = x.shape[1], scalars
        step = _Step(tableau, lambda at, y: f(at, y, u, w, p, batch=len(x))[0], moved, J.reshape(len(x), nx, nx + 1), h)
        after, k = step.taken(t, x)
        c = tableau.worst
        rate = step.rate(t + c * h, step.added(x, tableau.along(c), k))
        defect = step.solve(step.added(rate, -tableau.slope_along(c), k, step.each))
        return [after, k[-1], step.added(x, tableau.along(middle), k), defect]

    return reference


def fixed_reference(plant: PlantLike, numeric: Callable[..., Any] = NumericFunction) -> Reference:
    """(t, x, u, w, p) -> the state after count steps of scalars[0] by RODAS3, the input held."""
    f, moved = numeric(plant_functions.rate_function(plant)), mover(numeric, apart=True)
    whole, tableau = numeric(plant_functions.whole_slopes(plant), matrices=True), rodas3()

    def reference(t: Array, x: Array, u: Array, w: Array, p: Array, scalars: Any, count: int) -> Sequence[Array]:
        for _ in range(count):
            slopes = np.concatenate(whole(t, x, u, w, p, batch=len(x)), axis=2)
            step = _Step(tableau, lambda at, y: f(at, y, u, w, p, batch=len(y))[0], moved, slopes, scalars[0])
            x, t = step.taken(t, x)[0], t + scalars[0]
        return [x]

    return reference


class _Step:
    """A step of h [s] of many states (B, nx) from slopes (B, nx, nx + 1), each operation rounded as `moved` has it."""

    def __init__(
        self,
        tableau: RosenbrockTableau,
        rate: Callable[[Array, Array], Array],
        moved: Callable[[Array], Array],
        slopes: Array,
        h: float,
    ) -> None:
        self.tableau, self.rate, self.moved, self.h = tableau, rate, moved, h
        shape, nx = (len(slopes), 1, 1), slopes.shape[1]
        shift, each = (moved(np.full(shape, 1 / part, dtype=slopes.dtype)) for part in (tableau.gamma * h, h))
        self.solve = _solver(-slopes[:, :, :nx] + np.eye(nx) * shift, moved)
        self.drift, self.each = slopes[:, :, nx], each[:, 0]

    def added(self, start: Array, coefficients: Array, k: Sequence[Array], times: Any = 1.0) -> Array:
        """start + sum of the stages with their coefficients."""
        for a, stage in zip(coefficients, k):
            start = start if a == 0 else self.moved(start + self.moved(self.moved(a * times * stage)))
        return start

    def taken(self, t: Array, x: Array) -> tuple[Array, list[Array]]:
        """The state after it, and the stages."""
        tableau, y = self.tableau, x
        k: list[Array] = []
        for i, alpha in enumerate(tableau.alpha):
            y = self.added(x, tableau.A[i], k)
            r = self.added(self.rate(t + float(alpha) * self.h, y), tableau.C[i], k, self.each)
            k.append(self.solve(self.moved(r + self.h * tableau.d[i] * self.drift)))
        return self.moved(y + k[-1]), k


def _solver(W: Array, moved: Callable[[Array], Array]) -> Callable[[Array], Array]:
    """Gaussian elimination with partial pivoting of matrices (B, n, n), each operation rounded as `moved` has it."""
    a, n, rows = moved(W), W.shape[1], np.arange(len(W))
    order, inverse = np.tile(np.arange(n), (len(W), 1)), np.ones_like(a[:, 0])
    for k in range(n):
        best = k + np.abs(a[:, k:, k]).argmax(axis=1)
        a[rows, k], a[rows, best] = a[rows, best], a[rows, k].copy()
        order[rows, k], order[rows, best] = order[rows, best], order[rows, k].copy()
        inverse[:, k] = moved(1 / a[:, k, k])
        a[:, k + 1 :, k] = moved(a[:, k + 1 :, k] * inverse[:, k, None])
        change = a[:, k + 1 :, k, None] * a[:, None, k, k + 1 :]
        a[:, k + 1 :, k + 1 :] = moved(a[:, k + 1 :, k + 1 :] - change)

    def solve(r: Array) -> Array:
        y = np.take_along_axis(r, order, axis=1)
        for k in range(n):
            y[:, k + 1 :] = moved(y[:, k + 1 :] - a[:, k + 1 :, k] * y[:, k, None])
        for k in reversed(range(n)):
            y[:, k] = moved(y[:, k] * inverse[:, k])
            y[:, :k] = moved(y[:, :k] - a[:, :k, k] * y[:, k, None])
        return y

    return solve
