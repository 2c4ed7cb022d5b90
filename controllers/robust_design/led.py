"""A law about a point that is led there: it holds a reference that goes from the start to the goal, not the goal.

    u = u_r(t + d) + law(y - y_r(t)),   y_r = y_0 + s (y_n - y_0),   u_r = u_0 + s (u_n - u_0)

n is a nominal motion from rest to rest, 0 the goal, s how far from it the first reading is, as a share of the
nominal's start; d the middle of the law's delays. A feedback that starts with the whole way as its error kicks what
bends; led, it sees small errors, and a bound on bending is a matter of the nominal: it is made longer until it leaves
`reserve` of each bound, which other stiffness and payload may then use.

Guarantee   the law's, of deviations from the reference, where the plant is linear; bounds are kept by the nominal on
            the plant as it is, and by nothing but the reserve elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from pliant.controllers.base.controller import moment, reading, share
from pliant.controllers.base.scene_protocol import CostedScene, require_scene
from pliant.controllers.optimal_control.nominal_motions import nodes, rests
from pliant.controllers.optimal_control.plan import plan
from pliant.plants.core.argument_gates import require_instance
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays, names

from .many_model_lqr import MultiModelLQR

Array = np.ndarray
RESERVE = 0.3  # of bounds
LONGER = 1.05  # from one nominal to the next
MOST = 3.0  # times the scene's move time


@final
@dataclass(eq=False)
class Led(OwnsArrays):
    """Made by `for_scene`. It reads what its law reads."""

    law: MultiModelLQR
    y: Array  # (T + 1, ny) nominal readings less the goal's
    u: Array  # (T, nu) nominal inputs less the goal's
    dt: float  # [s]

    def __post_init__(self) -> None:
        require_instance("Led.law", self.law, MultiModelLQR)
        self.reset()

    @classmethod
    def for_scene(cls, scene: CostedScene, law: MultiModelLQR | None = None, *, reserve: float = RESERVE) -> Led:
        """Along a plan from rest to rest, in the scene's move time [s] or as much longer as the bounds' reserve asks.

        law: MultiModelLQR.for_scene(scene) where None. reserve: share of every bound that the nominal leaves, from 0 to
        below 1, dimensionless. PliantError for a scene that does not go from rest to rest, or where three times its
        move time are too short.
        """
        require_scene("Led.for_scene", scene)
        reserve = share("Led.for_scene.reserve", reserve)
        law = MultiModelLQR.for_scene(scene) if law is None else law
        if not rests(scene):
            raise PliantError("Led.for_scene: the scene must start and end at rest")
        factor, plant = 1.0, scene.plant
        known = names(plant.states + plant.outputs)
        bounds = {name: (1 - reserve) * value for name, value in scene.bounds}
        # a plan that rides on a tighter bound all the way stirs up modes of other machines: it is made longer instead
        while factor <= MOST:
            time = scene.dt * round(factor * scene.move_time / scene.dt)
            _, x, u = nodes(plan(scene, time=time), scene.dt)
            both = np.hstack([x, plant.measure(x, np.vstack([u, u[-1:]]))])
            if all(np.abs(both[:, known.index(name)]).max() <= value for name, value in bounds.items()):
                seen = both[:, [known.index(name) for name in law.reads]]
                return cls(law, seen - law.y0, u - law.u0, scene.dt)
            factor *= LONGER
        raise PliantError(
            f"Led.for_scene: no plan within {MOST:g} move times leaves {reserve:g} of the bounds {bounds}"
        )

    @property
    def reads(self) -> tuple[str, ...]:
        """The law's."""
        return self.law.reads

    def reset(self) -> None:
        """Forget the start."""
        self.law.reset()
        self._share: float | None = None
        self._ahead = float(np.mean(self.law.delays))
        size = np.abs(self.y).max(axis=0)
        self._sizes = np.where(size > 0, size, 1.0)  # how far each reading goes

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from y (len(reads),) at time t [s]."""
        y, k = reading("Led.y", y, len(self.reads)), max(round(moment("Led", t) / self.dt), 0)
        if self._share is None:
            way = self.y[0] / self._sizes
            self._share = float(way @ ((y - self.law.y0) / self._sizes) / (way @ way)) if way.any() else 0.0
        led = self._share * self.y[min(k, len(self.y) - 1)]
        u = self.law.act(t, y - led) + self._share * self._given(k + self._ahead)
        return np.minimum(np.maximum(u, self.law.limits[0]), self.law.limits[1])

    def _given(self, k: float) -> Array:
        """The nominal input (nu,) at k periods, between two that are held."""
        first = int(k)
        pair = [self.u[i] if i < len(self.u) else np.zeros(self.u.shape[1]) for i in (first, first + 1)]
        return np.asarray((1 - (k - first)) * pair[0] + (k - first) * pair[1])
