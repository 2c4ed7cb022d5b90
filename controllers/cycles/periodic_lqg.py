"""LQG of a machine that runs in a cycle: its periodic regulator on the estimate of its periodic Kalman filter.

Law    u = law(estimate): PeriodicLQR and PeriodicKalman, both designed along the cycle and told by the estimated angle

Without limits the multipliers of the linear loop are those of the regulator and those of the estimate's error.

Guarantee   these are inside the unit circle. None on margins, other parameters, other delays and limits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from pliant.controllers.base.controller import reading
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.estimation.sensors import Sensor
from pliant.controllers.riccati.late_inputs import delay_range
from pliant.controllers.robust_design.many_model_lqr import box_of
from pliant.plants.core.argument_gates import require_instance, require_number
from pliant.plants.core.signals import OwnsArrays

from .cycle import Cycle
from .periodic_kalman import PeriodicKalman
from .periodic_lqr import PeriodicLQR

Array = np.ndarray


@final
@dataclass(eq=False)
class PeriodicLQG(OwnsArrays):
    """u = law(estimate). It reads what the filter's sensors read.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> law = PeriodicLQG.for_scene(scenes.get("slider-crank-run"))
    >>> law.reads
    ('crank_angle', 'mid_acceleration')
    """

    law: PeriodicLQR
    filter: PeriodicKalman

    def __post_init__(self) -> None:
        law = require_instance("PeriodicLQG.law", self.law, PeriodicLQR)
        dt = require_instance("PeriodicLQG.filter", self.filter, PeriodicKalman).dt
        if abs(law.dt - dt) > 1e-9 * dt:
            raise ValueError(f"PeriodicLQG.law.dt = {law.dt!r} must be the filter's, {dt:g} s")
        self.reset()

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        *,
        sensors: Sequence[Sensor] | None = None,
        W: Mapping[str, float] | None = None,
        effort: float = 1.0,
        input_delay: float | tuple[float, float] = 0.0,
        ranges: Mapping[str, tuple[float, float]] | None = None,
    ) -> PeriodicLQG:
        """PeriodicLQR.for_scene and PeriodicKalman.for_scene. effort: a factor on what the inputs cost [-]. W:
        densities [unit^2 s] by name. input_delay: periods, or (shortest, longest), of which the law is the one for all
        and the filter is told the middle. ranges: of the law, as in PeriodicLQR.for_scene; the filter is the scene's
        own plant's.
        """
        require_scene("PeriodicLQG.for_scene", scene)
        low, high = delay_range("PeriodicLQG", input_delay, "input_delay")
        effort = require_number("PeriodicLQG.for_scene.effort", effort, "positive")
        cycle = Cycle.find(scene)
        law = PeriodicLQR.about(cycle, effort, (low, high), box_of(scene, ranges or {}, "PeriodicLQG.ranges"))
        return cls(law, PeriodicKalman.about(cycle, sensors, W, (low + high) / 2))

    @property
    def dt(self) -> float:
        """[s]"""
        return self.filter.dt

    @property
    def reads(self) -> tuple[str, ...]:
        """The sensors' outputs."""
        return self.filter.reads

    @property
    def multipliers(self) -> Array:
        """Sizes of the linear loop's over one turn, largest first: the law's and the filter's. Dimensionless."""
        return np.sort(np.concatenate([self.law.multipliers, self.filter.multipliers]))[::-1]

    def reset(self) -> None:
        """Forget the estimate and the input."""
        self.law.reset()
        self.filter.reset()
        self.u: Array | None = None  # (nu,) asked for last

    def act(self, t: float, y: Array) -> Array:
        """u (nu,) from the sensors' y (ns,) at time t [s]."""
        x = self.filter.step(reading("PeriodicLQG.y", y, len(self.filter.sensors)), self.u)
        u = self.law.act(t, x)
        self.u = u.copy()  # the caller may change what it gets
        return u
