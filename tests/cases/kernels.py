"""Kernels of every kind that Pliant compiles: of scenes' plants by all steppers, Jacobians, of environments."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from pliant.controllers.analytic_gradients.step_adjoints import adjoint_kernel
from pliant.envs import scenes
from pliant.envs.simulation import episode_start
from pliant.envs.simulation.control_kernel import control_kernel
from pliant.plants import LargeDeflectionBeam, SingleLinkArm, SliderCrank, TwoLinkArm
from pliant.plants.integration.batch_stepper import rate_function, step_kernel
from pliant.plants.integration.step_sensitivities import sensitivity_kernel
from pliant.plants.native.batch_kernels import BatchKernel, map_kernel, random_points

DOUBLE, SINGLE = np.dtype(np.float64), np.dtype(np.float32)
Maker = Callable[[np.dtype], BatchKernel]


def _drawn(plant: Any) -> Any:
    return lambda rng: random_points(plant, rng)


def _jacobians(plant: Any) -> Maker:
    return lambda dtype: map_kernel(plant._jacobians.function, _drawn(plant), dtype)


def _steps(plant: Any, method: str, lanes: int | None = None) -> Maker:
    return lambda dtype: step_kernel(plant, method, dtype, lanes)


def _of_scene(name: str) -> dict[str, Maker]:
    scene = scenes.get(name)
    plant, varied = scene.plant, scene.varied_plant
    made: dict[str, Maker] = {f"{name} control": lambda dtype: control_kernel(scene, dtype)}
    for method in ("rk4", "rk8", "rosenbrock"):
        made[f"{name} {method}"] = _steps(plant, method)
    made[f"{name} rk4, varied"] = _steps(varied, "rk4")
    made[f"{name} rk4, one lane"] = _steps(plant, "rk4", 1)
    made[f"{name} jacobians"] = _jacobians(plant)
    made[f"{name} sensitivities"] = lambda dtype: sensitivity_kernel(plant, dtype)
    made[f"{name} adjoints"] = lambda dtype: adjoint_kernel(plant, 2, dtype)
    made[f"{name} observations"] = lambda dtype: episode_start._observing(scene)._made
    if scene.start_at_rest and plant.statics() is not None and len(scene.start) == plant.nu and not plant.prescribed:
        made[f"{name} newton"] = lambda dtype: episode_start._newton(scene)._made
    return made


@lru_cache(maxsize=1)
def of_scenes() -> dict[str, Maker]:
    """Every kind of kernel of every scene; kernels of double precision alone ignore what they are asked for."""
    return {name: maker for scene in scenes.names() for name, maker in _of_scene(scene).items()}


@lru_cache(maxsize=1)
def small() -> dict[str, Maker]:
    """Kernels of all kinds whose compilation takes less than a second."""
    link, arm, crank = SingleLinkArm.textbook(), TwoLinkArm.textbook(), SliderCrank.textbook()
    beam, craft = LargeDeflectionBeam.textbook(), scenes.get("spacecraft-slew").plant
    made = {
        "link rates": lambda dtype: map_kernel(rate_function(link), _drawn(link), dtype),
        "link rates, one lane": lambda dtype: map_kernel(rate_function(link), _drawn(link), dtype, 1),
        "link jacobians": _jacobians(link),
        "link rk4": _steps(link, "rk4"),
        "link rk8": _steps(link, "rk8"),
        "link rosenbrock": _steps(link.ladder()[0], "rosenbrock"),
        "link rk4, one lane": _steps(link, "rk4", 1),
        "link sensitivities": lambda dtype: sensitivity_kernel(link, dtype),
        "link adjoints": lambda dtype: adjoint_kernel(link, 2, dtype),
        "arm rk4": _steps(arm, "rk4"),
        "crank rk4": _steps(crank, "rk4"),
        "beam rk8": _steps(beam, "rk8"),
        "craft rk4": _steps(craft, "rk4"),
    }
    for name in ("single-link-slew", "spin-up", "spacecraft-slew", "two-link-reach"):
        every = of_scenes()
        made |= {k: every[k] for k in (f"{name} control", f"{name} observations", f"{name} newton") if k in every}
    return made
