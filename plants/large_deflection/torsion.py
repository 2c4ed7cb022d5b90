"""Torsion of a uniform rod clamped at its root, with an inertia at its tip: the natural modes.

Gamma = sin(kappa xi), G J Gamma'(1) = omega^2 I Gamma(1): cot kappa = ratio kappa, ratio = I/(rho I_p L). Shapes of a
free end, Gamma'(1) = 0, would meet a payload's torque as the reciprocal of their number.

Source   as of a bar with a mass at its end; the roots are those of `pinned_rod.AxialModes`
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pliant.plants.beams.pinned_rod import AxialModes
from pliant.plants.exact_rotations.quadrature import Array


@dataclass(frozen=True, eq=False)
class TorsionShapes:
    """n shapes, each 1 where it is largest and positive at the tip: a coordinate is an angle [rad]."""

    n: int
    ratio: float = 0.0  # inertia of the payload about the axis, over the rod's own

    @cached_property
    def roots(self) -> Array:
        """kappa (n,), one in each (k pi, (k + 1/2) pi], k from 0."""
        return AxialModes(self.n, self.ratio).roots

    @cached_property
    def _scale(self) -> Array:
        """The shape 0 of a heavy tip is largest at it, below 1; the others reach 1 within."""
        return (-1.0) ** np.arange(self.n) / np.where(self.roots < np.pi / 2, np.sin(self.roots), 1.0)

    def __call__(self, xi: Array, derivative: int = 0) -> Array:
        """Gamma or dGamma/dxi at xi (k,) -> (k, n)."""
        turned = np.multiply.outer(xi, self.roots)
        return self._scale * (self.roots * np.cos(turned) if derivative else np.sin(turned))

    @property
    def stiffness(self) -> Array:
        """int Gamma'^2 dxi (n,); between different shapes it is zero."""
        k = self.roots
        return (self._scale * k) ** 2 * (1 + np.sinc(2 * k / np.pi)) / 2
