"""Optimal control of a plant from a given state by direct multiple shooting (Bock and Plitt 1984).

min  sum_k dt |r(x_k, u_k)|^2 + (x_N - x_goal)' P (x_N - x_goal)
over x_1..x_N, u_0..u_{N-1}, subject to
     x_{k+1} = F(x_k, u_k), the control period of the plant by RK4 with u held,
     lowest <= u_k <= highest, lowest <= z(x_k, u_k) <= highest for the objective's bounded signals.

With a scene's objective, steps and substeps this is the least that any controller can be charged there without model
error: the full-information bound, up to local minima.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from pliant.controllers.base.objective import Objective
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.riccati.checks import weight_matrix
from pliant.controllers.solvers import interior_point
from pliant.plants.core.argument_gates import (
    require_choice,
    require_count,
    require_finite,
    require_instance,
    require_mapping,
    require_number,
    shown,
)
from pliant.plants.core.errors import InfeasibleError
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant
from pliant.plants.validity.ranges import judged

from .multiple_shooting import Transcription

HESSIANS = ("exact", "gauss-newton")


@dataclass(frozen=True, eq=False)
class Motion(OwnsArrays):
    """A solution: states at the control times, the inputs held between, and what the solver says of it."""

    t: np.ndarray  # (N+1,) [s]
    x: np.ndarray  # (N+1, nx)
    u: np.ndarray  # (N, nu) held from t[k] to t[k+1]
    cost: float  # of the stages and the terminal term
    costate: np.ndarray  # (N, nx) what the cost grows by for a push of x_{k+1}, per unit
    iterations: int
    status: str  # the solver's own word
    defect: float  # largest |x_{k+1} - F(x_k, u_k)|
    stationarity: float  # largest derivative of the Lagrangian along a variable
    seconds: float  # [s] wall time of the solver

    def trajectory(self, plant: Plant) -> Trajectory:
        """The motion in the plant's signals, inputs held; the last input is repeated at the end.

        Warns (ValidityWarning) where it leaves a range of the plant's `validity`.
        """
        require_instance("Motion.trajectory: plant", plant, Plant)
        u = np.vstack([self.u, self.u[-1:]])
        found = Trajectory.from_arrays(self.t, self.x, u, plant=plant, hold="zero-order")
        stats = {"cost": self.cost, "iterations": self.iterations, "status": self.status, "seconds": self.seconds}
        return judged(plant, replace(found, dx=plant.dynamics(self.x, u, t=self.t), stats=stats))


def optimal(
    objective: Objective,
    x0: Any,
    steps: int,
    *,
    substeps: int = 10,
    terminal: Any = None,
    at: Mapping[int, Mapping[str, float]] | None = None,
    reference: Mapping[str, Any] | None = None,
    guess: Any = None,
    w: Any = None,
    p: Any = None,
    solver: str = "ipopt",
    hessian: str = "gauss-newton",
    tolerance: float = 1e-8,
    iterations: int = 300,
) -> Motion:
    """The motion of least cost over `steps` periods of objective.dt from x0 (nx,).

    substeps: RK4 steps a period, at constant disturbances w (nw,) and parameters p (np,).
    terminal: None; P (nx, nx) >= 0, a weight on the last state's deviation from the goal; or "goal", x_N = goal. A goal
    that moves is meant where it is then.
    at: {k: {state or output: value}}, equalities at t = k dt, 1 <= k <= steps.
    reference: {weighted state or output: values (steps,)} that take the place of the goal's in the cost.
    guess: a Motion, or a pair x (steps+1, nx), u (steps, nu); None: the straight line to the goal.
    solver: "ipopt" or "fatrop". hessian: "exact", or "gauss-newton" without the curvature of the dynamics.
    tolerance: of the scaled optimality conditions. InfeasibleError with the solver's word and the largest violation.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> scene = scenes.get("single-link-slew")
    >>> optimal(Objective.of(scene), scene.initial[0], steps=5).u.shape
    (5, 1)
    """
    plant = require_instance("optimal.objective", objective, Objective).plant
    steps = require_count("optimal", "steps", steps, 1, 100_000)
    substeps = require_count("optimal", "substeps", substeps, 1, 100_000)
    require_choice("optimal", "solver", solver, ("ipopt", "fatrop"))
    require_choice("optimal", "hessian", hessian, HESSIANS)
    iterations = require_count("optimal", "iterations", iterations, 1, 1_000_000)
    tolerance = require_number("optimal.tolerance", tolerance, "positive")
    reference = None if reference is None else require_mapping("optimal.reference", reference)
    x0 = require_finite("optimal.x0", x0, (plant.nx,))
    w = np.zeros(plant.nw) if w is None else require_finite("optimal.w", w, (plant.nw,))
    p = plant.nominal_parameters if p is None else require_finite("optimal.p", p, (len(plant.varied),))
    at_goal = isinstance(terminal, str)
    if at_goal:
        require_choice("optimal", "terminal", terminal, ("goal",))
    P = None if at_goal or terminal is None else weight_matrix("optimal.terminal", terminal, plant.nx, definite=False)
    problem = Transcription(
        objective, x0, steps, substeps, P, at_goal, w, p, exact=hessian == "exact", at=at, reference=reference
    )
    return _solve(problem, _start(problem, guess), solver, tolerance, iterations)


def bound(scene: CostedScene, *, guess: Any = None, **options: Any) -> Motion:
    """The least a scene can cost: `optimal` from its start over its duration; options as there.

    Starts, where no guess is given, from the motion under the scene's nominal input.
    """
    require_scene("bound", scene)
    guess = driven(scene) if guess is None else guess
    given = {"substeps": scene.substeps, "guess": guess, **options}
    return optimal(Objective.of(scene), scene.initial[0], scene.steps, **given)


def driven(scene: CostedScene) -> tuple[np.ndarray, np.ndarray] | None:
    """x (steps+1, nx) and u (steps, nu) of the plant under its nominal input within limits; None where it diverges."""
    require_scene("driven", scene)
    step, high = scene.plant.stepper(scene.dt, substeps=scene.substeps), np.array(scene.limits)
    middles = scene.dt * (np.arange(scene.steps) + 0.5)
    u = np.clip([scene.nominal_input(t) for t in middles.tolist()], -high, high)
    x = np.empty((scene.steps + 1, scene.plant.nx))
    x[0] = scene.initial[0]
    for k in range(scene.steps):
        x[k + 1] = step(x[k : k + 1], u[k], t=k * scene.dt)[0]
    return (x, u) if np.isfinite(x).all() else None


def _start(problem: Transcription, guess: Any) -> np.ndarray:
    N, plant, objective = problem.N, problem.plant, problem.objective
    if guess is None:
        s = np.linspace(0.0, 1.0, N + 1)[:, None]
        guess = problem.x0 + s * (problem.goal - problem.x0), np.tile(objective.u_goal, (N, 1))
    if not isinstance(guess, Motion) and not (isinstance(guess, (tuple, list)) and len(guess) == 2):
        raise ValueError(f"optimal.guess = {shown(guess)} must be a Motion, or a pair x, u")
    x, u = (guess.x, guess.u) if isinstance(guess, Motion) else guess
    x = require_finite("optimal.guess x", x, (N + 1, plant.nx))
    return problem.pack(x, require_finite("optimal.guess u", u, (N, plant.nu)))


def _solve(problem: Transcription, z: np.ndarray, solver: str, tolerance: float, iterations: int) -> Motion:
    low, high = problem.row_bounds()
    if np.count_nonzero(low == high) > problem.size:
        raise InfeasibleError(
            f"optimal: {np.count_nonzero(low == high)} equations, but {problem.size} states and inputs: give more "
            "steps or fewer conditions at the end"
        )
    begin = perf_counter()
    z, lam_z, lam, stats = interior_point.solve(problem, z, solver, tolerance, iterations)
    seconds = perf_counter() - begin
    if not stats["success"]:
        raise InfeasibleError(
            f"optimal: {solver} stopped after {stats['iter_count']} iterations with {stats['return_status']}, "
            f'{problem.worst(z)}: loosen limits or bounds, give more steps, a better guess, or hessian="exact"'
        )
    rows, slope = problem.jacobian(z)
    x, u = problem.unpack(z)
    first = problem.N * problem.stage_rows
    defects, multipliers = (v[:first].reshape(problem.N, -1)[:, : problem.nx] for v in (rows, lam))
    return Motion(
        problem.t,
        x,
        u,
        problem.cost(z),
        -multipliers,
        int(stats["iter_count"]),
        str(stats["return_status"]),
        float(np.abs(defects).max()),
        float(np.abs(problem.gradient(z) + np.array(slope.T @ lam).ravel() + lam_z).max()),
        seconds,
    )
