"""A rigid body at the tip of a beam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import shown
from pliant.plants.core.parameters import is_symbolic, quantity, validate


@dataclass(frozen=True)
class Payload:
    """A rigid body at the tip of a beam.

    `inertia` is the moment about every axis through the mass centre, or a 3 x 3 nested tuple about the mass
    centre in the axes of the beam's tip. `offset` points from the tip to the mass centre.
    """

    mass: Any = quantity("kg", "nonnegative", 0.0, uncertain=True)
    inertia: Any = quantity("kg m^2", "finite", 0.0, or_shape=(3, 3))
    offset: Any = quantity("m", "finite", (0.0, 0.0, 0.0), shape=(3,))

    def __post_init__(self) -> None:
        validate(self)
        if isinstance(self.inertia, tuple):
            check_inertia("Payload.inertia", self.inertia, "; for planar motion give the scalar moment about z")
        elif not is_symbolic(self.inertia) and self.inertia < 0:
            raise ValueError(f"Payload.inertia = {self.inertia!r} must be >= 0 [kg m^2]")

    @property
    def inertia_z(self) -> Any:
        """Moment of inertia [kg m^2] about z through the mass centre."""
        return self.moment(2)

    def moment(self, axis: int) -> Any:
        """Moment of inertia [kg m^2] about an axis, x, y or z by its number, through the mass centre."""
        return self.inertia[axis][axis] if isinstance(self.inertia, tuple) else self.inertia

    def about_tip(self, axis: int) -> Any:
        """The same about that axis through the tip."""
        across = [self.offset[k] ** 2 for k in range(3) if k != axis]
        return self.moment(axis) + self.mass * sum(across)

    def ratios(self, mass: float, length: float, axis: int = 2) -> dict[str, float]:
        """What `basis` asks of a load, about y (1) or z (2), on a beam of this mass [kg] and length [m]."""
        return {
            "tip_mass_ratio": self.mass / mass,
            "tip_inertia_ratio": self.about_tip(axis) / (mass * length**2),
            "tip_coupling_ratio": self.mass * self.offset[0] / (mass * length),
        }


def check_inertia(name: str, inertia: Any, remedy: str = "") -> None:
    """ValueError, which calls it `name`, unless a numeric inertia (3, 3), or one moment about every axis, is one that a
    rigid body can have; `remedy`: what to do where one moment is too large.
    """
    rows = inertia if isinstance(inertia, tuple) else ((inertia, 0.0, 0.0), (0.0, inertia, 0.0), (0.0, 0.0, inertia))
    if any(is_symbolic(item) for row in rows for item in row):
        return
    tensor = np.array(rows, dtype=float)
    slack = 1e-9 * np.abs(tensor).max()
    if np.abs(tensor - tensor.T).max() > slack:
        raise ValueError(f"{name} = {shown(inertia)} must be symmetric [kg m^2]")
    principal = np.linalg.eigvalsh(tensor)
    if principal[0] < -slack:
        raise ValueError(f"{name} = {shown(inertia)} must have principal moments >= 0 [kg m^2], has {principal[0]:.4g}")
    if principal[0] + principal[1] < principal[2] - slack:
        raise ValueError(
            f"{name} = {shown(inertia)} must have no principal moment above the sum of the others [kg m^2], has "
            f"{principal[2]:.6g} > {principal[0] + principal[1]:.6g}{remedy}"
        )
