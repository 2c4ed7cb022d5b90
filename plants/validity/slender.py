"""Ranges of beams that bend little: Euler-Bernoulli with small slopes, with ("stiffened") or without ("linear") the
second-order shortening.

Slope       A deflection u(s) over arc length bends by u''/sqrt(1 - u'^2), so that the strain energy (1/2) int E I u''^2
            leaves out the share e = int u''^2 u'^2/int u''^2 of itself, and a static deflection errs by 2 e to first
            order. With theta the largest slope, 2 e = 0.46 theta^2 under a force at the tip, 0.41 under a uniform load,
            0.5 for a half-sine between pins. SLOPE = 0.3 keeps that below 5 %: a cantilever's tip at a fifth of its
            length, where the elastica (K. E. Bisshopp and D. C. Drucker, 1945) has 0.1923 L for 0.2 L, 4.0 %.
Shortening  "linear" leaves out s = (1/2) int u'^2, by which the tip stands too far out: SHORTENING is 1 % of L.
Axial load  "linear" leaves out the work of the axial force N on the shortening, (1/2) int N u'^2, the geometric
            stiffness. As a share of the bending stiffness int E I u''^2, u the link's lowest mode, a static deflection
            errs by it and a frequency by its half: AXIAL keeps 5 %. For the spin Omega of a cantilever it is
            1.19 (Omega/omega_1)^2 (Southwell's coefficient), so that the range ends at a fifth of the first frequency.
            N is that of spin and weight of the straight link: accelerations of its root are not counted.
Stretch     The links are inextensible; N/(E A) is by how much of its length a point is then misplaced: STRETCH is 1 %.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from pliant.plants.beams.elastic_link import ElasticLink
from pliant.plants.beams.legendre_ritz import StrainShapes
from pliant.plants.beams.pinned_rod import PinnedRod
from pliant.plants.core.imports import linalg

from .ranges import Range, largest

SLOPE = 0.3  # [rad]
SHORTENING = 0.01  # of the length
AXIAL = 0.05  # of the bending stiffness
STRETCH = 0.01  # strain
STATIONS = np.linspace(0.0, 1.0, 9)  # where slopes are looked at: shapes of up to eight half-waves show theirs
NONE_HOLDS = "no kinematics of this library"


@dataclass(frozen=True)
class Pull:
    """The force along a straight link, outwards: `uniform` + `growing` x per mass at x, `tip` at its end."""

    uniform: ca.SX  # [m/s^2]
    growing: ca.SX  # [1/s^2]
    tip: ca.SX  # [N]

    def at_root(self, link: ElasticLink) -> ca.SX:
        """Axial force at the root [N], positive in tension."""
        m, L = link.beam.mass, link.beam.length
        return m * (self.uniform + self.growing * L / 2) + self.tip

    def stiffness(self, link: ElasticLink, shape: np.ndarray) -> ca.SX:
        """int N u'^2 [N/m] for u one of the link's shapes (n,)."""
        m, L, basis = link.beam.mass, link.beam.length, link.basis
        mean, moment, whole = (
            shape @ S @ shape for S in (basis.shortening_mean, basis.shortening_moment, basis.shortening)
        )
        return m / L * (self.uniform * mean + self.growing * L * moment) + self.tip / L * whole


def slopes(link: ElasticLink, q: ca.SX) -> ca.SX:
    """The largest |u'| of a link [rad]; with shear the largest of u' and of the sections' turn."""
    phi = link.basis.phi
    rows = [phi(STATIONS, 1)] + ([phi.rotation(STATIONS)] if isinstance(phi, StrainShapes) else [])
    return largest(np.concatenate(rows), q) / link.beam.length


def shortening(link: ElasticLink, q: ca.SX) -> ca.SX:
    """int u'^2/2 over the length, whether the link keeps it or not."""
    S = link.basis.shortening
    return ca.dot(q, ca.sparsify(ca.DM(S)) @ q) / (2 * link.beam.length**2)


def small_slopes(name: str, link: ElasticLink, q: ca.SX, stiffened: str, large: str) -> list[Range]:
    """Ranges that hold however the link moves; `stiffened`, `large`: the kinematics beyond."""
    if not link.basis.n:
        return []
    keeps = "static deflections err by less than 5 %"
    found = [Range(f"slope of {name}", "rad", SLOPE, keeps, large, slopes(link, q))]
    if not link.stiffened:
        keeps = "leaving it out misplaces the tip by less than 1 % of the length"
        value = shortening(link, q)
        found.append(Range(f"shortening of {name} over its length", "1", SHORTENING, keeps, stiffened, value))
    return found


def lowest(link: ElasticLink, carried: float) -> np.ndarray:
    """The lowest bending mode (n,) of a link clamped at its root with a mass ratio `carried` at its tip, in numbers."""
    beam, basis = link.beam, link.basis
    if not basis.n:
        return np.zeros(0)
    K = basis.stiffness
    if basis.shear is not None:
        K = K + beam.shear_stiffness * beam.length**2 / beam.EI * basis.shear
    M = basis.mass + carried * np.outer(basis.tip, basis.tip)
    return np.asarray(linalg.eigh(K, M)[1][:, 0])


def pulled(name: str, link: ElasticLink, pull: Pull, shape: np.ndarray, stiffened: str) -> list[Range]:
    """Ranges of a link under an axial force; `shape` (n,) is that of its lowest mode."""
    if not len(shape):
        return []
    beam = link.beam
    force = pull.at_root(link)
    keeps = "an inextensible link misplaces its points by less than 1 % of the length"
    stretched = ca.fabs(force) / (beam.E * beam.area)
    found = [Range(f"axial strain of {name}", "1", STRETCH, keeps, f"{NONE_HOLDS} for arms", stretched)]
    if not link.stiffened:
        keeps = "leaving it out takes static deflections wrong by less than 5 %"
        share = ca.fabs(pull.stiffness(link, shape) / (2 * link.strain_energy(ca.SX(ca.DM(shape)))))
        quantity = f"stiffening of {name} by spin and weight over its bending stiffness"
        found.append(Range(quantity, "1", AXIAL, keeps, stiffened, share))
    return found


def pinned(name: str, rod: PinnedRod, e: ca.SX, force: ca.SX, large: str) -> list[Range]:
    """Ranges of a rod between pins at bending coordinates e (n,), under an axial force [N], positive in tension.

    Its lowest mode is a half-sine, for which int N u'^2/int E I u''^2 = N L^2/(pi^2 E I): N over Euler's load.
    """
    beam, stiffened = rod.beam, 'kinematics="stiffened"'
    found = small_slopes(name, rod.link, e, stiffened, large)
    keeps = "the rod's extension misplaces its points by less than 1 % of the length"
    stretched = ca.fabs(force) / (beam.E * beam.area)
    found.append(Range(f"axial strain of {name}", "1", STRETCH, keeps, NONE_HOLDS, stretched))
    if rod.link.basis.n and not rod.stiffened:
        keeps = "leaving it out takes static deflections wrong by less than 5 %"
        share = ca.fabs(force) * beam.length**2 / (np.pi**2 * beam.EI)
        found.append(Range(f"axial force of {name} over its buckling load", "1", AXIAL, keeps, stiffened, share))
    return found
