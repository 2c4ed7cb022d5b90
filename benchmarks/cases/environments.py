"""Pliant's environment steps: two-link-reach as vector and as single environment, and the time outside the kernel."""

from __future__ import annotations

import dataclasses
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, partial
from typing import Any
from unittest import mock

import gymnasium
import numpy as np
from harness.sampling import RATE, SHARE, Case, Sampler, rate_of

import pliant.envs  # noqa: F401  registers the environments
from cases.physics import DOUBLE, LANES, MACHINE, SCALAR, SINGLE
from pliant.envs import Scene, scenes
from pliant.envs.environments.env import PlantEnv
from pliant.envs.environments.vector_env import PlantVectorEnv
from pliant.plants import StabilityLimitError
from pliant.plants.native import kernel_templates

GROUP, SINGLE_GROUP, OUTSIDE = "environments", "single environment", "outside the kernel"
MIXED_GROUP, MODELS = "lanes of several models", ("rigid", "linear", "own")
SCENE = "two-link-reach"
VECTOR = "Pliant, SIMD single, as Stable-Baselines3's VecEnv"
ACTIONS = 16  # arrays of random actions, drawn beforehand and used in turn
MOST_SUBSTEPS = 10


@cache
def substep_errors() -> tuple[tuple[int, float | None], ...]:
    """(RK4 substeps a control period, largest error of the scene's compared outputs [m]); None: unstable.

    Over the scene's open-loop motion, its input held over each control period as an environment holds it, against
    DOP853 at a relative tolerance of 1e-11.
    """
    scene = scenes.get(SCENE)
    u = np.array([scene.nominal_input(t) for t in scene.times])

    def motion(**options: Any) -> np.ndarray:
        found = scene.plant.simulate(scene.initial[0], u, scene.times, **options)
        return np.array([found[name] for name in scene.compare])

    exact = motion(method="dop853", rtol=1e-11, atol=1e-13)
    errors: list[tuple[int, float | None]] = []
    for n in range(1, MOST_SUBSTEPS + 1):
        try:
            errors.append((n, float(np.abs(motion(method="rk4", step=scene.dt / n) - exact).max())))
        except StabilityLimitError:
            errors.append((n, None))
    return tuple(errors)


def fewest_substeps() -> int:
    """The fewest substeps that keep the scene's tolerance."""
    tolerance = scenes.get(SCENE).tolerance
    return next(n for n, error in substep_errors() if error is not None and error <= tolerance)


@contextmanager
def path_of(name: str) -> Iterator[Scene]:
    """The scene under a name of its own, whose kernels are made for one of the four paths."""
    scene = dataclasses.replace(scenes.get(SCENE), name=f"{SCENE}, {name}")
    double = np.dtype(np.float64)
    before, whole = os.environ.get("PLIANT_NATIVE"), kernel_templates.LANES[double]
    try:
        if name == MACHINE:
            os.environ["PLIANT_NATIVE"] = "0"
        elif name == SCALAR:
            kernel_templates.LANES[double] = 1
        yield scene
    finally:
        kernel_templates.LANES[double] = whole
        os.environ.pop("PLIANT_NATIVE", None)
        if before is not None:
            os.environ["PLIANT_NATIVE"] = before


def vector(name: str, lanes: int, threads: int, substeps: int | None = None) -> PlantVectorEnv:
    """The randomised vector environment, reset."""
    with path_of(name) as scene:
        if substeps is not None:
            scene = dataclasses.replace(scene, substeps=substeps)
        dtype = np.float32 if name == SINGLE else np.float64
        env = PlantVectorEnv(scene, lanes, randomise=True, dtype=dtype, threads=threads)
        env.reset(seed=0)
    return env


def actions(env: Any, count: int = ACTIONS) -> list[np.ndarray]:
    """Random actions for the environment."""
    env.action_space.seed(0)
    return [env.action_space.sample() for _ in range(count)]


def vector_steps(env: Any) -> Sampler:
    """Environment steps of a vector environment under random actions."""
    chosen, turn = actions(env), 0

    def run() -> int:
        nonlocal turn
        env.step(chosen[turn % ACTIONS])
        turn += 1
        return env.num_envs

    return rate_of(run)


def mixed(lanes: int, fidelities: tuple[str, ...] | None) -> PlantVectorEnv:
    """Randomised lanes that each play one of these models, or all the scene's own."""
    env = PlantVectorEnv(SCENE, lanes, randomise=True, threads=1, fidelities=fidelities)
    env.reset(seed=0)
    return env


def single_steps(env: Any) -> Sampler:
    """Steps of one environment under random actions, reset where an episode ends."""
    chosen, turn = actions(env, 64), 0
    env.reset(seed=0)

    def run() -> int:
        nonlocal turn
        for action in chosen:
            _, _, terminated, truncated, _ = env.step(action)
            if terminated or truncated:
                env.reset()
        turn += 1
        return len(chosen)

    return rate_of(run)


def outside(name: str, lanes: int, threads: int) -> Sampler:
    """The share of a vector environment's time that is not spent in its kernel."""
    env = vector(name, lanes, threads)
    chosen, inside = actions(env), 0.0
    run = env._step.work.run

    def timed(*arguments: Any) -> None:
        nonlocal inside
        begin = time.perf_counter()
        run(*arguments)
        inside += time.perf_counter() - begin

    def sample(seconds: float) -> float:
        nonlocal inside
        with mock.patch.object(env._step.work, "run", timed):
            inside, turn, begin = 0.0, 0, time.perf_counter()
            while (spent := time.perf_counter() - begin) < seconds:
                env.step(chosen[turn % ACTIONS])
                turn += 1
        return 1.0 - inside / spent

    sample(0.0)
    return sample


def as_vec_env(lanes: int, threads: int) -> Sampler:
    """The environment as Stable-Baselines3 sees it: same-step reset, a list of infos."""
    from pliant.envs.environments.sb3_env import PlantVecEnv

    env = PlantVecEnv(SCENE, lanes, randomise=True, threads=threads)
    env.seed(0)
    env.reset()
    chosen, turn = [np.stack([env.action_space.sample() for _ in range(lanes)]) for _ in range(ACTIONS)], 0

    def run() -> int:
        nonlocal turn
        env.step(chosen[turn % ACTIONS])
        turn += 1
        return lanes

    return rate_of(run)


def diverged(substeps: int, calls: int = 500) -> tuple[int, int]:
    """(episodes that diverged, episodes) of 1,024 lanes under random actions."""
    env = vector(DOUBLE, 1024, 1, substeps)
    env.action_space.seed(0)
    spoilt = ended = 0
    for _ in range(calls):
        _, _, terminated, truncated, infos = env.step(env.action_space.sample())
        ended += int(np.count_nonzero(terminated | truncated))
        spoilt += int(np.count_nonzero(infos["diverged"])) if "diverged" in infos else 0
    return spoilt, ended


def cases() -> Iterator[Case]:
    def case(name: str, prepare: Any, group: str = GROUP, **options: Any) -> Case:
        return Case(group=group, name=name, prepare=prepare, **options)

    few = fewest_substeps()
    for lanes in LANES:
        for threads in (1, 2):
            for name in (MACHINE, SCALAR, DOUBLE, SINGLE):
                if threads == 2 and (name == MACHINE or lanes == 1):
                    continue
                for substeps in (None, few):
                    if substeps is not None and name in (MACHINE, SCALAR):
                        continue
                    make = partial(vector, name, lanes, threads, substeps)
                    shown = name if substeps is None else f"{name}, {few} substeps"
                    yield case(shown, lambda make=make: vector_steps(make()), unit=RATE, lanes=lanes, threads=threads)
    for name in (DOUBLE, SINGLE):
        for threads in (1, 2):
            yield case(name, partial(outside, name, 1024, threads), OUTSIDE, unit=SHARE, lanes=1024, threads=threads)
    for lanes in (64, 1024):
        for models in (None, *((name,) for name in MODELS), MODELS):
            shown = f"Pliant, {'as it is' if models is None else ' or '.join(models)}"
            make = partial(mixed, lanes, models)
            yield case(shown, lambda make=make: vector_steps(make()), MIXED_GROUP, unit=RATE, lanes=lanes, threads=1)
    yield case(VECTOR, partial(as_vec_env, 1024, 2), lanes=1024, threads=2, peer=True)
    yield case("Pliant, PlantEnv", lambda: single_steps(PlantEnv(SCENE)), SINGLE_GROUP)
    made = partial(gymnasium.make, "pliant/TwoLinkReach-v0", disable_env_checker=True)
    yield case("Pliant, gymnasium.make", lambda: single_steps(made()), SINGLE_GROUP)
