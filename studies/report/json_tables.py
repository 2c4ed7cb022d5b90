"""Tables for programs: what --json prints and what the report's json files hold."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import LinearModel, Trajectory
from pliant.plants.core.signals import names
from pliant.studies.closed_loop.comparison import HORIZON
from pliant.studies.common.operating_point import residual

from .findings import Findings


def scene_table(scene: Scene) -> dict[str, Any]:
    """What a scene is, in a few numbers."""
    return {
        "name": scene.name,
        "about": scene.about,
        "plant": scene.plant.label,
        "states": scene.plant.nx,
        "duration": scene.duration,
        "dt": scene.dt,
        "limits": scene.limits,
        "tolerance": scene.tolerance,
    }


def motion_table(scene: Scene, motion: Trajectory) -> dict[str, Any]:
    """A motion's signals over time with their units, its cost and how it was integrated."""
    signals = (*motion.states, *motion.inputs, *motion.outputs)
    return {
        "scene": scene.name,
        "plant": scene.plant.label,
        "cost": scene.cost(motion),
        "stats": motion.stats,
        "t": motion.t,
        "signals": {s.name: motion[s.name] for s in signals},
        "units": {s.name: s.unit for s in signals},
    }


def tables_of(found: Findings) -> dict[str, Any]:
    """The tables by file name."""
    scene, goal = found.scene, found.goal
    every = (len(found.along.t) - 1) // scene.steps
    return {
        "modes": {
            "at": "goal",
            "modes": [vars(mode) for mode in goal.modes()],
            "residual": residual(goal) or None,
            "locked_frequencies_hz": dict(found.frequencies),
        },
        "linearization": linear_table(goal),
        "linearization_along": {
            "t": found.along.t[::every],
            "eigenvalues": np.linalg.eigvals(found.along.A[::every]).astype(complex),
            "largest_residual": float(np.abs(found.along.c).max()),
            "perturbed": found.perturbed.name,
            "prediction_errors": [
                {"perturbation": size, "error": error, "predicted": predicted}
                for size, error, predicted in found.ltv_errors
            ],
        },
        "closed_loop": {
            "design_plant": scene.plant.label,
            "gain": found.law.K if found.law is not None else None,
            "reads": found.law.reads if found.law is not None else None,
            "failure": found.no_law or None,
            "open_loop_cost": scene.cost(found.open_loop),
            "loops": [loop.to_json() for loop in found.loops],
        },
        "stability": found.judgement.to_json(),
        "controllers": {"horizon": HORIZON, "runs": [contest.to_json() for contest in found.contests]},
        "speed_accuracy": found.chart.to_json(),
        "choice": found.choice.to_json(),
        "machine": found.machine,
    }


def linear_table(model: LinearModel) -> dict[str, Any]:
    """A linear model as a table: point, names, matrices, eigenvalues."""
    table: dict[str, Any] = {
        kind: list(names(getattr(model, kind))) for kind in ("states", "inputs", "disturbances", "outputs")
    }
    table |= {key: getattr(model, key) for key in ("x0", "u0", "w0", "y0", "f0", "A", "B", "E", "C", "D", "F")}
    return table | {"eigenvalues": model.eigenvalues}
