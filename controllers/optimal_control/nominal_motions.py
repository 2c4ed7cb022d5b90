"""Nominal motions on control times, for laws that follow them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from pliant.controllers.base.controller import share
from pliant.controllers.base.objective import Objective
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.plants.core.argument_gates import (
    require_choice,
    require_finite,
    require_instance,
    require_parts,
    require_seconds,
    shown,
)
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant

from .optimal import Motion, driven, optimal
from .plan import plan

MOST_PERIODS = 1_000_000  # of control, in a nominal motion
NOMINALS = ("plan", "optimal", "rigid")
STILL = 1e-6  # largest rate of a state that rests


def rests(scene: CostedScene) -> bool:
    """Whether the scene starts and ends at rest."""
    require_scene("rests", scene)
    return scene.goal_at_rest and bool(np.abs(scene.plant.dynamics(*scene.initial)).max(initial=0.0) < STILL)


def chosen_nominal(owner: str, scene: CostedScene, nominal: Any) -> Any:
    """A motion, or which one; None: "plan" from rest to rest, else "optimal"."""
    if nominal is None:
        return "plan" if rests(scene) else "optimal"
    if isinstance(nominal, str):
        require_choice(owner, "nominal", nominal, NOMINALS)
    elif not isinstance(nominal, (Motion, Trajectory)):
        raise ValueError(f"{owner}.nominal = {shown(nominal)} must be a motion or one of {', '.join(NOMINALS)}")
    return nominal


def nominal_for(scene: CostedScene, kind: str, reserve: float) -> Motion | Trajectory:
    """ "plan": least effort to rest at the goal; "optimal": of least cost; both with a share of the limits in reserve.

    "rigid": the rigid plant's states under the scene's own nominal input.
    """
    require_scene("nominal_for", scene)
    require_choice("nominal_for", "kind", kind, NOMINALS)
    reserve = share("nominal_for.reserve", reserve)
    if kind == "plan":
        return plan(scene, reserve=reserve)
    if kind == "rigid":
        return rigid_nominal(scene)
    about = Objective.of(scene)
    low, high = about.limits
    kept = replace(about, limits=((1 - reserve) * low, (1 - reserve) * high))
    return optimal(kept, scene.initial[0], scene.steps, substeps=scene.substeps, guess=driven(scene))


def rigid_nominal(scene: CostedScene) -> Trajectory:
    """The rigid plant's motion under the scene's nominal input, over its move_time, in the states of the scene's plant.

    What the rigid plant lacks, elastic coordinates and their rates, goes straight from start to goal.
    """
    require_scene("rigid_nominal", scene)
    plant, rigid = scene.plant, scene.plant.ladder()[0]
    own, names = [s.name for s in plant.states], [s.name for s in rigid.states]
    if not set(names) <= set(own):
        raise ValueError(f"nominal: the rigid plant's states {', '.join(names)} must be states of the plant")
    T = round(scene.move_time / scene.dt)
    t = scene.dt * np.arange(T + 1)
    places = [own.index(name) for name in names]
    x0, x1 = scene.initial[0], scene.target[0]
    motion = rigid.simulate(x0[places], scene.nominal_input, t)
    x = x0 + np.linspace(0.0, 1.0, T + 1)[:, None] * (x1 - x0)
    x[:, places] = motion.x
    return Trajectory.from_arrays(t, x, motion.u, plant=plant)


def nodes(nominal: Motion | Trajectory, dt: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """t (T+1,), x (T+1, nx) and inputs (T, nu) held in between, from a motion on the same times or any others."""
    dt = require_seconds("TVLQR.dt", dt)
    if not isinstance(nominal, (Motion, Trajectory)):
        raise ValueError(f"the nominal = {shown(nominal)} must be a Motion or a Trajectory")
    require_parts("TVLQR.dt", dt, float(nominal.t[-1] - nominal.t[0]), MOST_PERIODS, "periods")
    T = round((nominal.t[-1] - nominal.t[0]) / dt)
    if T < 1:
        raise ValueError(f"the nominal takes {nominal.t[-1] - nominal.t[0]:g} s, must be at least dt = {dt:g} s")
    t = nominal.t[0] + dt * np.arange(T + 1)
    same = len(nominal.t) == T + 1 and np.allclose(nominal.t, t, rtol=0, atol=1e-6 * dt)
    if isinstance(nominal, Motion):
        if not same:
            raise ValueError(f"the nominal's control period must be dt = {dt:g} s")
        return nominal.t, nominal.x, nominal.u
    at_nodes = nominal if same else nominal.resample(np.minimum(t, nominal.t[-1]))
    if nominal.hold == "zero-order":
        return t, at_nodes.x, at_nodes.u[:-1]
    return t, at_nodes.x, (at_nodes.u[:-1] + at_nodes.u[1:]) / 2


def nodes_of(plant: Plant, nominal: Motion | Trajectory, dt: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`nodes` of a motion in a plant's states and inputs."""
    require_instance("TVLQR.along: plant", plant, Plant)
    t, x, u = nodes(nominal, dt)
    for name, rows, n in (("states", x, plant.nx), ("inputs", u, plant.nu)):
        require_finite(f"TVLQR.nominal: {name}", rows, (-1, n))
    return t, x, u
