"""TVLQR towards a cycle: the regulator along a nominal motion, then the periodic regulator about the cycle for ever.

Cost at the nominal's end   d'P d, d the deviation across the cycle, P that of the periodic regulator at the nominal's
                            angle there: a deviation along the cycle costs nothing

Guarantee   after the nominal's end that of PeriodicLQR; along it none, as of TVLQR.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from pliant.controllers.base.controller import moment, share
from pliant.controllers.base.objective import Objective
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.linear_quadratic.period_cost import period_cost
from pliant.controllers.linear_quadratic.tvlqr import TVLQR
from pliant.controllers.optimal_control.nominal_motions import chosen_nominal, nodes, nominal_for
from pliant.controllers.optimal_control.optimal import Motion
from pliant.controllers.optimal_control.stage_derivatives import StageTerms
from pliant.plants.core.argument_gates import require_number
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.core.trajectory import Trajectory

from .cycle import Cycle
from .periodic_lqr import PeriodicLQR
from .periodic_nmpc import CycleEnd

Array = np.ndarray


@final
@dataclass(eq=False)
class PeriodicTVLQR(OwnsArrays):
    """Made by `for_scene`. It reads the plant's states.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> PeriodicTVLQR.for_scene(scenes.get("slider-crank-run"), nominal="rigid").ends
    1.0
    """

    led: TVLQR  # until `ends`
    law: PeriodicLQR  # from then on
    ends: float  # [s]

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        *,
        nominal: Motion | Trajectory | str | None = None,
        reserve: float = 0.1,
        effort: float = 1.0,
        index: str = "time",
    ) -> PeriodicTVLQR:
        """nominal, reserve, effort, index: as of TVLQR.for_scene; None: "optimal", the least cost over the scene's
        duration. reserve, effort: dimensionless. EquilibriumError where the goal is no cycle.
        """
        require_scene("PeriodicTVLQR.for_scene", scene)
        reserve = share("PeriodicTVLQR.for_scene.reserve", reserve)
        effort = require_number("PeriodicTVLQR.for_scene.effort", effort, "positive")
        cycle = Cycle.find(scene)
        law = PeriodicLQR.about(cycle, effort, (0.0, 0.0))
        kind = "optimal" if nominal is None else chosen_nominal("PeriodicTVLQR.for_scene", scene, nominal)
        along = nominal_for(scene, kind, reserve) if isinstance(kind, str) else kind
        plant, about = scene.plant, Objective.of(scene)
        t, x, u = nodes(along, scene.dt)
        terms = StageTerms(about, about.residual_expression)
        J = terms.values(t[:-1], x[:-1], u, np.zeros(plant.nw), plant.nominal_parameters)[1]
        Q, R, N = period_cost(J, plant.nx, scene.dt, effort)
        _, L = CycleEnd(cycle, law).at(x[-1])
        given: dict[str, Any] = {"dt": scene.dt, "substeps": scene.substeps, "limits": about.limits, "index": index}
        return cls(TVLQR.along(plant, along, Q, R, N, **given, end=L.T @ L), law, float(t[-1]))

    @property
    def dt(self) -> float:
        """[s]"""
        return self.law.dt

    @property
    def reads(self) -> tuple[str, ...]:
        """The plant's states."""
        return self.law.reads

    def reset(self) -> None:
        """Back to the start of the nominal."""
        self.led.reset()
        self.law.reset()

    def act(self, t: float, y: Array) -> Array:
        """u (nu,) from the states y (nx,) at time t [s]."""
        return (self.law if moment("PeriodicTVLQR", t) > self.ends - 1e-6 * self.dt else self.led).act(t, y)
