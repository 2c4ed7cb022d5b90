"""Strains of a beam as coordinates, and the energy they store: bending, torsion, extension, shear.

With ' = d/dxi, xi = s/L, a section's frame F turns by F' = F k~ and the axis goes on by r'/L = F (1 + e, g_y, g_z):

    k = k_rest + (twists, flaps, bends), each a sum of shapes, e of stretches, (g_y, g_z) of shears.

Stored is (1/2) int [G J k_x^2 + E I_y k_y^2 + E I_z (k_z - k_rest)^2]/L + L [E A e^2 + kappa G A (g_y^2 + g_z^2)] dxi,
a constant quadratic form, whatever turns the sections take.

Shapes   bends and flaps as `basis` says; twists, stretches and shears Legendre polynomials P_0, P_1, .. of 2 xi - 1, so
         that twist1 [rad] is the tip's, stretch1 [1] the mean. On several panels all are Legendre polynomials on each:
         bend1_1 [rad] is the turn of panel 1 from end to end
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
from pliant.plants.core.imports import linalg
from pliant.plants.exact_rotations.projection import nearest
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


def legendre(count: int, xi: Array, panels: int = 1) -> Array:
    """P_0 .. on each of equal panels of [0, 1], zero on the others, at xi (k,): (k, panels count), panel by panel."""
    panel, z = _placed(xi, panels)
    own = np.polynomial.legendre.legvander(2 * z - 1, max(count - 1, 0))[:, :count]
    here = np.arange(panels) == panel[:, None]
    return (here[:, :, None] * own[:, None, :]).reshape(len(z), panels * count)


def integrated(count: int, xi: Array, panels: int = 1) -> Array:
    """Their integrals from 0, (k, panels count)."""
    panel, z = _placed(xi, panels)
    table = np.polynomial.legendre.legvander(2 * z - 1, max(count, 1))
    k = np.arange(1, count)
    rising = (table[:, 2 : count + 1] - table[:, : max(count - 1, 0)]) / (4 * k + 2)
    own = np.column_stack([z, rising])[:, :count]
    whole = (np.arange(count) == 0).astype(float)
    here, passed = np.arange(panels) == panel[:, None], np.arange(panels) < panel[:, None]
    found = here[:, :, None] * own[:, None, :] + passed[:, :, None] * whole
    return found.reshape(len(z), panels * count) / panels


def _placed(xi: Array, panels: int) -> tuple[Array, Array]:
    """The panel of each xi (k,), the last one's end in it, and where in it, in [0, 1]."""
    xi = np.atleast_1d(np.asarray(xi, dtype=float))
    panel = np.minimum((xi * panels).astype(int), panels - 1)
    return panel, xi * panels - panel


@dataclass(frozen=True, eq=False)
class PanelBends:
    """Curvatures that are `count` polynomials on each of equal panels; the first is the turn of its ends by 1."""

    count: int
    panels: int
    rotating: bool  # whether shape 0 is the root's turn

    @property
    def n(self) -> int:
        """How many coordinates."""
        return self.rotating + self.panels * self.count

    def __call__(self, xi: Array) -> Array:
        """Turns at xi (k,), (k, n)."""
        bent = self.panels * integrated(self.count, xi, self.panels)
        return np.column_stack([np.ones(len(bent)), bent]) if self.rotating else bent

    def curvature(self, xi: Array) -> Array:
        """d/dxi of the turns at xi (k,), (k, n)."""
        bent = self.panels * legendre(self.count, xi, self.panels)
        return np.column_stack([np.zeros(len(bent)), bent]) if self.rotating else bent

    @property
    def stiffness(self) -> Array:
        """int psi' psi'^T dxi, (n, n)."""
        squares = np.tile(self.panels / (2 * np.arange(self.count) + 1), self.panels)
        return np.diag(np.append(0.0, squares) if self.rotating else squares)

    def embedding(self, simpler: BendShapes) -> Array:
        """The coordinates (n, n of simpler) whose curvature comes nearest; a turn of the root is the same in both."""
        k = int(self.rotating)
        bend = nearest(lambda xi: simpler.curvature(xi)[:, k:], lambda xi: self.curvature(xi)[:, k:])
        return np.asarray(linalg.block_diag(np.eye(k), bend))


@dataclass(frozen=True, eq=False)
class StrainFields:
    """q = [root position where it moves, (root angle, bends), flaps, twists, stretches, shears along y, along z]."""

    bend: BendShapes  # about z
    flap: BendShapes | None  # about y; None in the plane
    twists: int
    stretches: int
    shears: int
    panels: int  # equal parts of the length, each with its own strains
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
            "twist": self.panels * self.twists * space,
            "stretch": self.panels * self.stretches,
            "shear_y": self.panels * self.shears,
            "shear_z": self.panels * self.shears * space,
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

    def rows(self, kind: str, xi: Array) -> Array:
        """Shapes of a strain at xi (k,), (k, coordinates of the kind); of curvatures times the length."""
        if kind in ("bend", "flap"):
            shapes = self.bend if kind == "bend" or self.flap is None else self.flap
            return shapes.curvature(xi)
        own = self.slices[kind]
        return (self.panels if kind == "twist" else 1.0) * legendre(
            (own.stop - own.start) // self.panels, xi, self.panels
        )

    def of(self, kind: str, q: ca.SX, xi: Array) -> ca.SX:
        """The strain of a kind at xi (k,), (k,); of curvatures times the length, without what is at rest."""
        return applied(self.rows(kind, xi), q[self.slices[kind]])

    def turned(self, q: ca.SX, xi: Array) -> ca.SX:
        """Root angle and integral of the bends up to xi (k,), (k,) [rad]."""
        return applied(self.bend(xi), q[self.slices["bend"]])

    def twisted(self, q: ca.SX) -> ca.SX:
        """Integral of the twist up to the tip [rad]."""
        turns = self.panels * integrated(self.twists, np.ones(1), self.panels)
        return applied(turns, q[self.slices["twist"]])

    def stiffness(self, beam: Beam) -> list[tuple[slice, ca.SX]]:
        """Blocks of the stiffness matrix and where they stand."""
        E, L = beam.E, beam.length
        found: list[tuple[slice, ca.SX]] = [(self.slices["bend"], beam.EI / L * sparse(self.bend.stiffness))]
        if self.flap is not None:
            found.append((self.slices["flap"], E * beam.I_y / L * sparse(self.flap.stiffness)))
        for kind, rigidity in (
            ("twist", beam.GJ / L * self.panels),
            ("stretch", E * beam.area * L / self.panels),
            ("shear_y", beam.shear_stiffness * L / self.panels),
            ("shear_z", beam.shear_stiffness * L / self.panels),
        ):
            at = self.slices[kind]
            squares = 1 / (2 * np.arange((at.stop - at.start) // self.panels) + 1)  # int P_k^2 on [0, 1]
            if len(squares):
                found.append((at, rigidity * ca.SX(ca.diag(ca.DM(np.tile(squares, self.panels))))))
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
