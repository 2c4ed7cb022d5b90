"""Whether a scene can do without geometric stiffening: decided from its speed profile, with the evidence.

1  The profile's largest spin against the lowest bending frequency with the joints locked: from there on the
   unstiffened model is unstable, and stiffening is needed.
2  Below it, what stiffening adds to the rates along the unstiffened motion x1, c = f_stiffened - f_linear, is a load:
   for one link -theta'^2 int vartheta phi' phi'^T q and its reaction on the hub. The response to it of the stiffened
   model linearised about x1, and the shortening of the tip, are the error of leaving it out. A second pass, with what
   the linearisation missed as a load too, says how far to trust the first.

Stiffening is needed where the error and its uncertainty together exceed the scene's tolerance. No stiffened motion is
simulated; tests compare the error with the difference of the two motions.
"""

from __future__ import annotations

import dataclasses
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant, PliantError, Trajectory, ValidityWarning
from pliant.plants.core.argument_gates import require_instance
from pliant.plants.core.signals import index
from pliant.plants.integration.minimum_jerk import minimum_jerk

NODES = 4  # of the linear model in a control period


@dataclass(frozen=True, kw_only=True)
class Stiffening:
    """The answer (also as a truth value) and why."""

    needed: bool
    error: float  # largest error of the compared outputs without stiffening [m]; infinite where it runs away
    uncertainty: float  # of that error [m]
    tolerance: float  # the scene's [m]
    speed: float  # largest turning rate of a link [rad/s]
    critical_speed: float  # spin at which the unstiffened model loses its stiffness [rad/s]
    why: str

    def __bool__(self) -> bool:
        return self.needed

    @property
    def ratio(self) -> float:
        """(speed/critical speed)^2: the share of the bending stiffness that is at stake."""
        return (self.speed / self.critical_speed) ** 2


def stiffening_needed(scene: Scene) -> Stiffening:
    """Whether leaving out geometric stiffening errs by more than scene.tolerance in scene.compare.

    ValueError unless the scene's plant has a `stiffening` to choose, kinematics "linear" or "stiffened".
    """
    require_instance("stiffening_needed.scene", scene, Scene)
    linear, stiff = _variants(scene)
    speed, critical = _largest_speed(scene), _critical_speed(scene, linear)

    def verdict(error: float, uncertainty: float, why: str) -> Stiffening:
        return Stiffening(
            needed=not error + uncertainty <= scene.tolerance,
            error=error,
            uncertainty=uncertainty,
            tolerance=scene.tolerance,
            speed=speed,
            critical_speed=critical,
            why=why,
        )

    if speed >= critical:
        return verdict(
            np.inf,
            0.0,
            f"a link turns at {speed:.3g} rad/s, and without stiffening it is unstable from {critical:.3g}",
        )
    try:
        motion = _motion(scene, linear)
        model = stiff.linearize_along(motion)
        columns = [index(stiff.outputs, name, "output") for name in scene.compare]
        x, u = motion.x, motion.u
        unstiffened = linear.measure(x, u)[:, columns]
        response, _ = model.simulate(np.zeros(stiff.nx))
        first = stiff.measure(x + response, u)[:, columns] - unstiffened
        curved = stiff.dynamics(x + response, u) - stiff.dynamics(x, u)
        curved = curved - np.einsum("kij,kj->ki", model.A, response)
        response, _ = dataclasses.replace(model, c=model.c + curved).simulate(np.zeros(stiff.nx))
        second = stiff.measure(x + response, u)[:, columns] - unstiffened
    except PliantError as failure:
        return verdict(np.inf, 0.0, f"the motion without stiffening cannot be followed: {failure}")
    error, change = float(np.abs(second).max()), float(np.abs(second - first).max())
    if not change <= error:
        return verdict(error, np.inf, "the corrections of the deflection do not settle")
    why = f"leaving it out errs by {error:.2g} m +- {change:.1g}, the scene bears {scene.tolerance:.2g} m"
    return verdict(error, change, why)


def _variants(scene: Scene) -> tuple[Plant, Plant]:
    """The scene's plant without and with stiffening."""
    plant: Any = scene.plant
    found: tuple[Plant, Plant] | None = plant.stiffening if isinstance(plant, Plant) else None
    if found is None:
        raise ValueError(
            f"scene {scene.name!r}: plant.kinematics = {getattr(plant, 'kinematics', None)!r} must be 'linear' or "
            "'stiffened': other plants have no model without stiffening"
        )
    return found


def _joints(scene: Scene) -> tuple[str, ...]:
    """The rigid plant's coordinates."""
    rigid = scene.plant.ladder()[0]
    return tuple(rigid.rates)


def _largest_speed(scene: Scene) -> float:
    """Largest turning rate [rad/s] of any link, each joint turning on the one before, in the nominal motion."""
    if scene.drive is not None:
        rigid = scene.with_plant(scene.plant.ladder()[0])
        motion = rigid.open_loop(rtol=1e-6, atol=1e-8)
        turning = [index(rigid.plant.states, rate, "state") for rate in rigid.plant.rates.values()]
        return float(np.abs(np.cumsum(motion.x[:, turning], axis=1)).max())
    start, goal = dict(scene.start), dict(scene.goal)
    way = np.array([goal.get(name, 0.0) - start.get(name, 0.0) for name in _joints(scene)])
    peak = float(minimum_jerk(0.5)[1]) / scene.move_time
    return float(np.abs(np.cumsum(way)).max() * peak)


def _critical_speed(scene: Scene, linear: Plant) -> float:
    """Lowest bending frequency [rad/s] at the goal with the joints locked."""
    at = np.zeros(linear.nx)
    for name, value in scene.goal:
        at[index(linear.states, name, "state")] = value
    found = linear.natural_frequencies(at, locked=() if linear.prescribed else _joints(scene))
    if found is None:
        raise ValueError(f"scene {scene.name!r}: {linear.label} tells no natural_frequencies to compare its spin with")
    return float(found[0]) if len(found) else np.inf


def _motion(scene: Scene, linear: Plant) -> Trajectory:
    """The unstiffened plant's motion under the scene's nominal inputs, each held for a control period."""
    t = np.linspace(0.0, scene.times[-1], NODES * scene.steps + 1)
    u = np.repeat([scene.nominal_input(s) for s in scene.times], NODES, axis=0)[: len(t)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)  # how far its range is left is what is being found out
        return linear.simulate(scene.with_plant(linear).initial[0], u, t, rtol=1e-8, atol=1e-10)
