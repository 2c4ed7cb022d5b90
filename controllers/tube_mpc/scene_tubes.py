"""Tubes of a scene: its set of disturbances from the motions of corners under the law that this set makes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pliant.controllers.base.scene_protocol import CostedScene
from pliant.controllers.mpc.ltv_design import about_goal
from pliant.controllers.mpc.mpc import MPC
from pliant.controllers.robust_design.box_models import known_of
from pliant.controllers.robust_design.many_model_lqr import box_of
from pliant.plants.core.argument_gates import require_by_name, require_instance
from pliant.plants.core.errors import PliantError
from pliant.plants.core.trajectory import Trajectory

from .corner_runs import corners_of, points_of, unforetold
from .disturbance_set import DisturbanceSet
from .error_bounds import Tightening, tightening
from .late_tubes import widened
from .tube_designs import Chosen, Tubes, about_point, along_nominal, chosen

Array = np.ndarray
ROUNDS = 3
NOISE = 3.0  # largest error of a reading, in standard deviations of what laws for boxes take it to have
READ = 1e-3  # of what a state does along a nominal


def tubes_of(
    scene: CostedScene,
    horizon: int,
    nominal: Trajectory | None,
    ranges: Mapping[str, tuple[float, float]] | None,
    noise: Mapping[str, float] | None,
    terminal: int,
    rounds: int,
    delay: int,
) -> tuple[Tubes, DisturbanceSet, float]:
    """What `TubeMPC.for_scene` says; the last: what the corners ask for beyond the set under its law, of a range."""
    box = box_of(scene, ranges, "TubeMPC.ranges")
    Q, R, high = dict(scene.weights), dict(scene.effort), np.array(scene.limits, dtype=float)
    bounds = {name: (-value, value) for name, value in scene.bounds}
    limited: list[Any] = [(-high, high), None, bounds, terminal, None]
    if nominal is None:
        model, drift, limited[2], start = about_goal(scene, bounds)
        if drift is not None:
            raise PliantError("TubeMPC.for_scene: the goal moves, give a nominal that goes with it")
        late = delay, np.clip(scene.initial[1], -high, high)
        tubes = about_point(model, Q, R, horizon, scene.dt, tuple(limited), start, late)
        known = known_of(scene, None, 0)
        usual = dict(zip(known.reads, NOISE * known.deviation))
    elif delay:
        raise ValueError(f"TubeMPC.delay = {delay} must be 0 along a nominal")
    else:
        ltv = scene.plant.linearize_along(require_instance("TubeMPC.for_scene: nominal", nominal, Trajectory))
        tubes = along_nominal(ltv, Q, R, horizon, tuple(limited))
        usual = dict(zip(ltv.state_names, NOISE * READ * np.ptp(ltv.x, axis=0)))
    reads = tubes.made["reads"]
    given = usual if noise is None else require_by_name("TubeMPC.noise", noise, reads, "reading", "nonnegative")
    off = np.array([float(given.get(name, 0.0)) for name in reads])
    corners, nx = corners_of(scene, box), len(reads)
    disturbances, law = DisturbanceSet(np.zeros((1, 1, nx)), np.zeros(nx)), MPC(**tubes.made)
    course, times = next(iter(tubes.courses.values())), max(scene.steps, len(tubes.origin[0]))
    met: list[Array] = []
    for _ in range(rounds):
        met.append(points_of(unforetold(scene, corners, law, course, tubes.origin, tubes.c)))
        own = met[1:] or met  # the first is of the law without tubes
        disturbances = DisturbanceSet(np.concatenate(own, axis=1), off)
        found = chosen("TubeMPC.for_scene", tubes, disturbances, times, empty=True)
        law = MPC(**found.made)
    last = DisturbanceSet(unforetold(scene, corners, law, course, tubes.origin, tubes.c), off)
    last = widened(last, tubes.origin[0].shape[1])
    asked = tightening(found.course, tubes.rows(found.price, times), last, times)
    return tubes, disturbances, _beyond(asked, found, law)


def _beyond(asked: Tightening, found: Chosen, law: MPC) -> float:
    """The most by which `asked` exceeds what is taken, of a limit's range; 0 where it does nowhere."""
    limits = law.limits
    inputs, signals = limits.high - limits.low, limits.ceiling - limits.floor
    more = [(new - old) / ranges for new, old, ranges in zip(asked, found.taken, (inputs, inputs, signals, signals))]
    return max([0.0, *(float(part.max()) for part in more if part.size)])
