"""A beam as a body of a tree, whatever its sections' turns: what follows from its straight shape."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from pliant.plants.core.signals import Signal
from pliant.plants.multibody_parts.tree_beam import FAMILIES, TreeBeam

from .elastic_body import ElasticBody


def family_signals(counts: tuple[int, ...]) -> list[Signal]:
    """Coordinates of a beam: bending in x-y and x-z [m], twist [rad], stretch [m]."""
    units = ("m", "m", "rad", "m")
    words = zip(FAMILIES, units, counts, strict=True)
    return [Signal(f"{family}{k + 1}", unit) for family, unit, n in words for k in range(n)]


@dataclass(frozen=True, eq=False)
class BeamBody(ElasticBody):
    """`straight` holds the shapes, the parameters and the integrals of the straight beam."""

    straight: TreeBeam

    @property
    def n(self) -> int:
        return self.straight.n

    def dissipation(self, rate: ca.SX) -> ca.SX:
        return self.straight.beam.damping * ca.dot(rate, self.straight.stiffness() @ rate) / 2

    def line(self, eta: ca.SX, points: int) -> ca.SX:
        """Sections from the root to the end."""
        still = ca.SX.zeros(self.n)
        along = [self.section(float(xi), eta, still).shift for xi in np.linspace(0.0, 1.0, points)]
        return ca.horzcat(*[ca.densify(p) for p in along])
