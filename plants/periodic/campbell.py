"""Campbell diagram: natural frequencies of a machine over its speed, and the speeds at which it excites them.

A machine that turns at W excites at multiples k W ("per rev", "orders"); mode i resonates where omega_i(W) = k W. Modes
are followed by their shapes (`mode_tracking`), so that curves that cross stay themselves and those that veer do too.

Source   Campbell 1924; frequencies of a spinning beam: Wright, Smith, Thresher and Wang 1982
Valid    machines whose linear model at constant speed is constant in the coordinates of its states: a spinning craft
         in its body frame, an arm about its hub; one that is periodic has multipliers instead (`stability.floquet`)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_counts, require_finite, require_number, require_text
from pliant.plants.core.errors import EquilibriumError
from pliant.plants.core.signals import OwnsArrays, index
from pliant.plants.linear.lti import LinearModel
from pliant.plants.transitions.state_matrix_path import kept, scaling

from .mode_tracking import followed, modes, track

Array = np.ndarray
HALVINGS = 8  # of a step of speed across which shapes change much
BISECTIONS = 60
STAYS = 1e-6  # largest rate of a state that is kept, in its unit per second


@dataclass(frozen=True)
class Crossing:
    """Where a multiple of the speed meets a mode's frequency."""

    order: int
    mode: int  # as the columns of Campbell.frequencies
    speed: float  # [rad/s]
    frequency: float  # [rad/s]


@dataclass(frozen=True, eq=False)
class Campbell(OwnsArrays):
    """Rows belong to speeds, columns to modes, slowest first at the lowest speed; NaN from where one is none."""

    speeds: Array  # (ns,) [rad/s] those asked for and those between that tracking took
    frequencies: Array = field(repr=False)  # (ns, nm) [rad/s]
    rates: Array = field(repr=False)  # (ns, nm) [1/s] growth; below zero: decay
    crossings: tuple[Crossing, ...]  # by speed
    mac: float  # the least that two shapes of one mode at neighbouring speeds share; 1: the same

    @property
    def unstable(self) -> tuple[tuple[int, float], ...]:
        """(mode, speed [rad/s]) at which a mode begins to grow, of the speeds at hand."""
        grows = self.rates > 1e-9 * np.nanmax(np.abs(self.frequencies), initial=1e-300)
        first = [(j, int(np.argmax(grows[:, j]))) for j in range(grows.shape[1]) if grows[:, j].any()]
        return tuple((j, float(self.speeds[k])) for j, k in first)


def campbell(
    plant: Any,
    speeds: Any,
    *,
    rate: str | None = None,
    x0: Any = None,
    states: Sequence[str] | None = None,
    orders: Sequence[int] = (1, 2, 3, 4),
    least: float = 0.8,
) -> Campbell:
    """Over speeds (ns,) [rad/s], ascending, of a plant whose state `rate` is the speed, or of a function that makes a
    LinearModel from a speed.

    Modes of equal frequency have no shapes of their own: begin where they differ. `x0` (nx,): the state at rest on
    which `rate` is set, None: zeros. `states` keeps only those of the linear model: an arm's hub that is driven is left
    out. `orders`: multiples of the speed. `least`: MAC below which a step is halved.
    EquilibriumError where a state that is kept does not stay.
    Example: `campbell(arm, np.linspace(0, 40, 21), rate="hub_angle_rate", states=("eta1", "eta1_rate")).crossings`
    """
    speeds = require_finite("campbell.speeds", speeds, (-1,))
    if len(speeds) < 2 or speeds[0] < 0 or (np.diff(speeds) <= 0).any():
        raise ValueError(f"campbell.speeds = {speeds} must be two or more, >= 0 and ascending [rad/s]")
    orders = require_counts("campbell", "orders", orders, 1, 1000)
    least = require_number("campbell.least", least, least=0.0, most=1.0)
    model = _models(plant, rate, x0)
    middle = model(float(speeds[len(speeds) // 2]))
    keep = kept(middle, states)
    scale = scaling(middle.A[np.ix_(keep, keep)][None])

    def at(speed: float) -> Array:
        found = model(speed)
        moves = np.abs(found.f0[keep])
        if moves.max(initial=0.0) > STAYS:
            worst = found.states[keep[int(moves.argmax())]]
            raise EquilibriumError(
                f"campbell: at {speed:.6g} rad/s {worst.name} changes by {moves.max():.3g} {worst.unit}/s, must stay",
                float(moves.max()),
            )
        return np.asarray(found.A[np.ix_(keep, keep)] * scale / scale[:, None])

    places, found, worst = track(at, speeds, least, HALVINGS)
    values = np.array([m.values for m in found]).reshape(len(places), -1)
    crossings = [
        _crossing(at, order, j, places, found, int(k))
        for order in orders
        for j in range(values.shape[1])
        for k in np.flatnonzero(_changes(values[:, j].imag - order * np.array(places)))
    ]
    ordered = tuple(sorted(crossings, key=lambda c: (c.speed, c.mode)))
    return Campbell(np.array(places), values.imag, values.real, ordered, worst)


def _models(plant: Any, rate: str | None, x0: Any) -> Callable[[float], LinearModel]:
    if not hasattr(plant, "feedback_model"):
        if not callable(plant):
            raise ValueError(f"campbell.plant = {plant!r} must be a Plant, or a function from speed to LinearModel")
        if rate is not None or x0 is not None:
            raise ValueError("campbell.rate, x0 belong to a Plant, must be None for a function")

        def called(speed: float) -> LinearModel:
            found = plant(speed)
            if not isinstance(found, LinearModel) or found.dt is not None:
                kind = type(found).__name__
                raise ValueError(f"campbell.plant({speed:g}) gave a {kind}, must be a LinearModel of dt None")
            return found

        return called
    if rate is None:
        raise ValueError("campbell.rate = None must name the state that is the speed")
    place = index(plant.states, require_text("campbell.rate", rate), "state")
    start = np.zeros(plant.nx) if x0 is None else require_finite("campbell.x0", x0, (plant.nx,))

    def spun(speed: float) -> LinearModel:
        x = np.array(start)
        x[place] = speed
        made: LinearModel = plant.feedback_model(x)
        return made

    return spun


def _changes(value: Array) -> Array:
    with np.errstate(invalid="ignore"):
        return np.asarray((value[:-1] > 0) != (value[1:] > 0)) & np.isfinite(value[:-1]) & np.isfinite(value[1:])


def _crossing(
    at: Callable[[float], Array], order: int, j: int, places: Sequence[float], found: Sequence[Any], k: int
) -> Crossing:
    """By bisection on the mode that continues shape j between places k and k + 1."""
    low, high, shapes = places[k], places[k + 1], found[k]
    above = shapes.values[j].imag > order * low
    speed, frequency = high, float(found[k + 1].values[j].imag)
    for _ in range(BISECTIONS):
        speed = (low + high) / 2
        new = modes(at(speed))
        place, _ = followed(shapes, new)
        if place[j] < 0:
            high = speed
            continue
        frequency = float(new.values[place[j]].imag)
        if (frequency > order * speed) == above:
            low = speed
        else:
            high = speed
        if high - low <= 1e-13 * max(high, 1e-300):
            break
    return Crossing(int(order), int(j), float(speed), frequency)
