"""Tables for programs: what --json prints and what the report's json files hold."""

from __future__ import annotations

from functools import partial
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
    """The tables by file name; one that cannot be filled holds its `failure`."""
    fill = {
        "modes": _modes,
        "linearization": lambda found: linear_table(found.goal),
        "linearization_along": _along,
        "closed_loop": _closed_loop,
        "stability": lambda found: found.judgement.to_json(),
        "controllers": lambda found: {"horizon": HORIZON, "runs": [contest.to_json() for contest in found.contests]},
        "speed_accuracy": lambda found: found.chart.to_json(),
        "choice": lambda found: found.choice.to_json(),
        "machine": lambda found: found.machine,
    }
    tables = {}
    for name, filled in fill.items():
        table = found.attempt(f"table {name}", partial(filled, found))
        tables[name] = {"failure": found.lost[f"table {name}"]} if table is None else table
    return tables


def _modes(found: Findings) -> dict[str, Any]:
    return {
        "at": "goal",
        "modes": [vars(mode) for mode in found.goal.modes()],
        "residual": residual(found.goal) or None,
        "locked_frequencies_hz": dict(found.frequencies),
        "without_frequencies": dict(found.unheld),
    }


def _along(found: Findings) -> dict[str, Any]:
    every = (len(found.along.t) - 1) // found.scene.steps
    return {
        "t": found.along.t[::every],
        "eigenvalues": np.linalg.eigvals(found.along.A[::every]).astype(complex),
        "largest_residual": float(np.abs(found.along.c).max()),
        "perturbed": found.perturbed.name,
        "prediction_errors": [
            {"perturbation": size, "error": error, "predicted": predicted}
            for size, error, predicted in found.ltv_errors
        ],
    }


def _closed_loop(found: Findings) -> dict[str, Any]:
    return {
        "design_plant": found.scene.plant.label,
        "gain": found.law.K if found.law is not None else None,
        "reads": found.law.reads if found.law is not None else None,
        "failure": found.no_law or None,
        "open_loop_cost": found.scene.cost(found.open_loop),
        "loops": [loop.to_json() for loop in found.loops],
    }


def linear_table(model: LinearModel) -> dict[str, Any]:
    """A linear model as a table: point, names, matrices, eigenvalues."""
    table: dict[str, Any] = {
        kind: list(names(getattr(model, kind))) for kind in ("states", "inputs", "disturbances", "outputs")
    }
    table |= {key: getattr(model, key) for key in ("x0", "u0", "w0", "y0", "f0", "A", "B", "E", "C", "D", "F")}
    return table | {"eigenvalues": model.eigenvalues}
