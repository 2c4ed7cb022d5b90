"""Tubes of inputs that act whole periods late: those on their way are states, which are known and nothing disturbs.

    zeta_k = [x_k; u_{k-d}; ..; u_{k-1}],   zeta_{k+1} = A zeta_k + B u_k + [w_k; 0],   known: [x_k + e_k; u_{k-d}; ..]

Course, plans and tubes are of this plant (`controllers.linear_quadratic.delay.delayed`), so that the theorem is as
without a delay: the error of the first d periods is met by no input, and the limits leave it all that it takes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.controllers.mpc.mpc import MPC
from pliant.plants.core.argument_gates import require_count, require_instance
from pliant.plants.linear.lti import LinearModel

from .disturbance_set import DisturbanceSet

Array = np.ndarray
MOST = 100  # periods of delay


def whole_periods(delay: Any) -> int:
    """The delay [periods]. ValueError where it is no whole number of them."""
    return require_count("TubeMPC", "delay", delay, 0, MOST)


def periods_of(model: LinearModel, delay: Any) -> int:
    """The same of a model that is to be sampled. ValueError where it is already."""
    periods = whole_periods(delay)
    if periods and require_instance("TubeMPC.model", model, LinearModel).dt is not None:
        raise ValueError(f"TubeMPC.delay = {delay!r} must be 0 with a sampled model: give the continuous one and dt")
    return periods


def widened(disturbances: DisturbanceSet, width: int) -> DisturbanceSet:
    """The same of zeta (width,): inputs on their way are neither disturbed nor read with an error."""
    more = width - len(disturbances.noise)
    if not more:
        return disturbances
    points = np.pad(disturbances.points, ((0, 0), (0, 0), (0, more)))
    return DisturbanceSet(points, np.pad(disturbances.noise, (0, more)))


def on_their_way(law: Any) -> Array:
    """The inputs (d nu,) that the law asked for and that do not act yet, the oldest first; none of a law without."""
    known = getattr(law, "_knowledge", None)
    return np.zeros(0) if known is None else known.waiting


def put_on_their_way(law: Any, waiting: Array) -> None:
    """These (d nu,) are on their way, whatever the law asked for; of a law without a delay there are none."""
    if len(waiting):
        law._knowledge.waiting = waiting


def asked_instead(law: MPC, u: Array) -> None:
    """Not what the law gave last was asked for, but u (nu,)."""
    if len(waiting := on_their_way(law)):
        waiting[-len(u) :] = u
        put_on_their_way(law, waiting)
