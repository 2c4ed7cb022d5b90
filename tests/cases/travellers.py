"""What travels: one object or more of every public class, in the middle of what it does, and what it does next.

MAKERS: name -> a function that makes the object, partly used. `go_on(name, thing)` drives it on, and returns arrays.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import travelling_controllers
import travelling_environments
import travelling_models
import travelling_plants
import travelling_records

PARTS = (
    travelling_controllers,
    travelling_plants,
    travelling_models,
    travelling_environments,
    travelling_records,
)
MAKERS = {name: make for part in PARTS for name, make in part.ROLL.makers.items()}
GOING = {name: go_on for part in PARTS for name, go_on in part.ROLL.going.items()}


def go_on(name: str, thing: Any) -> list[np.ndarray]:
    """What it does next, as arrays."""
    return list(_arrays(GOING[name](thing)))


def _arrays(found: Any) -> Any:
    if isinstance(found, (tuple, list)):
        for part in found:
            yield from _arrays(part)
    elif isinstance(found, dict):
        for key in sorted(found, key=str):
            yield from _arrays(found[key])
    elif found is not None:
        yield np.array(found)


# Why a class, or all of a module, does not travel by itself.
NOT_MADE: dict[str, str] = {
    "plants.native": "compiled code: who owns it makes it anew, and is tried here",
    "plants.beams": "shape functions: parts of a plant's expressions, which are made anew from its fields",
    "plants.large_deflection": "sections and chains: parts of a plant's expressions, made anew from its fields",
    "plants.spacecraft": "parts of a spacecraft's expressions, made anew from its fields",
    "plants.spacecraft_parts.appendage.Inertia": "expressions",
    "plants.spacecraft_perturbation": "verification of a paper: nobody keeps one",
    "plants.slider_crank.rigid_kinematics": "expressions",
    "plants.core.casadi_functions": "a CasADi function, which travels itself, and its buffers",
    "plants.core.errors": "warnings: a message and no more; errors are tried",
    "plants.core.imports": "a module under another name",
    "plants.core.runge_kutta_tableaux": "constants of the library",
    "plants.core.signals": "what lets the others travel, and rows of a model in passing",
    "plants.dynamics.python_control.Shared": "in passing, inside python-control",
    "plants.dynamics.residual_jacobians": "expressions",
    "plants.integration": "a method, or a step in passing; steppers are tried inside what has one",
    "plants.linear.model_signals": "the base of the linear models",
    "plants.linear.rest_spaces": "in passing, inside a verdict or a design",
    "plants.transitions.eigenvalue_bounds": "in passing, inside a verdict",
    "plants.transitions.transition_error": "in passing, inside a verdict",
    "plants.validity": "a range, an expression of its plant",
    "controllers.learning": "training: it has its own checkpoints; settings, policies and evaluations are tried",
    "controllers.linear_quadratic.hold_set": "in passing, inside TVLQR's design",
    "controllers.mpc": "in passing, inside MPC's design",
    "controllers.nmpc.terminal_cost": "a warning",
    "controllers.optimal_control": "in passing, inside a solve",
    "controllers.riccati": "in passing, inside a design; regulators are tried",
    "controllers.solvers": "in passing, inside a solve",
    "envs.rendering": "a window of this process",
    "envs.scenes.scene.Manoeuvre": "the base of Scene",
    "envs.simulation": "compiled code: the environments make it anew",
    "studies.commands": "the command line",
    "studies.common.reference_motions": "a cache of this process",
    "studies.charts": "in passing, inside a chart",
    "studies.physics.motion_nodes": "in passing, inside a choice",
    "studies.physics.physics_motion": "in passing, inside a choice",
    "studies.physics.quasi_linear": "in passing, inside a choice",
}
