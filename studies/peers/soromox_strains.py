"""SoRoMoX: a clamped beam of piecewise constant curvature, in JAX, by its own rollout with diffrax's Tsit5.

Its sections are solid circles; one of radius 2 sqrt(I/A) with the link's mass per length has its rotary inertia too,
and the stiffness is given. The axis neither stretches nor shears.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from .planar_machine import Machine
from .programs import BrokenDownError, Motion, Player, Setting


class Strains:
    """PlanarPCS with the curvature of each segment for a coordinate, compiled."""

    peer = "SoRoMoX, piecewise constant strain"
    package = "soromox"
    part = "segments"

    def why_not(self, machine: Machine) -> str:
        if machine.root != "clamped":
            return (
                "its planar model of strains stands on a fixed base without joints; its articulated one is a chain of "
                "rigid segments, as MuJoCo's"
            )
        return "its beam carries no payload" if machine.payload.mass or machine.payload.inertia_z else ""

    def parts(self, machine: Machine) -> tuple[int, ...]:
        return 4, 8  # each takes half a minute to compile

    def solvers(self) -> tuple[str, ...]:
        return ("Tsit5",)

    def beside(self, solver: str) -> tuple[str, ...]:
        return ()

    def player(self, machine: Machine, setting: Setting) -> Player:
        run, tips = compiled(machine, setting.parts)
        step = machine.dt / setting.substeps

        def play() -> tuple[Motion, float]:
            begin = time.perf_counter()
            q = run(step)
            seconds = time.perf_counter() - begin
            if not np.abs(q).max() < 1e3:
                raise BrokenDownError("the steps are too long")
            return (tips(q), np.full(len(q), machine.angles[0])), seconds

        return Player(play, lambda: play()[1])


@lru_cache(maxsize=4)
def compiled(machine: Machine, parts: int) -> tuple[Callable[[float], np.ndarray], Callable[[np.ndarray], np.ndarray]]:
    """The motion's coordinates (nt, parts) at a step [s], and the tips (nt, 2) [m] at coordinates."""
    import jax
    from jax import numpy as jnp

    with jax.enable_x64(True):  # single precision is JAX's default
        model, length = robot(machine, parts), machine.links[0].length
        times = jnp.asarray(machine.dt * np.arange(machine.steps + 1))

        def rollout(step: Any) -> Any:
            from soromox.systems import SystemState

            start = SystemState(t=jnp.asarray(0.0), y=jnp.zeros(2 * parts))
            return model.rollout_to(start, t1=times[-1], solver_dt=step, save_ts=times).y[:, :parts]

        played = jax.jit(rollout)
        placed = jax.jit(jax.vmap(lambda q: model.forward_kinematics(q, jnp.asarray(length))[1:]))
        played(machine.dt).block_until_ready()

    def run(step: float) -> np.ndarray:
        with jax.enable_x64(True):
            return np.asarray(played(step).block_until_ready())

    def tips(q: np.ndarray) -> np.ndarray:
        with jax.enable_x64(True):
            return np.asarray(placed(jnp.asarray(q)))

    return run, tips


def robot(machine: Machine, parts: int) -> Any:
    """SoRoMoX's model of the clamped beam, in the precision that JAX is set to."""
    from jax import numpy as jnp
    from soromox.systems import LinkSpec, PlanarPCS, PlanarPCSStructure

    link = machine.links[0]
    radius, part = 2 * np.sqrt(link.I_z / link.area), link.length / parts
    bending = np.diag([link.EI * part, 0.0, 0.0])
    unused = np.diag([0.0, 1.0, 1.0])  # of strains that stay as they are
    spec = LinkSpec.circular(
        length=part,
        radius=float(radius),
        density=float(link.linear_density / (np.pi * radius**2)),
        reference_strain=[0.0, 1.0, 0.0],
        stiffness=bending + unused,
        damping=link.damping * bending,
    )
    return PlanarPCS.from_links(
        [spec] * parts,
        structure=PlanarPCSStructure(strain_selector=jnp.array([True, False, False] * parts)),
        gravity=jnp.array(machine.gravity),
        base_pose=jnp.array([machine.angles[0], 0.0, 0.0]),
    )
