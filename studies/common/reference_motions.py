"""A scene's open-loop motion played by any fidelity, as accurately as wanted, each only once.

The scene's nominal inputs are held over each control period, as a controller would hold them. Every
integrator then solves the same problem, time goes into the plant and not into the input, and a fixed step of
any method keeps its order because the jumps fall between steps. A step is at most the control period.
"""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from pliant.controllers import Controller
from pliant.envs.scenes.scene import Manoeuvre, Scene
from pliant.plants import Plant, PliantError, Trajectory, ValidityWarning
from pliant.plants.core.argument_gates import require_finite, shown
from pliant.plants.motions.adaptive_steps import at_most
from pliant.plants.motions.time_limit import TooLong
from pliant.plants.validity.ranges import in_words

from .processor_time import processor_time

STIFF = "rodas5p"  # the adaptive method of plants that are stiff; of others it is dop853
MOST_STEPS = 300_000  # of a motion: one that takes more runs away
LAW = 1e-8  # rtol of the motion whose inputs begin a closed loop's
TIGHT = 1e-10  # rtol of a converged motion; atol is a hundredth
Progress = Callable[[float, str], None]  # fraction done, what is being done


def silent(fraction: float, task: str) -> None:
    """No progress shown."""


def share(progress: Progress | None, start: float, stop: float) -> Progress:
    """Progress of a part that takes the fractions from start to stop of the whole."""
    if progress is None:
        return silent
    return lambda fraction, task: progress(start + (stop - start) * min(max(fraction, 0.0), 1.0), task)


def in_time(plant: Plant, until: float) -> Callable[[float], None]:
    """A simulation's progress that raises TooLong once `processor_time` says `until` [s]."""

    def reached(t: float) -> None:
        if processor_time() > until:
            raise TooLong(f"the motion of {plant.label} had come to {t:.3g} s when its time was over")

    return reached


class Motions:
    """Motions of one scene, kept."""

    def __init__(self, scene: Scene, inputs: np.ndarray | None = None) -> None:
        """`inputs` (nt, nu): held from each control time to the next; None: the scene's nominal inputs."""
        self.scene = scene
        if inputs is not None:
            self.held = require_finite("Motions.inputs", inputs, (len(scene.times), scene.plant.nu))
        self._kept: dict[Plant, np.ndarray | PliantError] = {}
        self._starts: dict[Plant, np.ndarray] = {}
        self._left: dict[Plant, tuple[dict[str, Any], ...]] = {}  # entries of stats["validity"]
        self.truth: dict[float, Any] = {}  # what physics gives, by the tolerance for which it was found

    @classmethod
    def with_inputs_of(cls, scene: Scene, motion: Trajectory, name: str) -> Motions:
        """The inputs of a motion held over the control periods of the scene: each as it is amid the period, where no
        rounding of times makes it another's. ValueError, which calls it `name`, where it has others or ends before.
        """
        if tuple(s.name for s in motion.inputs) != tuple(s.name for s in scene.plant.inputs):
            raise ValueError(f"{name} has inputs {shown(motion.inputs)}, must have the plant's")
        amid, first, last = scene.times[:-1] + scene.dt / 2, float(motion.t[0]), float(motion.t[-1])
        if not (first <= amid[0] and amid[-1] <= last):
            raise ValueError(
                f"{name} lasts from {first:.6g} to {last:.6g} s, must last as long as the scene does, "
                f"{scene.times[-1]:.6g} s"
            )
        u = motion.resample(amid).u
        return cls(scene, np.vstack([u, u[-1:]]))

    @cached_property
    def ladder(self) -> tuple[Plant, ...]:
        """The plant's variants, cheapest first."""
        return tuple(self.scene.plant.ladder())

    @property
    def simple(self) -> Plant:
        """The variant from whose motion that of physics is found."""
        return self.ladder[0]

    @cached_property
    def held(self) -> np.ndarray:
        """Input (nt, nu) held from each control time to the next."""
        return np.array([self.scene.nominal_input(t) for t in self.scene.times])

    def start(self, plant: Plant) -> np.ndarray:
        """Where a fidelity starts, (nx,)."""
        if plant not in self._starts:
            known = {f.name: getattr(self.scene, f.name) for f in dataclasses.fields(Manoeuvre)}  # to hold, as checked
            self._starts[plant] = Manoeuvre(**known | {"plant": plant}).initial[0]
        return self._starts[plant]

    def run(self, plant: Plant, **options: Any) -> Trajectory:
        """The motion from the start, options as in Plant.simulate."""
        return self.at_nodes(plant, self.held, self.scene.times, **options)

    def at_nodes(self, plant: Plant, held: np.ndarray, times: np.ndarray, **options: Any) -> Trajectory:
        """The motion from the start at other times (m,), the input held (m, nu) from each to the next."""
        if plant.stiff:
            options.setdefault("method", STIFF)
        with warnings.catch_warnings(), at_most(MOST_STEPS):
            warnings.simplefilter("ignore", ValidityWarning)  # `outside` tells it, once for each fidelity
            return plant.simulate(self.start(plant), held, times, **options)

    def outputs(self, plant: Plant, rtol: float, **options: Any) -> np.ndarray:
        """The compared outputs (nt, n) at a tolerance."""
        motion = self.run(plant, rtol=rtol, atol=rtol / 100, **options)
        self._left[plant] = tuple(motion.stats.get("validity", ()))
        return self.compared(motion)

    def compared(self, motion: Trajectory) -> np.ndarray:
        """The outputs (nt, n) that the scene compares."""
        return np.stack([motion[name] for name in self.scene.compare], axis=1)

    def converged(self, plant: Plant, *, until: float = math.inf) -> np.ndarray:
        """The compared outputs (nt, n) at tight tolerance; raises what the simulation raised, and TooLong where it
        has not ended when `processor_time` says `until` [s].
        """
        if plant not in self._kept:
            progress = in_time(plant, until) if until < math.inf else None
            try:
                if progress is not None:
                    progress(float(self.scene.times[0]))
                motion = self.run(plant, rtol=TIGHT, atol=TIGHT / 100, progress=progress)
                self._kept[plant] = self.compared(motion)
                self._left[plant] = tuple(motion.stats.get("validity", ()))
            except TooLong:
                raise
            except PliantError as failure:
                self._kept[plant] = failure
        found = self._kept[plant]
        if isinstance(found, PliantError):
            raise found
        return found

    def outside(self, plant: Plant) -> str:
        """Which ranges of its own `validity` a fidelity's motion leaves, in words; "" where it leaves none or fails."""
        try:
            self.converged(plant)
        except PliantError:
            return ""
        return self.outside_so_far(plant)

    def outside_so_far(self, plant: Plant) -> str:
        """The same as far as its motion is known already."""
        return "; ".join(in_words(entry) for entry in self.left_so_far(plant))

    def left_so_far(self, plant: Plant) -> tuple[dict[str, Any], ...]:
        """The ranges that it leaves as far as known, each as in Trajectory.stats["validity"]."""
        return self._left.get(plant, ())

    def difference(self, plant: Plant, other: Plant | np.ndarray) -> float:
        """Largest difference of any compared output from another fidelity's or from outputs (nt, n); or infinite."""
        try:
            against = self.converged(other) if isinstance(other, Plant) else other
            return float(np.abs(self.converged(plant) - against).max())
        except PliantError:
            return float("inf")


class Sampled:
    """A law that acts at the control times of a scene, whatever times a motion is asked at."""

    def __init__(self, law: Controller, dt: float) -> None:
        self.law, self.dt, self.reads = law, dt, tuple(law.reads)

    def reset(self) -> None:
        self.law.reset()

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        return np.asarray(self.law.act(t, y), dtype=float)


class ClosedMotions(Motions):
    """Motions of one scene with a law in the loop: each fidelity under the inputs that the law gives from its own."""

    def __init__(self, scene: Scene, law: Controller, name: str) -> None:
        """ValueError, which calls the law `name`, where it samples at other times than the scene's, or reads what is
        not the same in all variants.
        """
        super().__init__(scene)
        if law.dt is not None and abs(law.dt - scene.dt) > 1e-9 * scene.dt:
            raise ValueError(f"{name}.dt = {law.dt:.6g} s must be the control period of the scene, {scene.dt:.6g} s")
        self.law = Sampled(law, scene.dt)
        shared = {s.name for s in (*scene.plant.outputs, *self.ladder[0].states)}
        if shapes := [signal for signal in law.reads if signal not in shared]:
            raise ValueError(
                f"{name} reads {', '.join(shapes)}: coordinates of shapes are other ones in other variants; give a law "
                "that reads outputs or joints, as an LQG does"
            )

    @property
    def simple(self) -> Plant:
        """The scene's own plant: the law may not hold the cheapest."""
        return self.scene.plant

    @cached_property
    def held(self) -> np.ndarray:
        """What the law gives on the scene's own plant, (nt, nu)."""
        return self.run(self.scene.plant, rtol=LAW, atol=LAW / 100).u

    def run(self, plant: Plant, **options: Any) -> Trajectory:
        """The closed loop's motion from the start, options as in Plant.simulate."""
        return self.at_nodes(plant, np.empty((0, plant.nu)), self.scene.times, **options)

    def at_nodes(self, plant: Plant, held: np.ndarray, times: np.ndarray, **options: Any) -> Trajectory:
        """The motion from the start at times (m,), under the law's inputs whatever is `held`."""
        if plant.stiff:
            options.setdefault("method", STIFF)
        with warnings.catch_warnings(), at_most(MOST_STEPS):
            warnings.simplefilter("ignore", ValidityWarning)
            return plant.simulate(self.start(plant), self.law, times, **options)
