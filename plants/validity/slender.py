"""Ranges of beams that bend little: Euler-Bernoulli with small slopes, with ("stiffened") or without ("linear") the
second-order shortening.

Slope       A deflection u(s) over arc length bends by u''/sqrt(1 - u'^2), so that the strain energy (1/2) int E I u''^2
            leaves out the share e = int u''^2 u'^2/int u''^2 of itself, and elastic forces err by 2 e to first order.
            With theta the largest slope, 2 e = 0.46 theta^2 under a force at the tip, 0.41 under a uniform load, 0.5 of
            a half-sine between pins. SLOPE = 0.3 keeps that below 5 %: a cantilever's tip at a fifth of its length,
            where the elastica (K. E. Bisshopp and D. C. Drucker, 1945) has 0.1923 L for 0.2 L, 4.0 %. A deflection errs
            by as much where bending alone resists; where compression leaves 1 - c of the stiffness, by 1/(1 - c) times.
Shortening  "linear" leaves out s = (1/2) int u'^2, by which the tip stands too far out: SHORTENING is 1 % of L.
Axial load  "linear" leaves out the work (1/2) int N u'^2 of the axial force N on it, the geometric stiffness. Of no
            shape is it a larger share of the bending stiffness int E I u''^2 than of the one that N buckles: |N| over
            the buckling load. A static deflection errs by it where N pulls and by c/(1 - c) where N pushes, a frequency
            by its half; the load may suit another shape by a tenth better: AXIAL = 4.5 % keeps 5 %. The spin Omega of a
            cantilever has 1.2 (Omega/omega_1)^2 (Southwell), so that the range ends at a fifth of its first frequency.
            N is that of the straight link under spin, weight and tip force; accelerations of its root are not counted.
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
AXIAL = 0.045  # of the buckling load
STRETCH = 0.01  # strain
STATIONS = np.linspace(0.0, 1.0, 9)  # where slopes are looked at: shapes of up to eight half-waves show theirs
NONE_HOLDS = "no kinematics of this library"
STIFFENED = 'kinematics="stiffened"'


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

    def over_buckling(self, link: ElasticLink, numbers: ElasticLink) -> ca.SX:
        """Each of the three forces over what of it alone, pushing, buckles the link; their sum, below 0 in compression.

        `numbers`: the link with numbers for its parameters.
        """
        m, L, own = link.beam.mass, link.beam.length, numbers.basis
        mean, moment, whole = (
            buckling(numbers, S) for S in (own.shortening_mean, own.shortening_moment, own.shortening)
        )
        forces = m * (self.uniform * mean + self.growing * L * moment) + self.tip * whole
        return forces * L**2 / link.beam.EI


def buckling(link: ElasticLink, S: np.ndarray) -> float:
    """Largest q.S q/q.K q with K the stiffness in units of E I/L^3: E I/L^2 over the force that buckles the link."""
    beam, basis = link.beam, link.basis
    K = basis.stiffness
    if basis.shear is not None:
        K = K + beam.shear_stiffness * beam.length**2 / beam.EI * basis.shear
    return float(linalg.eigh(S, K, eigvals_only=True)[-1])


def slopes(link: ElasticLink, q: ca.SX) -> ca.SX:
    """The largest |u'| of a link [rad]; with shear the largest of u' and of the sections' turn."""
    phi = link.basis.phi
    rows = [phi(STATIONS, 1)] + ([phi.rotation(STATIONS)] if isinstance(phi, StrainShapes) else [])
    return largest(np.concatenate(rows), q) / link.beam.length


def shortening(link: ElasticLink, q: ca.SX) -> ca.SX:
    """int u'^2/2 over the length, whether the link keeps it or not."""
    S = link.basis.shortening
    return ca.dot(q, ca.sparsify(ca.DM(S)) @ q) / (2 * link.beam.length**2)


def small_slopes(name: str, link: ElasticLink, q: ca.SX, large: str) -> list[Range]:
    """Ranges that hold however the link moves; `large`: the kinematics beyond small slopes."""
    if not link.basis.n:
        return []
    keeps = "elastic forces err by less than 5 %"
    found = [Range(f"slope of {name}", "rad", SLOPE, keeps, large, slopes(link, q))]
    if not link.stiffened:
        keeps = "leaving it out misplaces the tip by less than 1 % of the length"
        value = shortening(link, q)
        found.append(Range(f"shortening of {name} over its length", "1", SHORTENING, keeps, STIFFENED, value))
    return found


def pulled(name: str, link: ElasticLink, numbers: ElasticLink, pull: Pull) -> list[Range]:
    """Ranges of a clamped link under an axial force; `numbers`: the link with numbers for its parameters."""
    if not link.basis.n:
        return []
    keeps = "an inextensible link misplaces its points by less than 1 % of the length"
    stretched = ca.fabs(pull.at_root(link)) / (link.beam.E * link.beam.area)
    found = [Range(f"axial strain of {name}", "1", STRETCH, keeps, f"{NONE_HOLDS} for arms", stretched)]
    return found if link.stiffened else [*found, _axial(name, ca.fabs(pull.over_buckling(link, numbers)))]


def pinned(name: str, rod: PinnedRod, e: ca.SX, force: ca.SX, large: str) -> list[Range]:
    """Ranges of a rod between pins at bending coordinates e (n,), under an axial force [N], positive in tension."""
    beam = rod.beam
    found = small_slopes(name, rod.link, e, large)
    keeps = "the rod's extension misplaces its points by less than 1 % of the length"
    stretched = ca.fabs(force) / (beam.E * beam.area)
    found.append(Range(f"axial strain of {name}", "1", STRETCH, keeps, NONE_HOLDS, stretched))
    if rod.link.basis.n and not rod.stiffened:
        found.append(_axial(name, ca.fabs(force) * beam.length**2 / (np.pi**2 * beam.EI)))  # Euler's load
    return found


def _axial(name: str, value: ca.SX) -> Range:
    keeps = "leaving out the stiffening by it takes static deflections wrong by less than 5 %"
    return Range(f"axial force of {name} over its buckling load", "1", AXIAL, keeps, STIFFENED, value)
