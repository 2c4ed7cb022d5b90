"""`simulate` beside the stepper for the same steps, the input held, its adaptive steps beside rk8 at equal error, the
method for stiff plants beside dop853 at equal error, also on scenes where stability bounds dop853's steps.

Kernels are warm: built before, as they are once a plant has been simulated for longer than building them takes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache, lru_cache, partial
from typing import Any

import numpy as np
from harness.sampling import TIME, Case, Row, Sampler, ratio, time_of

from pliant.envs import Scene, scenes
from pliant.plants import IntegrationError, MassMatrixError, StabilityLimitError, Trajectory
from pliant.plants.integration.batch_stepper import motion_kernel
from pliant.plants.motions import played_motion
from pliant.plants.motions.observations import compile_observations
from pliant.plants.rosenbrock.library import adaptive_kernel

GROUP = "motions"
NAMES = ("two-link-reach", "cantilever-drop", "single-link-slew", "spin-up")
STIFF = ("slider-crank-run", "spacecraft-orbit")
METHODS = ("rk4", "rk8")
TOLERANCES = (1e-5, 1e-7)  # rtol of dop853; rk8 then takes the fewest steps a period that err by no more
MOST_SUBSTEPS = 64
LOOSE, FINER, FINEST = 1e-4, 10**0.5, 1e-13  # rtol of rodas5p where the search begins, its step, and where it ends
ROUNDED = 1e-11  # of an output: both may err by as much from rounding


@lru_cache(maxsize=len(NAMES) + len(STIFF))
def given(name: str) -> tuple[Scene, np.ndarray]:
    """A scene and its nominal input, held over its control periods (nt, nu), with every kernel at hand."""
    scene = scenes.get(name)
    for method in METHODS:
        kernel = motion_kernel(scene.plant, method)
        assert kernel is not None
        kernel.spent = np.inf  # so that it is built now
    compile_observations(scene.plant, np.inf)
    adaptive_kernel(scene.plant).spent = np.inf
    played_motion.program.at_hand(np.inf)
    return scene, np.array([scene.nominal_input(t) for t in scene.times]).reshape(len(scene.times), -1)


def motion(name: str, **options: Any) -> Trajectory:
    """The scene's open loop. RuntimeError unless compiled code has run all of it."""
    scene, u = given(name)
    found = scene.plant.simulate(scene.initial[0], u, scene.times, **options)
    if not found.stats["native"]:
        raise RuntimeError(f"{name}: simulate did not run on compiled code with {options}")
    return found


def by_steps(name: str, method: str, substeps: int) -> Trajectory:
    return motion(name, method=method, step=given(name)[0].dt / substeps)


def simulated(name: str, method: str) -> Sampler:
    return time_of(partial(by_steps, name, method, given(name)[0].substeps))


def stepped(name: str, method: str) -> Sampler:
    """The same steps by the stepper, called once a control period, without outputs, dx/dt or checks on the way."""
    scene, u = given(name)
    step = scene.plant.stepper(scene.dt, method=method, batch=1, substeps=scene.substeps)

    def run() -> None:
        x = np.asfortranarray(scene.initial[0][None].copy())
        for k in range(scene.steps):
            step(x, u[k], out=x)

    return time_of(run)


@cache
def allowed(name: str, rtol: float) -> tuple[np.ndarray, float]:
    """The outputs, and by how much dop853's at rtol err at most."""
    exact = motion(name, rtol=1e-13, atol=1e-14).y
    error = np.abs(motion(name, rtol=rtol, atol=rtol * 1e-2).y - exact).max()
    return exact, float(error + ROUNDED * np.abs(exact).max())


@cache
def equal_error(name: str, rtol: float) -> int:
    """The fewest rk8 steps a control period with which outputs err by no more than dop853's at rtol do."""
    exact, most = allowed(name, rtol)
    for substeps in range(1, MOST_SUBSTEPS):
        try:
            if np.abs(by_steps(name, "rk8", substeps).y - exact).max() <= most:
                return substeps
        except (StabilityLimitError, IntegrationError, MassMatrixError):
            continue  # past its step limit, or run away: more steps
    return MOST_SUBSTEPS


def adaptive(name: str, rtol: float) -> Sampler:
    return time_of(partial(motion, name, rtol=rtol, atol=rtol * 1e-2))


def stiffly(name: str, rtol: float) -> Sampler:
    """rodas5p at the loosest tolerance with which outputs err by no more than dop853's at rtol do."""
    (exact, most), own = allowed(name, rtol), LOOSE
    while own > FINEST:
        options = {"method": "rodas5p", "rtol": own, "atol": own * 1e-2}
        if np.abs(motion(name, **options).y - exact).max() <= most:
            return time_of(partial(motion, name, **options))
        own /= FINER
    raise RuntimeError(f"{name}: rodas5p errs by more than dop853 at {rtol:g}, however small its tolerance")


def as_exact(name: str, rtol: float) -> Sampler:
    return time_of(partial(by_steps, name, "rk8", equal_error(name, rtol)))


def case_name(what: str, scene: str, how: object) -> str:
    return f"{what}, {scene}, {how}"


def cases() -> Iterator[Case]:
    def case(what: str, name: str, how: str, prepare: Callable[[], Sampler]) -> Case:
        return Case(group=GROUP, name=case_name(what, name, how), unit=TIME, prepare=prepare)

    for name in NAMES:
        for method in METHODS:
            yield case("simulate", name, method, partial(simulated, name, method))
            yield case("stepper", name, method, partial(stepped, name, method))
        for rtol in TOLERANCES:
            yield case("dop853", name, f"{rtol:g}", partial(adaptive, name, rtol))
            yield case("rk8 at its error", name, f"{rtol:g}", partial(as_exact, name, rtol))
            yield case("rodas5p at its error", name, f"{rtol:g}", partial(stiffly, name, rtol))
    for name in STIFF:
        for what, prepare in (("dop853", adaptive), ("rodas5p at its error", stiffly)):
            yield case(what, name, f"{TOLERANCES[0]:g}", partial(prepare, name, TOLERANCES[0]))


def over(rows: Sequence[Row], what: str, other: str, how: Sequence[str]) -> float | None:
    """The largest ratio of the times of `what` over those of `other`, over the scenes; None where none is measured."""
    known = {r.name: r for r in rows if r.group == GROUP}
    found = [
        ratio(known.get(case_name(what, name, h)), known.get(case_name(other, name, h))) for name in NAMES for h in how
    ]
    return max((f for f in found if f is not None), default=None)
