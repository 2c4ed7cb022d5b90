"""Shape functions for a Ritz beam: a named kind, how many, and every integral that a plant needs of them.

Kinds   natural modes for a pair of ends, "payload" (clamped, loaded tip), "pinned-payload", "polynomial" (clamped),
        "tip-force" and "hinged-tip-force" (polynomials too, see `legendre_ritz.tip_force`)
Shear   the clamped kinds also for Timoshenko beams, see `legendre_ritz`
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from pliant.plants.core.argument_gates import require_number
from pliant.plants.core.parameters import require_choice, require_count
from pliant.plants.core.signals import OwnsArrays

from .euler_bernoulli_modes import (
    BOUNDARIES,
    LARGEST_RATIO,
    LOADED,
    MOST_MODES,
    ModeShapes,
    checked_position,
    quadrature,
    shapes,
)
from .legendre_ritz import StrainShapes, matrices, polynomial, tip_force
from .legendre_ritz import modes as timoshenko_modes

TIP_FORCE = ("tip-force", "hinged-tip-force")
BASES = (*BOUNDARIES, *LOADED, "polynomial", *TIP_FORCE)
SHEARABLE = ("clamped-free", "payload", "polynomial")
MOST_SHEARABLE = 40
MOST_STRETCHES = 4
MOST_POLYNOMIALS = 30  # their highest frequency grows as n^4, that of modes as n^2


@dataclass(frozen=True)
class Polynomials:
    """Orthonormal polynomials spanning xi^2 .. xi^(n + 1), phi''(0) > 0.

    phi_k = (-1)^k sqrt(2 k + 5) xi^2 P_k^(0,4)(2 xi - 1), k from 0: the weight xi^4 of these Jacobi
    polynomials is the square of the factor xi^2. Monomials would lose all digits at about n = 12.
    """

    n: int

    def __post_init__(self) -> None:
        require_count("Polynomials", "n", self.n, 0, MOST_POLYNOMIALS)

    def __call__(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """d^derivative phi / dxi^derivative at xi (...,) in [0, 1] -> (..., n); derivative 0 to 4."""
        xi = checked_position(xi, derivative)
        value = np.zeros((*xi.shape, self.n))
        for taken in range(min(2, derivative) + 1):  # Leibniz: derivatives taken by xi^2
            factor = np.asarray(math.comb(derivative, taken) * math.perm(2, taken) * xi ** (2 - taken))
            value += factor[..., None] * _jacobi(self.n, 4, xi, derivative - taken)
        k = np.arange(self.n)
        return value * (-1.0) ** k * np.sqrt(2 * k + 5)


def _jacobi(n: int, b: int, xi: np.ndarray, derivative: int) -> np.ndarray:
    """d^derivative/dxi^derivative of P_k^(0,b)(2 xi - 1), k < n -> (..., n), by the three-term recurrence.

    The derivative of P_k^(0,b) is (k + b + 1)(k + b + 2).. P_(k-d)^(d,b+d) (Abramowitz and Stegun 22.7.1,
    22.8.1).
    """
    a, b, x = derivative, b + derivative, 2 * xi - 1
    value = np.zeros((*xi.shape, n))
    before, now = np.zeros_like(x), np.ones_like(x)
    for k in range(n - derivative):
        rise = math.perm(k + a + b, derivative)  # (k + b + 1) .. (k + b + derivative)
        value[..., k + derivative] = rise * now
        s = 2 * k + a + b
        c1 = 2 * (k + 1) * (k + a + b + 1) * s
        c2 = (s + 1) * (a * a - b * b + s * (s + 2) * x)
        c3 = 2 * (k + a) * (k + b) * (s + 2)
        before, now = now, (c2 * now - c3 * before) / c1
    return value


@dataclass(frozen=True, eq=False)
class Basis(OwnsArrays):
    """n shape functions phi_k(xi), xi = x/L in [0, 1], and their integrals over xi. All dimensionless.

    With w(x, t) = sum of phi_k(x/L) q_k(t): kinetic energy rho A L/2 q'^T mass q', strain energy
    EI/(2 L^3) q^T stiffness q, shortening of the span up to xi 1/(2 L) q^T S(xi) q with S the integral of
    phi' phi'^T from 0 to xi.

    A Timoshenko beam's section turns by psi, not by phi'. Then tip_slope is psi(1), stiffness int psi' psi'^T, the
    shortening is that of `legendre_ritz.matrices`, strain energy has kappa G A/(2 L) q^T shear q more and kinetic
    energy rho I/(2 L) q'^T rotary q' more. These fields are None without shear.
    """

    kind: str
    phi: ModeShapes | Polynomials | StrainShapes  # phi(xi, derivative=0) -> (..., n)
    tip: np.ndarray  # phi(1), (n,)
    tip_slope: np.ndarray  # dphi/dxi at 1, (n,)
    mass: np.ndarray = field(repr=False)  # int phi phi^T, (n, n)
    stiffness: np.ndarray = field(repr=False)  # int phi'' phi''^T, (n, n)
    first: np.ndarray = field(repr=False)  # int phi, (n,)
    moment: np.ndarray = field(repr=False)  # int xi phi, (n,)
    shortening: np.ndarray = field(repr=False)  # S(1), (n, n)
    shortening_mean: np.ndarray = field(repr=False)  # int S(xi) = int (1 - xi) phi' phi'^T, (n, n)
    shortening_moment: np.ndarray = field(repr=False)  # int xi S(xi) = int (1 - xi^2)/2 phi' phi'^T, (n, n)
    shear: np.ndarray | None = field(default=None, repr=False)  # int (phi' - psi)(phi' - psi)^T, (n, n)
    rotary: np.ndarray | None = field(default=None, repr=False)  # int psi psi^T, (n, n)
    rotary_first: np.ndarray | None = field(default=None, repr=False)  # int psi, (n,)
    stretch: np.ndarray | None = field(default=None, repr=False)  # int u' u'^T, (n, n), of axial displacements u
    along: np.ndarray | None = field(default=None, repr=False)  # int u u^T, (n, n)

    @property
    def n(self) -> int:
        """How many shape functions."""
        return len(self.tip)


def basis(
    kind: str,
    n: int,
    *,
    tip_mass_ratio: float = 0.0,
    tip_inertia_ratio: float = 0.0,
    tip_coupling_ratio: float = 0.0,
    rotary: float = 0.0,
    shear: float = 0.0,
    stretches: int = 0,
) -> Basis:
    """The first n shape functions of a kind in BASES, each scaled to int phi^2 dxi = 1. Cached.

    tip_mass_ratio, mass/(rho A L), tip_inertia_ratio, inertia about the tip/(rho A L^3), and tip_coupling_ratio, mass
    times the offset of its centre along the beam/(rho A L^2), shape the kinds of a payload and of a tip force; others
    ignore them. `shear` = E I/(kappa G A L^2) > 0 makes a Timoshenko beam with `rotary` = I/(A L^2); with it,
    `stretches` more shapes stretch the beam's axis and do nothing else. ValueError for another kind, n above 200 (30
    for polynomials, 40 with shear), or a ratio outside [0, 1e12].

    Example
    -------
    >>> basis("clamped-free", 2).tip.round(4)
    array([ 2., -2.])
    """
    require_choice("basis", "kind", kind, BASES)
    n = require_count("basis", "n", n, 0, MOST_POLYNOMIALS if kind in ("polynomial", *TIP_FORCE) else MOST_MODES)
    for name, value in (("tip_mass_ratio", tip_mass_ratio), ("tip_inertia_ratio", tip_inertia_ratio)):
        require_number(f"basis.{name}", value, least=0.0, most=LARGEST_RATIO)
    require_number("basis.tip_coupling_ratio", tip_coupling_ratio)
    for name, value in (("rotary", rotary), ("shear", shear)):
        require_number(f"basis.{name}", value, least=0.0, most=10.0)
    if shear:
        require_choice("basis", "kind", kind, SHEARABLE)
        n = require_count("basis", "n", n, 0, MOST_SHEARABLE)
    tip = (float(tip_mass_ratio), float(tip_inertia_ratio), float(tip_coupling_ratio))
    tip = tip if kind in (*LOADED, *TIP_FORCE) else (0.0, 0.0, 0.0)
    stretches = require_count("basis", "stretches", stretches, 0, MOST_STRETCHES if shear else 0)
    if shear:
        return _sheared(kind, int(n), float(rotary), float(shear), *tip, stretches)
    return _basis(kind, int(n), *tip)


@lru_cache(maxsize=128)
def _basis(kind: str, n: int, mass: float, inertia: float, coupling: float) -> Basis:
    phi: ModeShapes | Polynomials | StrainShapes
    if kind in ("polynomial", *TIP_FORCE):
        phi = Polynomials(n) if kind == "polynomial" else tip_force(n, kind != "tip-force", mass, inertia, coupling)
        most = n + 3 if kind == "polynomial" else n + 5  # exact to degree 2 most - 1; the integrands reach 2 most - 2
        x, w = np.polynomial.legendre.leggauss(most)
        xi, w = (1 + x) / 2, w / 2
    else:
        phi = shapes(kind, n, mass=mass, inertia=inertia, coupling=coupling)
        xi, w = quadrature(n)
    value, slope, curvature = (phi(xi, d) for d in range(3))

    def gram(f: np.ndarray, weight: np.ndarray) -> np.ndarray:
        product = f.T @ (weight[:, None] * f)
        return (product + product.T) / 2

    if isinstance(phi, ModeShapes) and kind not in LOADED:  # orthogonal: no rounding where theory has a zero
        products, stiffness = np.eye(n), np.diag(phi.roots**4)
    else:
        products = np.eye(n) if kind == "polynomial" else gram(value, w)
        stiffness = gram(curvature, w)
    built = Basis(
        kind=kind,
        phi=phi,
        tip=phi(1.0),
        tip_slope=phi(1.0, 1),
        mass=products,
        stiffness=stiffness,
        first=w @ value,
        moment=(w * xi) @ value,
        shortening=gram(slope, w),
        shortening_mean=gram(slope, w * (1 - xi)),
        shortening_moment=gram(slope, w * (1 - xi**2) / 2),
    )
    return _read_only(built)


@lru_cache(maxsize=128)
def _sheared(
    kind: str, n: int, rotary: float, shear: float, mass: float, inertia: float, coupling: float, stretches: int
) -> Basis:
    if kind == "polynomial":
        phi = polynomial(n, rotary, shear)
    else:
        phi = timoshenko_modes(n, rotary, shear, mass, inertia, coupling)
    axial: dict[str, np.ndarray] = {}
    if stretches:
        phi = phi.stretched(stretches)
        longer = np.eye(stretches, n + stretches, n)
        alone = matrices(StrainShapes(np.zeros((0, n + stretches)), longer))  # u as the deflection of shear alone
        axial = {"stretch": alone.shearing, "along": alone.mass}
    found = matrices(phi)
    x, w = np.polynomial.legendre.leggauss(max(len(phi.curvature), len(phi.shear)) + 4)
    xi, w = (1 + x) / 2, w / 2
    return _read_only(
        Basis(
            kind=kind,
            phi=phi,
            tip=phi(1.0),
            tip_slope=phi.rotation(1.0),
            mass=found.mass,
            stiffness=found.bending,
            first=w @ phi(xi),
            moment=(w * xi) @ phi(xi),
            shortening=found.tension_uniform,
            shortening_mean=found.tension_hub,
            shortening_moment=found.tension_beam,
            shear=found.shearing,
            rotary=found.rotary,
            rotary_first=w @ phi.rotation(xi),
            **axial,
        )
    )


def _read_only(built: Basis) -> Basis:
    for name in Basis.__dataclass_fields__:
        if isinstance(array := getattr(built, name), np.ndarray):
            array.setflags(write=False)
    return built
