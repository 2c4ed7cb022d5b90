"""Strains of a beam as coordinates, and the energy they store: bending, torsion, extension, shear.

With ' = d/dxi, xi = s/L, a section's frame F turns by F' = F k~ and the axis goes on by r'/L = F (1 + e, g_y, g_z):

    k = k_rest + (twists, flaps, bends), each a sum of shapes, e of stretches, (g_y, g_z) of shears.

Stored is (1/2) int [G J k_x^2 + E I_y k_y^2 + E I_z (k_z - k_rest)^2]/L + L [E A e^2 + kappa G A (g_y^2 + g_z^2)] dxi,
a constant quadratic form, whatever turns the sections take.

Shapes   bends and flaps as `basis` says; twists, stretches and shears Legendre polynomials P_0, P_1, .. of 2 xi - 1, so
         that twist1 [rad] is the tip's, stretch1 [1] the mean
Source   J. C. Simo, "A finite strain beam formulation. The three-dimensional dynamic problem. Part I", Comput. Methods
         Appl. Mech. Eng. 49 (1985), 55-70; strains expanded, as in the geometric variable-strain approach
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import casadi as ca
import numpy as np

from pliant.plants.beams.section import Beam
from pliant.plants.exact_rotations.quadrature import Array, applied, sparse


class BendShapes(Protocol):
    """Turns of the sections, the first column the root's where it turns."""

    @property
    def n(self) -> int: ...
    @property
    def rotating(self) -> bool: ...
    @property
    def stiffness(self) -> Array: ...
    def __call__(self, xi: Array) -> Array: ...
    def curvature(self, xi: Array) -> Array:
        """d/dxi of the turns at xi (k,), (k, n)."""


def legendre(count: int, xi: Array) -> Array:
    """P_0 .. of 2 xi - 1 at xi (k,), (k, count)."""
    return np.polynomial.legendre.legvander(2 * np.asarray(xi, dtype=float) - 1, max(count - 1, 0))[:, :count]


def integrated(count: int, xi: Array) -> Array:
    """Their integrals from 0, (k, count)."""
    table = legendre(count + 1, xi)
    k = np.arange(1, count)
    rising = (table[:, 2:] - table[:, : count - 1]) / (4 * k + 2) if count > 1 else table[:, :0]
    return np.column_stack([np.asarray(xi, dtype=float), rising])[:, :count]


@dataclass(frozen=True, eq=False)
class StrainFields:
    """q = [root position where it moves, (root angle, bends), flaps, twists, stretches, shears along y, along z]."""

    bend: BendShapes  # about z
    flap: BendShapes | None  # about y; None in the plane
    twists: int
    stretches: int
    shears: int
    travels: int  # coordinates of the root's position: none, or 2 in the plane and 3 in space

    @property
    def planar(self) -> bool:
        """Whether the beam stays in the plane."""
        return self.flap is None

    @cached_property
    def slices(self) -> dict[str, slice]:
        """{kind: where its coordinates stand in q}."""
        space = not self.planar
        sizes = {
            "root": self.travels,
            "bend": self.bend.n,
            "flap": self.flap.n if self.flap is not None else 0,
            "twist": self.twists * space,
            "stretch": self.stretches,
            "shear_y": self.shears,
            "shear_z": self.shears * space,
        }
        ends = np.cumsum([0, *sizes.values()])
        return {kind: slice(int(a), int(b)) for kind, a, b in zip(sizes, ends[:-1], ends[1:])}

    @property
    def n(self) -> int:
        """How many coordinates."""
        return self.slices["shear_z"].stop

    @property
    def turns(self) -> int:
        """Where the root's angle stands in q, if it turns: -1 if not."""
        return self.travels if self.bend.rotating else -1

    def of(self, kind: str, q: ca.SX, xi: Array) -> ca.SX:
        """The strain of a kind at xi (k,), (k,); of "bend" and "flap" times the length, without what is at rest."""
        own = q[self.slices[kind]]
        if kind in ("bend", "flap"):
            shapes = self.bend if kind == "bend" or self.flap is None else self.flap
            return applied(shapes.curvature(xi), own)
        return applied(legendre(own.shape[0], xi), own)

    def turned(self, q: ca.SX, xi: Array) -> ca.SX:
        """Root angle and integral of the bends up to xi (k,), (k,) [rad]."""
        return applied(self.bend(xi), q[self.slices["bend"]])

    def stiffness(self, beam: Beam) -> list[tuple[slice, ca.SX]]:
        """Blocks of the stiffness matrix and where they stand."""
        E, L = beam.E, beam.length
        found: list[tuple[slice, ca.SX]] = [(self.slices["bend"], beam.EI / L * sparse(self.bend.stiffness))]
        if self.flap is not None:
            found.append((self.slices["flap"], E * beam.I_y / L * sparse(self.flap.stiffness)))
        for kind, rigidity in (
            ("twist", beam.GJ / L),
            ("stretch", E * beam.area * L),
            ("shear_y", beam.shear_stiffness * L),
            ("shear_z", beam.shear_stiffness * L),
        ):
            at = self.slices[kind]
            squares = 1 / (2 * np.arange(at.stop - at.start) + 1)  # int P_k^2
            if len(squares):
                found.append((at, rigidity * ca.SX(ca.diag(ca.DM(squares)))))
        return found

    def strain_energy(self, beam: Beam, q: ca.SX) -> ca.SX:
        """[J]; of rates v times the damping it is the Rayleigh function [W]."""
        return sum((ca.bilin(K, q[at], q[at]) / 2 for at, K in self.stiffness(beam)), ca.SX(0))

    def elastic_force(self, beam: Beam, q: ca.SX, v: ca.SX) -> ca.SX:
        """-K (q + damping v), (n,)."""
        force = ca.SX.zeros(self.n)
        for at, K in self.stiffness(beam):
            force[at] = -K @ (q[at] + beam.damping * v[at])
        return force
