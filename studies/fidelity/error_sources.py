"""Where along a motion, and by which effect, an output at one time is made: dual-weighted residuals.

The motion of physics lacks c_e(t) of being one without an effect e. What all of it makes of an output y at a time T is

    dy(T) = h_e(x) - h(x) + int_0^T  lambda(t)^T c_e(t) dt,    -d(lambda)/dt = A^T lambda,    lambda(T) = (dy/dx)^T,

to first order in the effect (Becker and Rannacher, "An optimal control approach to a posteriori error estimation in
finite element methods", Acta Numerica 10, 2001). lambda is found once for all effects, by the transpose of the very
steps that `choose` takes forward, so that both agree to rounding; each effect then costs one evaluation of what lacks.
`choose` goes forward: its outputs are at all times, its effects few.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant, PliantError
from pliant.plants.core.argument_gates import require_instance, require_number
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics.fine_model import compared, outputs
from pliant.studies.physics.physics_motion import physics_motion
from pliant.studies.physics.quasi_linear import CorrectedMotion

Array = np.ndarray
MOVE = 1e-6  # of a state's largest value, or of 1: by so much it is moved for dy/dx


@dataclass(frozen=True, eq=False)
class ErrorSources:
    """What leaving out each effect of physics does to the compared outputs at one time, and when it does it."""

    scene: str
    outputs: tuple[str, ...]
    unit: str  # of the outputs and of all changes
    time: float  # [s] at which they are asked: a control time
    times: Array = field(repr=False)  # (nt,) [s], control times up to it
    changes: dict[str, Array]  # {effect: (n,) change of each output where it alone is left out}, to first order
    measured: dict[
        str, Array
    ]  # {effect: (n,) of these, what it does to the outputs h themselves, the motion unchanged}
    over_time: dict[str, Array] = field(repr=False)  # {effect: (nt - 1, n) what each control period adds to that}
    unseen: tuple[
        str, ...
    ]  # effects without which physics has other states or shapes: `choose` finds what they are worth

    def to_json(self) -> dict[str, Any]:
        return {
            "scene": self.scene,
            "outputs": list(self.outputs),
            "unit": self.unit,
            "time": self.time,
            "times": self.times.tolist(),
            "changes": {name: change.tolist() for name, change in self.changes.items()},
            "measured": {name: change.tolist() for name, change in self.measured.items()},
            "over_time": {name: parts.tolist() for name, parts in self.over_time.items()},
            "unseen": list(self.unseen),
        }


def error_sources(scene: Scene, time: float | None = None) -> ErrorSources:
    """The sources of what the scene compares at the control time next to `time` [s]; None: at the end.

    ValueError for a time outside the scene's; PliantError where physics has no motion, or had to be simulated: there is
    no linear model along it then.

    Example
    -------
    >>> from pliant.studies.fidelity import error_sources
    >>> found = error_sources(scene)
    >>> {name: abs(change).max() for name, change in found.changes.items()}  # [m]
    """
    scene = require_instance("error_sources.scene", scene, Scene)
    last = float(scene.times[-1])
    time = last if time is None else require_number("error_sources.time", time, "finite", "s", least=0.0, most=last)
    motions = Motions(scene)
    known = physics_motion(motions, scene.tolerance)
    if (motion := known.motion) is None:
        raise PliantError(f"{known.how}: its error has no sources that a linear model tells")
    at, parts = int(np.argmin(np.abs(scene.times - time))), motion.nodes.parts
    slopes = _output_slopes(motions, motion, at)
    weights = np.zeros((len(motion.nodes.h) + 1, *slopes.T.shape))
    weights[motion.nodes.control[at]] = slopes.T
    influence, _ = motion.collocation().influence(weights)
    x, u = motion.at_ends[motion.nodes.control[at]][None], motion.nodes.held[at][None]
    changes, measured, over_time, unseen = {}, {}, {}, []
    for name, modelled in known.physics.effects.items():
        if not modelled:
            continue
        lacking = known.physics.without(name)
        if not _alike(lacking, known.physics):
            unseen.append(name)
            continue
        c = motion.lacked_by(lacking) - motion.lacked_by(known.physics)
        each = np.einsum("mgnq,mgn->mq", influence, c).reshape(-1, parts, slopes.shape[0]).sum(axis=1)
        measured[name] = _compared(motions, lacking, at, x, u)[0] - _compared(motions, known.physics, at, x, u)[0]
        changes[name], over_time[name] = measured[name] + each.sum(axis=0), each[:at]
    return ErrorSources(
        scene=scene.name,
        outputs=scene.compare,
        unit=scene.unit,
        time=float(scene.times[at]),
        times=scene.times[: at + 1],
        changes=changes,
        measured=measured,
        over_time=over_time,
        unseen=tuple(unseen),
    )


def _output_slopes(motions: Motions, motion: CorrectedMotion, at: int) -> Array:
    """d(compared outputs)/dx (n, nx) of a motion of physics at a control time, by central differences."""
    x, held = motion.at_ends[motion.nodes.control[at]], motion.nodes.held[at]
    h = MOVE * np.maximum(np.abs(motion.at_ends).max(axis=0), 1.0)
    rows = np.vstack([x + np.diag(h), x - np.diag(h)])
    y = _compared(motions, motion.fine, at, rows, np.tile(held, (len(rows), 1)))
    slopes: Array = ((y[: len(h)] - y[len(h) :]) / (2 * h[:, None])).T
    return slopes


def _compared(motions: Motions, plant: Plant, at: int, x: Array, u: Array) -> Array:
    """The compared outputs (k, n) of a plant at states (k, nx) and inputs, at a control time."""
    columns = compared(motions, plant)
    y = outputs(plant, np.full(len(x), motions.scene.times[at]), x, u, columns)
    return np.hstack([y, x])[:, columns]


def _alike(plant: Plant, other: Plant) -> bool:
    """Whether the states of one are those of the other."""
    if len(plant.states) != len(other.states):
        return False
    E = plant.embedding(other)
    return E.shape == (other.nx, other.nx) and bool(np.allclose(E, np.eye(other.nx), rtol=0.0, atol=1e-9))
