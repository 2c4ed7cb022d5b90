"""A slender rod pinned at both ends: its shape functions and its energies in the frame of its chord.

Frame   origin at the first pin, x along the chord to the second pin, so that no deflection is left at the pins
Point   x = L xi of the straight rod stands at (x + a - s, u): deflection u = phi(xi) . e, extension
        a = psi(xi) . b, shortening s = (1/2) int_0^x u'^2 dx
Kinds   "pinned-pinned": closed-form modes for u and natural modes of the rod with a tip mass for a;
        "frame-elements": cubic (u) and linear (a) finite elements, e the nodes' slopes times L and deflections
Source  planar frame elements as in "Elastodynamic Analysis of a Mechanism with Flexible Links", Eqs (41), (48),
        element 2 with its own shape functions. Terms of third order (a s and a' s') are left out of T.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, cast

import casadi as ca
import numpy as np

from pliant.plants.core.signals import OwnsArrays

from .elastic_link import ElasticLink
from .euler_bernoulli_modes import checked_position, quadrature
from .section import Beam
from .shape_functions import Basis, basis

KINDS = ("pinned-pinned", "frame-elements")
MOST_ELEMENTS = 20
Shapes = Callable[..., np.ndarray]  # (xi (...), derivative) -> (..., n)


@dataclass(frozen=True)
class HermiteShapes:
    """Cubic elements of equal length between pins: (slope 0, deflection 1, slope 1, .., slope n), slopes times L."""

    elements: int

    def __call__(self, xi: Any, derivative: int = 0) -> np.ndarray:
        """d^derivative phi / dxi^derivative at xi (...,) in [0, 1] -> (..., 2 elements); derivative 0 to 2."""
        xi, n = checked_position(xi, derivative), self.elements
        k = np.clip(np.floor(xi * n).astype(int), 0, n - 1)
        s = xi * n - k
        cubic = np.array([[1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]], dtype=float)
        powers = np.stack(
            [np.prod(np.arange(j, j - derivative, -1.0)) * s ** max(j - derivative, 0) for j in range(4)], axis=-1
        )
        local = n**derivative * powers @ cubic.T / np.array([1.0, n, 1.0, n])
        value = np.zeros((*xi.shape, 2 * n + 2))  # deflection and slope of every node
        for j in range(4):
            np.put_along_axis(value, 2 * k[..., None] + j, local[..., j : j + 1], axis=-1)
        return np.delete(value, [0, 2 * n], axis=-1)  # no deflection at the pins


@dataclass(frozen=True)
class HatShapes:
    """Linear elements of equal length, fixed at the first pin: displacements of nodes 1 .. n."""

    elements: int

    def __call__(self, xi: Any, derivative: int = 0) -> np.ndarray:
        """psi or dpsi/dxi at xi (...,) in [0, 1] -> (..., elements)."""
        xi, n = checked_position(xi, derivative), self.elements
        if derivative == 0:
            return np.maximum(0.0, 1 - np.abs(xi[..., None] * n - np.arange(1, n + 1)))
        k = np.clip(np.floor(xi * n).astype(int), 0, n - 1)[..., None] + 1
        node = np.arange(1, n + 1)
        return n * ((node == k).astype(float) - (node == k - 1))


@dataclass(frozen=True, eq=False)
class AxialModes:
    """sin(beta xi): modes of a rod fixed at one end, with `ratio` rods' mass at the other: cot beta = ratio beta."""

    n: int
    ratio: float

    @property
    def roots(self) -> np.ndarray:
        """The lowest n roots beta (n,), one in each ((k - 1) pi, (k - 1/2) pi], by bisection."""
        low = np.pi * np.arange(self.n)
        high = low + np.pi / 2
        for _ in range(80):
            middle = (low + high) / 2
            below = np.cos(middle) * (-1.0) ** np.arange(self.n) > self.ratio * middle * np.abs(np.sin(middle))
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return (low + high) / 2

    def __call__(self, xi: Any, derivative: int = 0) -> np.ndarray:
        """psi or dpsi/dxi at xi (...,) in [0, 1] -> (..., n), scaled to 1 where it is largest."""
        beta, xi = self.roots, checked_position(xi, derivative)[..., None]
        return beta * np.cos(beta * xi) if derivative else np.sin(beta * xi)


@dataclass(frozen=True, eq=False)
class RodShapes(OwnsArrays):
    """Shape functions of a pinned rod and their integrals over xi, all dimensionless."""

    kind: str
    bending: Basis
    psi: Shapes
    mass: np.ndarray = field(repr=False)  # int psi psi^T
    stiffness: np.ndarray = field(repr=False)  # int psi' psi'^T
    cross: np.ndarray = field(repr=False)  # int psi phi^T
    first: np.ndarray = field(repr=False)  # int psi
    moment: np.ndarray = field(repr=False)  # int xi psi
    tip: np.ndarray = field(repr=False)  # psi(1)
    mid: np.ndarray = field(repr=False)  # psi(1/2)
    mid_deflection: np.ndarray = field(repr=False)  # phi(1/2)
    mid_shortening: np.ndarray = field(repr=False)  # int_0^(1/2) phi' phi'^T


@lru_cache(maxsize=64)
def rod_shapes(kind: str, n: int, axial: int = 0, tip_mass_ratio: float = 0.0) -> RodShapes:
    """Shapes of `n` modes and `axial` axial modes, or of `n` frame elements. Cached.

    `tip_mass_ratio`: mass at the second pin over that of the rod, for the axial modes.
    """
    psi: Shapes
    if kind == "frame-elements":
        x, w = np.polynomial.legendre.leggauss(8)
        cells = 2 * max(n, 1)  # an even number: the rod's middle is an edge
        xi = ((np.arange(cells)[:, None] + (1 + x) / 2) / cells).ravel()
        weight = np.tile(w / (2 * cells), cells)
        psi = HatShapes(n)
        bending = _hermite_basis(HermiteShapes(n), xi, weight)
    else:
        bending = basis("pinned-pinned", n)
        psi = AxialModes(axial, tip_mass_ratio)
        xi, weight = quadrature(max(n, axial))
    phi = cast(Shapes, bending.phi)
    half, half_weight = quadrature(max(n, axial))
    if kind == "frame-elements":
        half, half_weight = xi, weight
    slope = phi(half / 2, 1)
    a, slope_a = psi(xi), psi(xi, 1)
    return RodShapes(
        kind=kind,
        bending=bending,
        psi=psi,
        mass=a.T @ (weight[:, None] * a),
        stiffness=slope_a.T @ (weight[:, None] * slope_a),
        cross=a.T @ (weight[:, None] * phi(xi)),
        first=weight @ a,
        moment=(weight * xi) @ a,
        tip=psi(1.0),
        mid=psi(0.5),
        mid_deflection=phi(0.5),
        mid_shortening=slope.T @ (half_weight[:, None] * slope) / 2,
    )


def _hermite_basis(phi: HermiteShapes, xi: np.ndarray, w: np.ndarray) -> Basis:
    value, slope, curvature = (phi(xi, d) for d in range(3))

    def gram(f: np.ndarray, weight: np.ndarray) -> np.ndarray:
        return f.T @ (weight[:, None] * f)

    return Basis(
        kind="frame-elements",
        phi=cast(Any, phi),
        tip=phi(1.0),
        tip_slope=phi(1.0, 1),
        mass=gram(value, w),
        stiffness=gram(curvature, w),
        first=w @ value,
        moment=(w * xi) @ value,
        shortening=gram(slope, w),
        shortening_mean=gram(slope, w * (1 - xi)),
        shortening_moment=gram(slope, w * (1 - xi**2) / 2),
    )


@dataclass(frozen=True)
class PinnedRod:
    """A beam between two pins; `stiffened` keeps the second-order shortening."""

    beam: Beam
    shapes: RodShapes
    stiffened: bool

    @property
    def link(self) -> ElasticLink:
        """Its bending part."""
        return ElasticLink(self.beam, self.shapes.bending, self.stiffened)

    def chord(self, e: ca.SX, b: ca.SX) -> ca.SX:
        """Distance between the pins [m]."""
        return self.beam.length + _dot(self.shapes.tip, b) - self.link.shortening(e)

    def middle(self, e: ca.SX, b: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Displacement (along, across) [m] of the rod's middle in its frame."""
        along = _dot(self.shapes.mid, b)
        if self.stiffened:
            along = along - _form(e, self.shapes.mid_shortening, e) / (2 * self.beam.length)
        return along, _dot(self.shapes.mid_deflection, e)

    def centre(self, e: ca.SX, b: ca.SX) -> tuple[ca.SX, ca.SX]:
        """First moment (x, y) [kg m] in its frame."""
        x, y = self.link.centre(e)
        return x + self.beam.mass * _dot(self.shapes.first, b), y

    def kinetic_energy(
        self, root: tuple[ca.SX, ca.SX], omega: ca.SX, e: ca.SX, b: ca.SX, de: ca.SX, db: ca.SX
    ) -> ca.SX:
        """T [J]; velocity of the first pin (x, y) [m/s] in the rod's axes, rate of its frame omega [rad/s]."""
        m, L, s = self.beam.mass, self.beam.length, self.shapes
        T = self.link.kinetic_energy(root, omega, e, de)
        if not len(s.tip):
            return T
        return T + m * (
            _form(db, s.mass, db) / 2
            + omega**2 * _form(b, s.mass, b) / 2
            + root[0] * _dot(s.first, db)
            + root[1] * omega * _dot(s.first, b)
            + omega * (_form(b, s.cross, de) - _form(db, s.cross, e))
            + omega**2 * L * _dot(s.moment, b)
        )

    def strain_energy(self, e: ca.SX, b: ca.SX) -> ca.SX:
        """(1/2) int E I u''^2 + E A a'^2 dx [J]."""
        axial = self.beam.E * self.beam.area / self.beam.length
        return self.link.strain_energy(e) + axial * _form(b, self.shapes.stiffness, b) / 2

    def dissipation(self, de: ca.SX, db: ca.SX) -> ca.SX:
        """Rayleigh function [W] of the Kelvin-Voigt damping."""
        return self.beam.damping * self.strain_energy(de, db)


def _dot(a: np.ndarray, q: ca.SX) -> ca.SX:
    return ca.dot(ca.DM(a), q) if len(a) else ca.SX(0)


def _form(a: ca.SX, S: np.ndarray, b: ca.SX) -> ca.SX:
    """a . S b for a constant S of any shape: entries that are rounding are left out."""
    if not S.size:
        return ca.SX(0)
    tidy = np.where(np.abs(S) > 1e-14 * np.abs(S).max(), S, 0.0)
    return ca.dot(a, ca.sparsify(ca.DM(tidy)) @ b)
