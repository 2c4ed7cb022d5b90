"""Rest of a clamped beam under its loads, followed from the unloaded beam as the loads grow.

Newton's method alone may end on any equilibrium. Here lambda takes weight and loads from nothing to the whole,

    elastic forces(q) + lambda (weight and loads on q) = 0,

or, from a guess, the forces that the guess lacks from the whole to nothing. A step is predicted along the tangent,
corrected by Newton's method, and taken only where the correction is small beside the prediction; else it is halved.
What is found lies on the branch of the start; where that turns back (a limit point, the beam snaps through) the steps
become too small, and EquilibriumError says at which share of the load.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from pliant.plants.core.errors import EquilibriumError, UnstableRestWarning
from pliant.plants.core.signals import index, names

Array = np.ndarray
Forces = Callable[[Array], tuple[Array, Array, Array, Array]]

ITERATIONS = 12
CLOSE = 0.25  # correction over prediction: beyond it a step is halved
LEAST = 1e-4  # step of lambda below which the branch is taken to turn back
TOLERANCE = 1e-12  # of the forces that balance each other
GROWS = 1e-5  # rate of growth over the frequency beside which rounding makes as much


def follow(forces: Forces, start: Array, told: str, from_guess: bool = False) -> Array:
    """q (n,) where elastic and outer forces cancel, from `start` (n,).

    forces(q) -> (elastic (n,), its Jacobian, outer (n,), its Jacobian).
    """
    q, reached, step = np.array(start, dtype=float), 0.0, 1.0
    held: Array | None = None
    if from_guess:
        elastic, _, outer, _ = forces(q)
        held = elastic + outer
    while reached < 1.0:
        step = min(step, 1.0 - reached)
        predicted = _tangent(forces, q, reached, held) * step
        found, moved = _corrected(forces, q + predicted, reached + step, held)
        near = moved <= CLOSE * np.linalg.norm(predicted) + 1e-9 * (1 + np.linalg.norm(q))
        if found is None or not near:
            step /= 2
            if step < LEAST:
                origin = "the guess" if from_guess else "the unloaded beam"
                raise EquilibriumError(
                    f"no equilibrium of {told} on the branch of {origin}: it is lost at {reached:.4g} of the way to "
                    "the load, at a limit point; a guess on the branch that is meant reaches beyond",
                    float(np.abs(_residual(forces, q, 1.0, held)[0]).max()),
                )
            continue
        q, reached, step = found, reached + step, 2 * step
    return q


def _residual(forces: Forces, q: Array, share: float, held: Array | None) -> tuple[Array, Array, float]:
    """Forces at a share of the way, their Jacobian, and the size of what balances."""
    elastic, stiff, outer, turned = forces(q)
    size = float(np.abs(elastic).max() + np.abs(outer).max())
    if held is None:
        return elastic + share * outer, stiff + share * turned, size
    return elastic + outer - (1 - share) * held, stiff + turned, size


def _tangent(forces: Forces, q: Array, share: float, held: Array | None) -> Array:
    """dq/d lambda."""
    _, J, _ = _residual(forces, q, share, held)
    change = forces(q)[2] if held is None else held
    return np.asarray(np.linalg.lstsq(J, -change, rcond=None)[0])


def _corrected(forces: Forces, q: Array, share: float, held: Array | None) -> tuple[Array | None, float]:
    """(the equilibrium near q or None, how far Newton's method went for it)."""
    start, last = q, np.inf
    for _ in range(ITERATIONS):
        r, J, size = _residual(forces, q, share, held)
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
    n, coordinates = len(plant.coordinates), plant.coordinates
    x, u, start = np.zeros(plant.nx), np.zeros(plant.nu), np.zeros(n)
    for name, value in held.items():
        u[index(plant.inputs, name, "input")] = value
    for name, value in guess.items():
        k = index((*plant.states, *plant.inputs), name, "state or input")
        if k < n:
            start[k] = value

    def forces(q: Array) -> tuple[Array, Array, Array, Array]:
        x[:n] = q
        values, _ = plant._arguments(x, u, p=p)
        elastic, stiff, outer, turned = (np.array(part) for part in plant._statics(*values))
        return elastic[:, 0], stiff, outer[:, 0], turned

    q = follow(forces, start, plant.label, bool(guess))
    _, stiff, _, turned = forces(q)
    x[:n] = q
    tell_unstable(plant.mass_matrix(x, p=p), stiff + turned, plant.label, names(coordinates))
    return x, u
