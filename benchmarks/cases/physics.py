"""Pliant's physics steps and exact Jacobians of the 12-state two-link arm, gravity on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from harness.sampling import TIME, Case, Sampler, rate_of, time_of

from pliant.plants import TwoLinkArm
from pliant.plants.integration.batch_stepper import step_kernel, step_reference
from pliant.plants.native.batch_kernels import BatchKernel, random_points

GROUP, JACOBIANS = "physics", "jacobians"
MACHINE, SCALAR, DOUBLE, SINGLE = (
    "Pliant, virtual machine",
    "Pliant, scalar native",
    "Pliant, SIMD double",
    "Pliant, SIMD single",
)
LANES = (1, 64, 1024, 4096)
STEP = 2e-3  # [s]
POINTS = 1000


def kernel(name: str) -> BatchKernel:
    """The RK4 step of the arm on one of the four paths."""
    arm, double = TwoLinkArm.textbook(), np.dtype(np.float64)
    if name != MACHINE:
        single = np.dtype(np.float32)
        return step_kernel(arm, "rk4", single if name == SINGLE else double, lanes=1 if name == SCALAR else None)
    rows = [len(a) for a in random_points(arm, np.random.default_rng(0))], [arm.nx]
    written = partial(step_reference, arm, "rk4")
    return BatchKernel(None, written, rows, list, double, name=name, made=(kernel, (name,)), lanes=1)


def steps(name: str, lanes: int, threads: int) -> Sampler:
    """RK4 steps with the input held, many in one call, each call from the same start."""
    arm = TwoLinkArm.textbook()
    x, u = arm.equilibrium({"theta1": -1.2, "theta2": 0.3})
    work = kernel(name).workspace(lanes)
    work.set(1, x + 1e-3 * np.random.default_rng(0).uniform(-1.0, 1.0, (lanes, arm.nx)))
    work.set(2, 0.9 * u)
    count = 1 if name == MACHINE else max(20, 4000 // lanes)

    def run() -> int:
        work.run((STEP,), count, threads)
        return count * lanes

    sampler = rate_of(run)
    if not np.isfinite(work.get(0)).all():
        raise FloatingPointError(f"{name} with {lanes} lanes: states are not finite after {count} steps")
    return sampler


def jacobians(points: int, compiled: bool) -> Sampler:
    """All six matrices A, B, E, C, D, F at one point, or at many in one call."""
    arm = TwoLinkArm.textbook()
    x, u = arm.equilibrium({"theta1": -1.2, "theta2": 0.3})
    if compiled:
        arm = arm.compile()
    if points > 1:
        x = x + 0.01 * np.random.default_rng(0).uniform(-1.0, 1.0, (points, arm.nx))
        u = np.tile(u, (points, 1))
    return time_of(lambda: arm.jacobians(x, u))


def cases() -> Iterator[Case]:
    def prepared(function: Callable[..., Sampler], *arguments: object) -> Callable[[], Sampler]:
        return lambda: function(*arguments)

    for lanes in LANES:
        for threads in (1, 2):
            for name in (MACHINE, SCALAR, DOUBLE, SINGLE):
                if threads == 1 or (name != MACHINE and lanes > 1):
                    prepare = prepared(steps, name, lanes, threads)
                    yield Case(group=GROUP, name=name, lanes=lanes, threads=threads, prepare=prepare)


def jacobian_cases() -> Iterator[Case]:
    for points in (1, POINTS):
        for compiled, path in ((True, "native"), (False, "virtual machine")):
            yield Case(
                group=JACOBIANS,
                name=f"Pliant, exact Jacobians, {path}",
                unit=TIME,
                lanes=points,
                threads=2 if points > 1 and compiled else 1,
                prepare=lambda points=points, compiled=compiled: jacobians(points, compiled),
            )
