"""A sampled controller on a plant that may differ from its design model: noise, input delay, every failure recorded.

Each control period  the controller reads the signals that it names, with noise; its input, cut off at the limits,
                     acts `delay` periods later; the plant moves on by RK4 on the environment's kernel.
Outputs are measured with the input that acted before, as in Plant.simulate. Cost and the charge for an early end are
the environment's: the stage cost of each period, and what `early_end_cost` adds for the time left.
"""

from __future__ import annotations

import dataclasses
import time
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from pliant.controllers import Controller
from pliant.controllers.estimation.sensors import sensors_of
from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_kernel import ControlStep
from pliant.envs.simulation.episode_start import draw, early_end_cost, initial_states
from pliant.plants import PliantError
from pliant.plants.core.argument_gates import (
    real_array,
    require_count,
    require_finite,
    require_function,
    require_instance,
    require_names,
    require_seconds,
)
from pliant.plants.core.signals import OwnsArrays, names

from .evaluation_scene import signal_ranges

NOISE = 1e-3  # standard deviation of a reading, of the range that the signal has in the scene's nominal motion
SLACK = 1e-9  # share of a limit by which an input may exceed it and still count as within


@dataclass(frozen=True, eq=False, kw_only=True)
class Conditions(OwnsArrays):
    """What one run starts from and suffers. `noise` (nx + ny,) are standard deviations of readings."""

    x: np.ndarray  # (nx,) start
    w: np.ndarray  # (nw,) constant disturbance
    p: np.ndarray  # (np,) the varied parameters
    noise: np.ndarray  # (nx + ny,) [each signal's unit]
    delay: int = 0  # [control periods] from reading to acting
    seed: tuple[int, int] = (0, 0)  # of the noise: (root, number of the run)

    def __post_init__(self) -> None:
        for name in ("x", "w", "p", "noise"):
            object.__setattr__(self, name, require_finite(f"Conditions.{name}", getattr(self, name), (-1,)))
        if not (self.noise >= 0).all():
            raise ValueError(f"Conditions.noise = {self.noise} must be >= 0")


@dataclass(frozen=True, eq=False)
class Rollout(OwnsArrays):
    """One run. Rows are control times up to where it ended; `failure` says why it ended early, "" where it did not."""

    t: np.ndarray  # (n + 1,) [s]
    signals: np.ndarray  # (n + 1, nx + ny) true states and outputs
    u: np.ndarray  # (n, nu) what acted
    asked: np.ndarray  # (n, nu) what the controller asked for at that time, before limits and delay
    cost: float  # with the charge for an early end
    failure: str
    act_ns: np.ndarray  # (n,) [ns] time of each call of act
    names: tuple[str, ...]  # of the signals

    def __getitem__(self, name: str) -> np.ndarray:
        """A state or output (n + 1,)."""
        return self.signals[:, self.names.index(name)]


def nominal(scene: Scene) -> Conditions:
    """The scene as it is: its own start and parameters, nothing drawn, no noise, no delay."""
    plant = require_instance("nominal.scene", scene, Scene).varied_plant
    return Conditions(
        x=scene.initial[0], w=np.zeros(plant.nw), p=plant.nominal_parameters, noise=np.zeros(plant.nx + plant.ny)
    )


def randomised(scene: Scene, count: int, seed: int = 0) -> tuple[Conditions, ...]:
    """`count` runs: start, parameters and gusts drawn as the scene says, `reading_noise` on every reading, no delay.

    A run depends on (seed, its number) alone, not on `count`.
    """
    require_instance("randomised.scene", scene, Scene)
    count = require_count("randomised", "count", count, 1, 1_000_000)
    seed = require_count("randomised", "seed", seed, 0, 2**32 - 1)
    noise = reading_noise(scene)
    drawn = [[a[0] for a in draw(scene, np.random.default_rng([seed, number]), 1)] for number in range(count)]
    starts, w, p = (np.array(group) for group in zip(*drawn, strict=True))
    states = initial_states(scene, starts, p)
    return tuple(Conditions(x=states[i], w=w[i], p=p[i], noise=noise, seed=(seed, i)) for i in range(count))


def reading_noise(scene: Scene) -> np.ndarray:
    """Standard deviations (nx + ny,) of readings: a sensor's where the plant carries one for the signal, else NOISE."""
    require_instance("reading_noise.scene", scene, Scene)
    noise = NOISE * signal_ranges(scene)
    try:
        sensors = sensors_of(scene.plant)
    except ValueError:  # a plant of another kind
        return noise
    for sensor in sensors:
        noise[scene.positions([sensor.output])] = sensor.deviation(scene.dt)
    return noise


@lru_cache(maxsize=8)
def _stage(scene: Scene) -> tuple[ControlStep, Any]:
    """The kernel of a control period whose observations are all states and outputs as they are."""
    every = dataclasses.replace(scene, observe=names(scene.signals))
    return ControlStep(every, 1, np.dtype(float), threads=1, alike=True, plain=True), every


def rollout(scene: Scene, controller: Controller, conditions: Conditions | None = None) -> Rollout:
    """Play `scene` from `conditions` (None: `nominal`) under a controller sampled at the scene's period.

    A state that diverges or leaves the scene's bounds, an input that is not finite, and a PliantError of the
    controller end the run and are its `failure`. ValueError for a controller of another period, for signals that the
    plant does not have, and for conditions of another size.
    """
    require_instance("rollout.scene", scene, Scene)
    require_instance("rollout.controller", controller, Controller)
    if conditions is not None:
        require_instance("rollout.conditions", conditions, Conditions)
    plant, given = scene.plant, nominal(scene) if conditions is None else conditions
    step, every = _stage(scene)
    picks = _picks(scene, controller)
    _check(scene, given)
    n, limits = scene.steps, np.array(scene.limits)
    rng = np.random.default_rng([*given.seed, 1])
    readings = rng.standard_normal((n, len(every.observe)))[:, picks] * given.noise[picks]
    signals, u = np.empty((n + 1, len(every.observe))), np.empty((n, plant.nu))
    asked, act_ns = np.empty((n, plant.nu)), np.zeros(n, dtype=np.int64)
    still = np.zeros(plant.nu)
    signals[0] = np.append(given.x, scene.varied_plant.measure(given.x, still, w=given.w, p=given.p))
    step.x[:], step.w[:], step.p[:] = given.x[:, None], given.w[:, None], given.p[:, None]
    waiting = [np.clip(scene.initial[1], -limits, limits)] * given.delay
    cost, failure, done = 0.0, "", 0
    controller.reset()
    act, clock = controller.act, time.perf_counter_ns
    for k in range(n):
        y, now = signals[k, picks] + readings[k], k * scene.dt
        before = clock()
        try:
            wanted = act(now, y)
        except PliantError as error:
            failure = f"{type(error).__name__} at {now:.4g} s: {error}"
            break
        act_ns[k] = clock() - before
        wanted = real_array("rollout: controller.act", wanted).reshape(-1)
        if wanted.shape != limits.shape or not np.isfinite(wanted).all():
            failure = f"the controller gave {wanted} at {now:.4g} s, must be {plant.nu} finite numbers"
            break
        asked[k] = wanted
        waiting.append(np.minimum(np.maximum(wanted, -limits), limits))
        u[k] = waiting.pop(0)
        step.begin(k)
        step.action[:] = (u[k] / limits)[:, None]
        unsound, outside = step.run()
        done, period = k + 1, float(step.cost[0])
        cost += period
        signals[done] = step.obs[:, 0]
        if unsound[0] or outside[0]:
            failure = f"diverged at {done * scene.dt:.4g} s" if unsound[0] else _left(scene, signals[done], done)
            break
    if failure:
        cost += early_end_cost(scene, done, float(step.cost[0]) if done else 0.0)
    ends = done if failure.startswith("diverged") else done + 1
    return Rollout(
        scene.times[:ends],
        signals[:ends],
        u[:done],
        asked[:done],
        cost if np.isfinite(cost) else np.inf,
        failure,
        act_ns[:done],
        every.observe,
    )


def _left(scene: Scene, signals: np.ndarray, done: int) -> str:
    """Which bound was left."""
    known = names(scene.signals)
    over = {name: abs(signals[known.index(name)]) / bound for name, bound in scene.bounds}
    worst = max(over, key=lambda name: over[name])
    return f"{worst} beyond its bound {dict(scene.bounds)[worst]:g} at {done * scene.dt:.4g} s"


def _picks(scene: Scene, controller: Controller) -> np.ndarray:
    """Places of what the controller reads in [x; y]."""
    dt = None if controller.dt is None else require_seconds("rollout: controller.dt", controller.dt)
    if dt is not None and abs(dt - scene.dt) > 1e-9 * scene.dt:
        raise ValueError(f"rollout: controller.dt = {dt} s must be the scene's {scene.dt} s, or None")
    require_function("rollout: controller.reset", controller.reset)
    reads = require_names("rollout: controller.reads", controller.reads, repeated=True) or names(scene.plant.outputs)
    return np.array(scene.positions(reads), dtype=int)


def _check(scene: Scene, given: Conditions) -> None:
    plant = scene.varied_plant
    sizes = {"x": plant.nx, "w": plant.nw, "p": len(plant.varied), "noise": plant.nx + plant.ny}
    for name, size in sizes.items():
        require_finite(f"Conditions.{name}", getattr(given, name), (size,))
    require_count("Conditions", "delay", given.delay, 0, scene.steps)
