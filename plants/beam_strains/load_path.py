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
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from pliant.plants.core.errors import EquilibriumError, UnstableRestWarning
from pliant.plants.core.signals import index, names

Array = np.ndarray
Forces = Callable[[Array, float], tuple[Array, Array, float]]

ITERATIONS = 12
CLOSE = 0.25  # correction over prediction: beyond it a step is halved
LEAST = 1e-4  # step of lambda below which the branch is taken to turn back
TOLERANCE = 1e-12  # of the forces that balance each other
HELD = 1e-3  # of the forces on a guess: what loads that hold it may leave
GROWS = 1e-5  # rate of growth over the frequency beside which rounding makes as much


def follow(forces: Forces, start: Array, told: str, origin: str = "the unloaded beam") -> Array:
    """q (n,) where the net force vanishes at the end of the way, from `start` (n,).

    forces(q, share) -> (net force (n,), its Jacobian (n, n), size of what balances), linear in the share in [0, 1].
    """
    q, reached, step = np.array(start, dtype=float), 0.0, 1.0
    while reached < 1.0:
        step = min(step, 1.0 - reached)
        found = _advanced(forces, q, reached, step)
        if found is not None:
            q, reached, step = found, reached + step, 2 * step
        elif step < 2 * LEAST:
            raise EquilibriumError(
                f"no equilibrium of {told} on the branch of {origin}: it is lost at {reached:.4g} of the way to the "
                f"loads, at a limit point or where it turns within {LEAST:g} of the way; a guess beyond reaches others",
                float(np.abs(forces(q, 1.0)[0]).max()),
            )
        else:
            step /= 2
    return q


def _advanced(forces: Forces, q: Array, reached: float, step: float) -> Array | None:
    """The equilibrium a step on, if it and the one half way lie where the tangent leads; None where they do not."""
    _, J, _ = forces(q, reached)
    change = forces(q, 1.0)[0] - forces(q, 0.0)[0]
    predicted = np.linalg.lstsq(J, -change, rcond=None)[0] * step
    slack = 1e-9 * (1 + float(np.linalg.norm(q)))
    found, moved = _corrected(forces, q + predicted, reached + step)
    if found is None or moved > CLOSE * np.linalg.norm(predicted) + slack:
        return None
    half, _ = _corrected(forces, q + predicted / 2, reached + step / 2)
    if half is None or np.linalg.norm(half - (q + found) / 2) > CLOSE * np.linalg.norm(found - q) + slack:
        return None
    return found


def _corrected(forces: Forces, q: Array, share: float) -> tuple[Array | None, float]:
    """(the equilibrium near q or None, how far Newton's method went for it)."""
    start, last = q, np.inf
    for _ in range(ITERATIONS):
        r, J, size = forces(q, share)
        if not (np.isfinite(r).all() and np.isfinite(J).all()):
            return None, np.inf
        change = np.linalg.lstsq(J, -r, rcond=None)[0]
        q = q + change
        length = float(np.linalg.norm(change))
        if np.abs(r).max() <= TOLERANCE * size or length <= 1e-13 * (1 + float(np.linalg.norm(q))):
            return q, float(np.linalg.norm(q - start))
        if length > 2 * last:
            return None, np.inf
        last = length
    return (q, float(np.linalg.norm(q - start))) if last <= 1e-9 * (1 + float(np.linalg.norm(q))) else (None, np.inf)


def tell_unstable(M: Array, J: Array, told: str, names: tuple[str, ...]) -> None:
    """Warn (UnstableRestWarning) where undamped small deviations q'' = M^-1 J q grow; follower forces may make them."""
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
    statics = _Statics(plant, u, p)
    q = start[:n]
    if guess:
        q = follow(statics.from_guess(q), q, plant.label, "the guess")
    else:
        q = follow(statics.unloaded, q, plant.label)
    x = np.append(q, np.zeros(plant.nx - n))
    J = statics.unloaded(q, 1.0)[1]
    tell_unstable(plant.mass_matrix(x, p=p), J, plant.label, names(plant.coordinates))
    return x, u


class _Statics:
    """Net forces on the coordinates of a plant at rest under loads u (nu,), on the way to them."""

    def __init__(self, plant: Any, u: Array, p: Any) -> None:
        self._plant, self._u, self._p, self._n = plant, u, p, len(plant.coordinates)

    def _parts(self, q: Array, u: Array) -> list[Array]:
        """Elastic forces, their Jacobian, weight and loads, and theirs."""
        x = np.append(q, np.zeros(self._plant.nx - self._n))
        values, _ = self._plant._arguments(x, u, p=self._p)
        elastic, stiff, outer, turned = (np.array(part) for part in self._plant._statics(*values))
        return [elastic[:, 0], stiff, outer[:, 0], turned]

    def unloaded(self, q: Array, share: float) -> tuple[Array, Array, float]:
        """Weight and loads grow from nothing."""
        elastic, stiff, outer, turned = self._parts(q, self._u)
        return elastic + share * outer, stiff + share * turned, float(np.abs(elastic).max() + np.abs(outer).max())

    def from_guess(self, guess: Array) -> Forces:
        """From the loads that hold the guess; where none do, what it lacks fades under those given."""
        nothing = np.zeros_like(self._u)
        elastic, _, weight, _ = self._parts(guess, nothing)
        reach = np.column_stack([self._parts(guess, unit)[2] - weight for unit in np.eye(len(nothing))])
        before = np.linalg.lstsq(reach, -elastic - weight, rcond=None)[0]
        left = elastic + weight + reach @ before
        if np.abs(left).max() > HELD * (np.abs(elastic).max() + np.abs(weight).max()):
            before, left = self._u, elastic + weight + reach @ self._u

        def forces(q: Array, share: float) -> tuple[Array, Array, float]:
            elastic, stiff, outer, turned = self._parts(q, before + share * (self._u - before))
            size = float(np.abs(elastic).max() + np.abs(outer).max())
            return elastic + outer - (1 - share) * left, stiff + turned, size

        return forces
