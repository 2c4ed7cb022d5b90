"""Nonlinear predictive control of a machine that runs in a cycle: NMPC whose horizon ends in the periodic cost to go.

V = (d - xi)'P (d - xi), d = Pi (x_N - x*(phi_N)): the deviation of the plan's end across the cycle at the angle that it
has reached, from the one of least cost; P, xi of the periodic regulator (PeriodicLQR) at that angle. That the end may
stand where the cycle is about to be dear or cheap is first order in its angle and not counted.

Guarantee   none, as of NMPC. Near the cycle and within the limits its input is that of PeriodicLQR to first order, but
            for that term.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.nmpc.nmpc import NMPC
from pliant.plants.core.signals import OwnsArrays

from .by_angle import ByAngle
from .cycle import Cycle
from .periodic_lqr import PeriodicLQR

Array = np.ndarray


@final
class CycleEnd(OwnsArrays):
    """The `MovingEnd` of a cycle."""

    def __init__(self, cycle: Cycle, law: PeriodicLQR) -> None:
        made, rest, nx = law.regulator, cycle.rest, cycle.scene.plant.nx
        self.law, self.rows, self.angle, self._nodes = law, nx - 1, cycle.angle, ByAngle(cycle.x[:-1, cycle.angle])
        self._turn, self._path, self._u = cycle.x[-1] - cycle.x[0], cycle.x[:-1], cycle.u
        flow = np.roll(cycle.flow, 1, axis=0)
        value, vectors = np.linalg.eigh(made.P)
        roots = np.sqrt(np.maximum(value, 0.0))
        half = np.einsum("kij,kj,klj->kil", vectors, roots, vectors)
        L = np.zeros((cycle.steps, nx - 1, nx))
        L[:, :, rest] = half
        L[:, :, self.angle] = -np.einsum("kij,kj->ki", half, flow[:, rest] / flow[:, self.angle, None])
        best = self._path.copy()
        best[:, rest] -= np.einsum("kij,kj->ki", np.linalg.pinv(made.P, hermitian=True), made.p)
        order = self._nodes.order
        best[:, self.angle] = 0.0  # the plan's own
        self._best, self._L = (self._nodes.around(v[order]) for v in (best, L))

    def at(self, x: Array) -> tuple[Array, Array]:
        """Reference (nx,) and L (nx - 1, nx) at x (nx,)."""
        k, share = self._nodes.at(x[self.angle])
        reference = (1 - share) * self._best[k] + share * self._best[k + 1]
        reference[self.angle] = x[self.angle]
        return reference, (1 - share) * self._L[k] + share * self._L[k + 1]

    def tail(self, x: Array) -> Array:
        """The periodic regulator's input (nu,)."""
        return self.law.unlimited(x)[0]

    def guess(self, x: Array, periods: int) -> tuple[Array, Array]:
        """The cycle from the node next to the angle of x (nx,) on."""
        first = self._nodes.nearest(x[self.angle])
        count = first + np.arange(periods + 1)
        path = self._path[count % len(self._path)] + (count // len(self._path))[:, None] * self._turn
        path[:, self.angle] += x[self.angle] - path[0, self.angle]
        return path, np.tile(self._u, (periods, 1))


def periodic_nmpc(scene: CostedScene, horizon: int = 30, **options: Any) -> NMPC:
    """NMPC.for_scene for a goal that is a cycle; options as of NMPC, but `terminal`. horizon: control periods.

    EquilibriumError where the goal is no cycle.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> periodic_nmpc(scenes.get("slider-crank-run"), horizon=10).reads[0]
    'crank_angle'
    """
    require_scene("periodic_nmpc", scene)
    if "terminal" in options:
        raise ValueError(f"periodic_nmpc.terminal = {options['terminal']!r} must be left out: it is the cycle's")
    cycle = Cycle.find(scene)
    end = CycleEnd(cycle, PeriodicLQR.about(cycle, 1.0, (0.0, 0.0)))
    return NMPC.for_scene(scene, horizon, **{"terminal": end, **options})
