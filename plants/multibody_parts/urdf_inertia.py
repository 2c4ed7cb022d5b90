"""Inertias that no rigid body has, as files of real machines hold them: refused, or repaired in words.

Of a mass distribution P = tr(J)/2 1 - J = int p p^T dm has no negative eigenvalue; that is the same as principal
moments >= 0 of which none exceeds the sum of the others. The nearest P with none has its negative eigenvalues as zero.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pliant.plants.beams.payload import check_inertia

Tensor = tuple[tuple[float, ...], ...]
NONE: Tensor = ((0.0,) * 3,) * 3
SMALL_BALL = 0.01  # [m], radius of the ball whose inertia a mass without one gets
HOW = ("refuse", "repair")


class Taken(NamedTuple):
    """An inertia about the mass centre, and in words what was changed; "" where nothing was."""

    inertia: Tensor
    change: str = ""


def of_link(name: str, mass: float, inertia: Tensor, how: str) -> Taken:
    """The inertia of a link; ValueError where none can be such, unless it is repaired."""
    empty = not any(map(any, inertia))
    if mass == 0 and not empty:
        if how == "refuse":
            raise ValueError(
                f"link {name!r} has mass value = {mass!r} and an inertia, must have both or neither [kg, kg m^2]"
            )
        return Taken(NONE, f"link {name!r}: its inertia {_words(inertia)} kg m^2 was left out, as it has no mass")
    try:
        check_inertia(f"link {name!r} inertia", inertia, "; inertias='repair' takes the nearest that a body can have")
    except ValueError:
        if how == "refuse":
            raise
        J = np.array(inertia)
        found = nearest(J)
        return Taken(
            tuple(tuple(float(e) for e in row) for row in found),
            f"link {name!r}: its principal moments {_words(np.linalg.eigvalsh(J))} kg m^2, which no body has, became "
            f"{_words(np.linalg.eigvalsh(found))}",
        )
    return Taken(inertia)


def moved(name: str, joint: str, mass: float, inertia: Tensor, how: str) -> Taken:
    """The inertia of a link that a joint moves; ValueError where it is a point of mass, unless it is repaired."""
    if mass == 0 or any(map(any, inertia)):
        return Taken(inertia)
    if how == "refuse":
        raise ValueError(
            f"link {name!r} has mass value = {mass!r} and no inertia, must have both where joint {joint!r} moves it "
            "[kg, kg m^2]"
        )
    J = 0.4 * mass * SMALL_BALL**2
    given = ((J, 0.0, 0.0), (0.0, J, 0.0), (0.0, 0.0, J))
    return Taken(given, f"link {name!r}: without an inertia, it got {J:.4g} kg m^2, that of a ball of 1 cm")


def nearest(J: np.ndarray) -> np.ndarray:
    """The inertia (3, 3) of the mass distribution nearest to a symmetric J (3, 3)."""
    values, axes = np.linalg.eigh(np.trace(J) / 2 * np.eye(3) - J)
    P = (axes * np.maximum(values, 0.0)) @ axes.T
    found = np.trace(P) * np.eye(3) - P
    return np.asarray((found + found.T) / 2)


def _words(values: object) -> str:
    numbers = np.array(values, dtype=float).ravel()
    return "(" + ", ".join(f"{v:.4g}" for v in numbers) + ")"
