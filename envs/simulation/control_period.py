"""One control period of a scene's environment as straight-line CasADi expressions, without branch or loop.

t time, which matters only where the goal moves; x (nx,) state; action (nu,) in [-1, 1]; u (nu,) inputs; w (nw,)
disturbances; p (np,) the randomised parameters, in the order of scene.randomise; ref (nr,) what deviations are measured
from: the goal's values of the observed signals, of the weighted signals and of the priced inputs, one after the other.

The functions here are also the source of compiled code, one lane at a time. `sound` tells non-finite numbers,
outside of it.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from pliant.envs.scenes.scene import Scene, once_per_scene
from pliant.plants import StabilityLimitError
from pliant.plants.core.casadi_functions import NumericFunction
from pliant.plants.integration.batch_stepper import explicit_step
from pliant.plants.integration.step_maps import check_step, step_map
from pliant.plants.validity.ranges import reach

Array = np.ndarray
MOST_SUBSTEPS = 4096
MOST_CORNERS = 64  # of the ranges of parameters, at which a step is checked
LARGEST = 1e12  # a state or observation beyond it has diverged: its weighted square still fits a single


@once_per_scene
def reference(scene: Scene) -> np.ndarray:
    """ref (nr,) of the scene's own goal, from its own plant."""
    goals = [scene.goal_values(names) for names in (scene.observe, scene.weighted)]
    return np.concatenate([*goals, scene.target[1][scene.priced_inputs]])


@once_per_scene
def reference_drift(scene: Scene) -> np.ndarray:
    """d(ref)/dt (nr,): zero but where the goal moves."""
    drifts = [scene.goal_drift(names) for names in (scene.observe, scene.weighted)]
    return np.concatenate([*drifts, np.zeros(len(scene.priced_inputs))])


def _symbols(scene: Scene) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
    plant = scene.varied_plant
    count = len(scene.observe) + len(scene.weights) + len(scene.effort)
    sizes = (plant.nx, plant.nu, count, plant.nw, len(plant.varied))
    return tuple(ca.SX.sym(name, size) for name, size in zip("xurwp", sizes))  # type: ignore[return-value]


def check_substep(scene: Scene, randomise: bool) -> None:
    """Raise StabilityLimitError where RK4's substep is too long at the goal, with `randomise` also for the corners of
    the parameters' ranges.
    """
    (_check_substep_of_corners if randomise else _check_substep_of_goal)(scene)


@once_per_scene
def _check_substep_of_goal(scene: Scene) -> None:
    _check_substep(scene, [(1.0,) * len(scene.randomise)])


@once_per_scene
def _check_substep_of_corners(scene: Scene) -> None:
    corners = itertools.product(*((low, high) for _, low, high in scene.randomise))
    _check_substep(scene, itertools.islice(corners, MOST_CORNERS))


def _check_substep(scene: Scene, factors: Iterable[tuple[float, ...]]) -> None:
    x, u = scene.target
    for own in factors:
        p = scene.varied_plant.nominal_parameters * np.array(own)
        check_step(scene.varied_plant, x, "rk4", scene.dt / scene.substeps, u=u, p=p)


def enough_substeps(scene: Scene) -> Scene:
    """The scene with as many substeps, doubled again and again, as its own goal and the corners of its parameters take;
    StabilityLimitError beyond MOST_SUBSTEPS.
    """
    while True:
        try:
            check_substep(scene, True)
            return scene
        except StabilityLimitError:
            if 2 * scene.substeps > MOST_SUBSTEPS:
                raise
            scene = dataclasses.replace(scene, substeps=2 * scene.substeps)


def require_time_shown(scene: Scene) -> None:
    """ValueError where the plant depends on time and no goal moves with it: an environment would not show that."""
    plant = scene.varied_plant
    rate, output = (ca.depends_on(e, plant.symbols[0]) for e in plant.expressions)
    if output or (rate and not scene.goal_rates):
        raise ValueError(f"scene {scene.name!r}: the plant depends on time, which an environment does not show")


@once_per_scene
def substep_function(scene: Scene) -> ca.Function:
    """(t, x, u, w, p) -> x after one RK4 step of dt / substeps with u held; ValueError as `require_time_shown`."""
    require_time_shown(scene)
    plant = scene.varied_plant
    t, (x, u, _, w, p) = ca.SX.sym("t"), _symbols(scene)
    rk4 = step_map(plant, "rk4")
    after = rk4(t, x, ca.repmat(u, 1, 3), w, p, scene.dt / scene.substeps)
    return ca.Function("substep", [t, x, u, w, p], ca.cse([after]), list("txuwp"), ["x_next"])


@once_per_scene
def observe_function(scene: Scene) -> ca.Function:
    """(x, u, ref, w, p) -> (obs (no,), cost of a control period that starts here, margin).

    margin  the least of (bound - |signal|) / bound: 1 where all bounded signals are zero, < 0 out of bounds
    """
    plant = scene.varied_plant
    x, u, ref, w, p = _symbols(scene)
    output = ca.Function("output", list(plant.symbols), [plant.expressions[1]])
    signals = ca.vertcat(x, output(0.0, x, u, w, p))
    n, m = len(scene.observe), len(scene.weights)
    obs = signals[scene.positions(scene.observe)] - ref[:n]
    errors = [signals[i] - ref[n + k] for k, i in enumerate(scene.positions(scene.weighted))]  # none, maybe
    excess = [u[i] - ref[n + m + k] for k, i in enumerate(scene.priced_inputs)]
    rate = scene.cost_rate(errors, excess)
    margin = ca.SX(1.0)
    for name, bound in scene.bounds:
        value = signals[scene.positions([name])]
        margin = ca.fmin(margin, (bound - ca.fabs(value)) / bound)
    results = [ca.densify(e) for e in (obs, scene.dt * ca.SX(rate), margin)]
    return ca.Function("observe", [x, u, ref, w, p], ca.cse(results), list("xurwp"), ["obs", "cost", "margin"])


@once_per_scene
def reach_function(scene: Scene) -> ca.Function:
    """(x, u, w, p) -> largest share of a range of the plant's `validity`: above 1 its kinematics do not hold."""
    plant = scene.varied_plant
    x, u, _, w, p = _symbols(scene)
    farthest = ca.Function("farthest", [*plant.symbols, plant.symbols_of_outputs], [reach(plant.validity)])
    output = ca.Function("output", list(plant.symbols), [plant.expressions[1]])
    found = farthest(0.0, x, u, w, p, output(0.0, x, u, w, p))
    return ca.Function("reach", [x, u, w, p], ca.cse([ca.densify(found)]), list("xuwp"), ["reach"])


def parts(scene: Scene) -> tuple[ca.Function, ca.Function, ca.Function]:
    """What a period is composed of around its substeps, here and in compiled code.

    drive (action) -> u, score (x, u, ref, w, p) -> cost, sense (x, u, ref, w, p) -> ([obs; reach], margin).
    """
    action = ca.SX.sym("action", scene.plant.nu)
    drive = ca.Function("drive", [action], [ca.fmax(-1.0, ca.fmin(1.0, action)) * ca.DM(scene.limits)])
    observe = observe_function(scene)
    symbols = observe.sx_in()
    obs, cost, margin = observe(*symbols)
    score = ca.Function("score", symbols, ca.cse([cost]))
    x, u, _, w, p = symbols
    seen = ca.vertcat(obs, reach_function(scene)(x, u, w, p))
    return drive, score, ca.Function("sense", symbols, ca.cse([seen, margin]))


def on_virtual_machine(scene: Scene, numeric: Callable[..., Any] = NumericFunction) -> Callable[..., Sequence[Array]]:
    """The whole period without compiled code, rows of lanes in and out: as `numeric` has it, what the kernel must give.

    The input is the action, clipped to [-1, 1], times the limits, held over the substeps. cost is what Scene.cost sums
    for this period, at its start; obs, reach and margin are those of x_next; sound is 0 where anything is not finite.
    """
    drive, score, sense = (numeric(f) for f in parts(scene))
    substep: Callable[..., Any]
    if numeric is NumericFunction:
        substep = numeric(substep_function(scene))
    else:
        substep = explicit_step(scene.varied_plant, "rk4", numeric)

    def compute(
        t: np.ndarray,
        x: np.ndarray,
        action: np.ndarray,
        ref: np.ndarray,
        w: np.ndarray,
        p: np.ndarray,
        scalars: Any,
        count: int,
    ) -> Sequence[Array]:
        n = len(x)
        u = drive(action, batch=n)[0]
        cost = score(x, u, ref, w, p, batch=n)[0]
        lengths = () if numeric is NumericFunction else scalars[:1]  # the substep knows its own
        for k in range(count):
            x = substep(t + k * scalars[0], x, u, w, p, *lengths, batch=n)[0]
        obs, margin = sense(x, u, ref, w, p, batch=n)
        whole = (np.abs(np.concatenate([x, obs, cost, margin], axis=1)) < LARGEST).all(axis=1, keepdims=True)
        return [x, obs, cost, margin, whole.astype(float)]

    return compute
