"""Trees of bodies: six-axis-pick, whose arm comes from a URDF and bends by 2 + 2 + 1 shapes of its forearm, and
three-link-flexible under the horizon that its authors publish. Beside them Pinocchio's ABA on the same arm, rigid.

A step of RK4 takes four right-hand sides; of Pinocchio's a call of its ABA from Python counts a quarter of one.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from harness.sampling import RATE, TIME, Case, Row, Sampler, acts_of, rate_of, time_of

from pliant import controllers
from pliant.envs import scenes
from pliant.envs.environments.vector_env import PlantVectorEnv
from pliant.envs.machines.trees import SIX_AXIS
from pliant.plants import FlexibleTree
from pliant.plants.integration.batch_stepper import rate_function

from .kernel_growth import SILENT

GROUP, LANES = "trees", 1024
SIX, THREE = "six-axis-pick", "three-link-flexible"
BENT, RIGID, ABA = f"RK4 step, {SIX}", f"RK4 step, {SIX}, rigid", "Pinocchio's ABA through Python, the rigid arm"
JACOBIANS, ENVIRONMENT, COLD = f"exact A, B, {SIX}, native", f"environment, {SIX}", f"kernels of {SIX}, empty cache"
GENERATED = Path(__file__).resolve().parents[1] / "results/trees/pinocchio_code.json"
SHORT, LONG = 20, 125  # control periods of the horizons
ACTS = {
    f"LQR, {SIX}": (SIX, "LQR", {}),
    f"MPC, {SHORT} steps, {SIX}": (SIX, "MPC", {"horizon": SHORT}),
    f"NMPC, {SHORT} steps of 10 ms, {SIX}": (SIX, "NMPC", {"horizon": SHORT}),
    f"LQR, {THREE}": (THREE, "LQR", {}),
    f"MPC, {SHORT} steps, {THREE}": (THREE, "MPC", {"horizon": SHORT}),
    f"NMPC, {LONG} steps of 5 ms, {THREE}": (THREE, "NMPC", {"horizon": LONG, "substeps": 11}),
}
MPC_SIX, NMPC_SIX, NMPC_THREE = (list(ACTS)[k] for k in (1, 2, 5))
COLD_CODE = """
import sys
sys.path.insert(0, sys.argv[1])
from harness.sampling import clock
from pliant.envs import scenes
from pliant.envs.environments.vector_env import PlantVectorEnv
scene = scenes.get("six-axis-pick")
begin = clock()
scene.plant.stepper(1e-3, batch=1024)
PlantVectorEnv(scene, 1024).reset(seed=0)
print(clock() - begin)
"""


def plant(name: str) -> Any:
    """Of a scene; "rigid": six-axis-pick's without bending."""
    return scenes.get(SIX).plant.ladder()[0] if name == "rigid" else scenes.get(name).plant


@cache
def operations(name: str) -> int:
    """Of one right-hand side."""
    rate = rate_function(plant(name))
    return sum(rate.instruction_id(k) not in SILENT for k in range(rate.n_instructions()))


def steps(name: str) -> Sampler:
    """RK4 steps of many lanes on one thread, from about the scene's start under its holding inputs."""
    moved, scene = plant(name), scenes.get(SIX)
    x, u = scene.with_plant(moved).initial
    rng = np.random.default_rng(0)
    X = np.asfortranarray(x + 0.01 * rng.uniform(-1.0, 1.0, (LANES, moved.nx)) * (np.arange(moved.nx) < 6))
    step, U = moved.stepper(1e-6, batch=LANES, threads=1), np.asfortranarray(np.tile(u, (LANES, 1)))

    def run() -> int:
        step(X, U)
        return LANES

    return rate_of(run)


def jacobians() -> Sampler:
    scene = scenes.get(SIX)
    native, (x, u) = scene.plant.compile(), scene.initial
    return time_of(lambda: native.jacobians(x, u))


def aba() -> Sampler:
    import pinocchio as pin

    model = pin.buildModelFromUrdf(str(SIX_AXIS))
    data, rng = model.createData(), np.random.default_rng(0)
    q, v, tau = (rng.uniform(-1.0, 1.0, n) for n in (model.nq, model.nv, model.nv))

    def run() -> int:
        for _ in range(400):
            pin.aba(model, data, q, v, tau)
        return 100

    return rate_of(run)


def environment() -> Sampler:
    env = PlantVectorEnv(scenes.get(SIX), LANES, randomise=True, threads=2)
    env.reset(seed=0)
    env.action_space.seed(0)
    chosen, turn = [env.action_space.sample() for _ in range(16)], 0

    def run() -> int:
        nonlocal turn
        env.step(chosen[turn % len(chosen)])
        turn += 1
        return LANES

    return rate_of(run, threads=2)


def cold() -> Sampler:
    """Seconds until stepper and environment have compiled, in a new process on an empty cache."""

    def sample(seconds: float) -> float:
        with tempfile.TemporaryDirectory() as folder:
            told = subprocess.run(
                [sys.executable, "-W", "ignore", "-c", COLD_CODE, str(Path(__file__).parents[1])],
                env=os.environ | {"PLIANT_CACHE": folder}, capture_output=True, text=True, check=True,
            )  # fmt: skip
        return float(told.stdout.splitlines()[-1])

    return sample


@cache
def readings(name: str) -> tuple[tuple[float, np.ndarray], ...]:
    """(time, what its controller reads) over an episode in closed loop; the controller is `maker(name)`."""
    scene, controller = scenes.get(ACTS[name][0]), maker(name)
    moved, high = scene.plant, np.array(scene.limits)
    step, picks = moved.stepper(scene.dt, substeps=scene.substeps), scene.positions(controller.reads)
    x, u, told = scene.initial[0].copy(), np.zeros(moved.nu), []
    controller.reset()
    for t in scene.times[:100]:
        y = np.concatenate([x, moved.measure(x, u)])[picks]
        told.append((float(t), y))
        u = np.clip(controller.act(t, y), -high, high)
        x = step(x[None], u[None])[0].copy()
    return tuple(told)


@cache
def maker(name: str) -> Any:
    scene, kind, options = ACTS[name]
    return getattr(controllers, kind).for_scene(scenes.get(scene), **options)


def acts(name: str) -> Sampler:
    """Median and 99th percentile [s] of single acts over passes through an episode, its first act left out."""
    return acts_of(maker(name), [[(t, y, k > 0) for k, (t, y) in enumerate(readings(name))]])


def cases() -> Iterator[Case]:
    for name, of in ((BENT, SIX), (RIGID, "rigid")):
        yield Case(group=GROUP, name=name, unit=RATE, lanes=LANES, prepare=partial(steps, of))
    yield Case(group=GROUP, name=ABA, unit=RATE, peer=True, prepare=aba)
    yield Case(group=GROUP, name=JACOBIANS, unit=TIME, prepare=jacobians)
    yield Case(group=GROUP, name=ENVIRONMENT, unit=RATE, lanes=LANES, threads=2, prepare=environment)
    yield Case(group=GROUP, name=COLD, unit=TIME, rounds=2, prepare=cold)
    for name in ACTS:
        yield Case(group=GROUP, name=name, unit=TIME, prepare=partial(acts, name))


def notes(rows: Sequence[Row]) -> list[str]:
    """Operations of a right-hand side, and how the machine is written."""
    if not any(row.group == GROUP for row in rows):
        return []
    assert isinstance(scenes.get(SIX).plant, FlexibleTree)
    each = ", ".join(f"{name} {operations(name):,}" for name in (SIX, "rigid", THREE))
    theirs = json.loads(GENERATED.read_text(encoding="utf-8"))
    return [
        f"Trees: operations of a right-hand side: {each} (rigid: {SIX}'s arm without bending, with its payload and "
        f"damped joints). The code that Pinocchio {theirs['pinocchio']} generates of its ABA of that rigid arm, common "
        f"subexpressions removed: {theirs['operations']:,} (`peers/pinocchio_code/count.py`). Acts are those of an "
        "episode's first 100 periods; the first act, which makes a first plan, is left out."
    ]
