"""Rest of a clamped beam under its loads, followed from the unloaded beam as the loads grow.

Newton's method alone may end on any equilibrium. Here a share lambda of the way takes the loads from those that hold
the start to those given,

    elastic forces(q) + lambda (weight and loads on q) = 0,

from the unloaded beam, or from a guess: from the loads that hold it to those given; of a guess that none hold, what it
lacks fades with 1 - lambda. A step is predicted along the tangent, corrected by Newton's method, and taken only where
the correction is small beside the prediction and the rest half way lies between the ends, as beyond a limit point it
would not; else it is halved. What is found lies on the branch of the start; where that turns back (a limit point, the
beam snaps through) the steps become too small, and EquilibriumError says at which share of the way.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np

from pliant.plants.core.errors import EquilibriumError, UnstableRestWarning, rests_told
from pliant.plants.core.signals import index, names

Array = np.ndarray

ITERATIONS = 60
CLOSE = 0.25  # correction over prediction: beyond it a step is halved
LEAST = 1e-4  # step of lambda below which the branch is taken to turn back
TOLERANCE = 1e-12  # of the forces that balance each other
KEPT = 0.4  # of the last change: a Jacobian that leaves more is taken again
HELD = 1e-3  # of the forces on a guess: what loads that hold it may leave
GROWS = 1e-5  # rate of growth over the frequency beside which rounding makes as much


class Forces(Protocol):
    """Net forces on the way, linear in the share of it in [0, 1]."""

    def net(self, q: Array, share: float) -> tuple[Array, float]:
        """(net force (n,), size of what balances)."""

    def jacobian(self, q: Array, share: float) -> Array:
        """Of the net force, (n, n)."""


def follow(forces: Forces, start: Array, told: str, origin: str = "the unloaded beam") -> Array:
    """q (n,) where the net force vanishes at the end of the way, from `start` (n,)."""
    q, reached, step = np.array(start, dtype=float), 0.0, 1.0
    J = forces.jacobian(q, reached)
    while reached < 1.0:
        step = min(step, 1.0 - reached)
        found = _advanced(forces, q, J, reached, step)
        if found is not None:
            q, reached, step = found, reached + step, 2 * step
            J = forces.jacobian(q, reached)
        elif step < 2 * LEAST:
            raise EquilibriumError(
                f"no equilibrium of {told} on the branch of {origin}: it is lost at {reached:.4g} of the way to the "
                f"loads, at a limit point or where it turns within {LEAST:g} of the way; a guess beyond reaches others",
                float(np.abs(forces.net(q, 1.0)[0]).max()),
            )
        else:
            step /= 2
    return q


def _advanced(forces: Forces, q: Array, J: Array, reached: float, step: float) -> Array | None:
    """The equilibrium a step on, if it and the one half way lie where the tangent leads; None where they do not."""
    change = forces.net(q, 1.0)[0] - forces.net(q, 0.0)[0]
    predicted = np.linalg.lstsq(J, -change, rcond=None)[0] * step
    slack = 1e-9 * (1 + float(np.linalg.norm(q)))
    found = _corrected(forces, q + predicted, J, reached + step)
    if found is None or np.linalg.norm(found - q - predicted) > CLOSE * np.linalg.norm(predicted) + slack:
        return None
    half = _corrected(forces, q + predicted / 2, J, reached + step / 2)
    if half is None or np.linalg.norm(half - (q + found) / 2) > CLOSE * np.linalg.norm(found - q) + slack:
        return None
    return found


def _corrected(forces: Forces, q: Array, J: Array, share: float) -> Array | None:
    """The equilibrium near q by Newton's method, or None; a Jacobian, first that given, serves while it converges."""
    last, fresh = np.inf, False
    for _ in range(ITERATIONS):
        r, size = forces.net(q, share)
        if not (np.isfinite(r).all() and np.isfinite(J).all()):
            return None
        change = np.linalg.lstsq(J, -r, rcond=None)[0]
        length = float(np.linalg.norm(change))
        if fresh and length > 2 * last:
            return None
        q = q + change
        if np.abs(r).max() <= TOLERANCE * size or length <= 1e-13 * (1 + float(np.linalg.norm(q))):
            return q
        fresh = length > KEPT * last
        if fresh:
            J = forces.jacobian(q, share)
        last = length
    return q if last <= 1e-9 * (1 + float(np.linalg.norm(q))) else None


def tell_unstable(M: Array, J: Array, told: str, names: tuple[str, ...]) -> None:
    """Warn (UnstableRestWarning) where undamped small deviations q'' = M^-1 J q grow; follower forces may make them."""
    if not rests_told():
        return
    squares, shapes = np.linalg.eig(np.linalg.solve(M, J))
    rates = np.sqrt(squares.astype(complex))
    rates = np.where(rates.real < 0, -rates, rates)
    k = int(np.argmax(rates.real))
    if rates[k].real > GROWS * np.abs(rates[k]):
        most = names[int(np.argmax(np.abs(shapes[:, k])))]
        warnings.warn(
            f"the rest point of {told} is unstable: with the loads held, small deviations grow by "
            f"exp({rates[k].real:.3g} t), most in {most}; a feedback must hold it, or a guess finds another",
            UnstableRestWarning,
            stacklevel=4,
        )


def rest(plant: Any, held: Mapping[str, float], guess: Mapping[str, float], p: Any) -> tuple[Array, Array]:
    """(x (nx,), u (nu,)) of a clamped plant that has `_statics`, loads held by name and others zero, from a guess."""
    n, signals = len(plant.coordinates), (*plant.states, *plant.inputs)
    u, start = np.zeros(plant.nu), np.zeros(len(signals))
    for name, value in guess.items():
        start[index(signals, name, "state or input")] = value
    for name, value in held.items():
        u[index(plant.inputs, name, "input")] = value
    statics, q = _Statics(plant, p), start[:n]
    if guess:
        q = follow(_FromGuess(statics, u, q), q, plant.label, "the guess")
    else:
        q = follow(_Unloaded(statics, u), q, plant.label)
    stiff, turned = statics.jacobians(q, u)
    tell_unstable(statics.mass_matrix(q, u), stiff + turned, plant.label, names(plant.coordinates))
    return np.append(q, np.zeros(plant.nx - n)), u


class _Statics:
    """Forces on the coordinates of a plant at rest at q (n,) under loads u (nu,)."""

    def __init__(self, plant: Any, p: Any) -> None:
        self._plant, self._p, self._n = plant, p, len(plant.coordinates)

    def _at(self, q: Array, u: Array) -> tuple[Any, ...]:
        x = np.append(q, np.zeros(self._plant.nx - self._n))
        values: tuple[Any, ...] = self._plant._arguments(x, u, p=self._p)[0]
        return values

    def _columns(self, of: Any, q: Array, u: Array) -> list[Array]:
        """Matrices (n, n) that a function gives column by column."""
        found = of(*self._at(q, u), np.eye(self._n), batch=self._n)
        return [np.array(part).reshape(self._n, self._n).T for part in found]

    def forces(self, q: Array, u: Array) -> tuple[Array, Array]:
        """Elastic forces, weight and loads."""
        elastic, outer = (np.array(part) for part in self._plant._statics(*self._at(q, u)))
        return elastic, outer

    def jacobians(self, q: Array, u: Array) -> list[Array]:
        """Of both."""
        return self._columns(self._plant._along, q, u)

    def mass_matrix(self, q: Array, u: Array) -> Array:
        """(n, n)."""
        return self._columns(self._plant._momentum, q, u)[0]


class _Unloaded:
    """Weight and loads grow from nothing."""

    def __init__(self, statics: _Statics, u: Array) -> None:
        self._statics, self._u = statics, u

    def net(self, q: Array, share: float) -> tuple[Array, float]:
        elastic, outer = self._statics.forces(q, self._u)
        return elastic + share * outer, float(np.abs(elastic).max() + np.abs(outer).max())

    def jacobian(self, q: Array, share: float) -> Array:
        stiff, turned = self._statics.jacobians(q, self._u)
        return stiff + share * turned


class _FromGuess:
    """From the loads that hold a guess to those given; where none hold it, what it lacks fades under those given."""

    def __init__(self, statics: _Statics, u: Array, guess: Array) -> None:
        nothing = np.zeros_like(u)
        elastic, weight = statics.forces(guess, nothing)
        reach = np.column_stack([statics.forces(guess, unit)[1] - weight for unit in np.eye(len(u))])
        before = np.linalg.lstsq(reach, -elastic - weight, rcond=None)[0]
        left = elastic + weight + reach @ before
        if np.abs(left).max() > HELD * (np.abs(elastic).max() + np.abs(weight).max()):
            before, left = u, elastic + weight + reach @ u
        self._statics, self._before, self._u, self._left = statics, before, u, left

    def _loads(self, share: float) -> Array:
        return self._before + share * (self._u - self._before)

    def net(self, q: Array, share: float) -> tuple[Array, float]:
        elastic, outer = self._statics.forces(q, self._loads(share))
        return elastic + outer - (1 - share) * self._left, float(np.abs(elastic).max() + np.abs(outer).max())

    def jacobian(self, q: Array, share: float) -> Array:
        stiff, turned = self._statics.jacobians(q, self._loads(share))
        return stiff + turned
