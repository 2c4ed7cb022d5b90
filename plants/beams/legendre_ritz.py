"""Shape functions of a clamped beam from Legendre polynomials of its strains: for shear, fast spin and a tip force.

psi' = curvature and w' - psi = shear strain are each a sum of orthonormal Legendre polynomials, so that both
stiffness matrices are identities, nothing locks, and any number of shapes keeps its digits. Without shear
psi = w'. Few of them, for a plant, are made orthogonal in mass and in stiffness, see `polynomial`.

Scale    x in [0, 1], w in lengths of the beam; omega^2 in E I/(rho A L^4)
         rotary = I/(A L^2), shear = E I/(kappa G A L^2), tip mass/(rho A L), tip inertia/(rho A L^3)
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from pliant.plants.core.imports import linalg
from pliant.plants.core.parameters import require_count
from pliant.plants.core.signals import OwnsArrays

from .euler_bernoulli_modes import checked_position

MOST = 120  # strain polynomials of one kind
SLIGHT = 1e-5  # of omega^2: what shapes of shear alone may bring and yet be left out


def enough(n: int) -> int:
    """Polynomials that resolve n modes: a wave takes about pi of them, and the ends some more."""
    return min(MOST, 16 + math.ceil(1.7 * n))


@lru_cache(maxsize=32)
def _integrals(n: int) -> tuple[np.ndarray, ...]:
    """Legendre coefficients (n + 2, n) on [0, 1] of e_k' , e_k, int e_k and int int e_k from 0; e_k orthonormal."""
    size = n + 2
    value = np.zeros((size, n))
    value[np.arange(n), np.arange(n)] = np.sqrt(2 * np.arange(n) + 1)
    found = [value]
    for _ in range(2):
        # The integral of P_k from -1 is (P_(k+1) - P_(k-1))/(2 k + 1), of P_0 it is P_0 + P_1; dx = ds/2.
        c = found[-1] / 2 / (2 * np.arange(size)[:, None] + 1)
        up = np.zeros_like(c)
        up[1:] += c[:-1]
        up[:-1] -= c[1:]
        up[0] += c[0]
        found.append(up)
    slope = np.polynomial.legendre.legder(value, scl=2.0) if n else value
    slope = np.vstack([slope, np.zeros((size - len(slope), n))])
    return (slope, *found)


@dataclass(frozen=True, eq=False)
class StrainShapes(OwnsArrays):
    """Shapes (w_k, psi_k) whose curvatures and shear strains have Legendre coefficients (a, n) and (b, n).

    With `stretch` (c, n) also those of their axial strains, of shapes that neither bend nor shear.
    """

    curvature: np.ndarray = field(repr=False)
    shear: np.ndarray = field(repr=False)
    stretch: np.ndarray | None = field(default=None, repr=False)

    @classmethod
    def unit(cls, a: int, b: int = 0) -> StrainShapes:
        """The a + b shapes with one strain coefficient each."""
        a = require_count("StrainShapes", "a", a, 0, MOST)
        b = require_count("StrainShapes", "b", b, 0, MOST)
        return cls(np.eye(a, a + b), np.eye(b, a + b, a))

    def combined(self, coefficients: np.ndarray) -> StrainShapes:
        """The shapes (columns of `coefficients`) made of these."""
        return StrainShapes(self.curvature @ coefficients, self.shear @ coefficients)

    def _sum(self, xi: np.ndarray, bent: int | None, sheared: int | None) -> np.ndarray:
        """Integral number bent - 1 (0: derivative) of the curvatures plus that of the shear strains, (..., n)."""
        total: Any = 0.0
        for coefficients, order in ((self.curvature, bent), (self.shear, sheared)):
            if order is not None and len(coefficients):
                table = _integrals(len(coefficients))[order]
                values = np.polynomial.legendre.legvander(2 * xi - 1, len(table) - 1)
                total = total + values.reshape(*xi.shape, -1) @ (table @ coefficients)
        return total + np.zeros((*xi.shape, self.curvature.shape[1]))

    def __call__(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """d^derivative w/dx^derivative at xi (...,) in [0, 1] -> (..., n); derivative 0 to 2."""
        derivative = require_count("shape", "derivative", derivative, 0, 2)
        return self._sum(checked_position(xi, derivative), 3 - derivative, 2 - derivative)

    def rotation(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """d^derivative psi/dx^derivative, the turn of the section; derivative 0 or 1."""
        derivative = require_count("rotation", "derivative", derivative, 0, 1)
        return self._sum(checked_position(xi, derivative), 2 - derivative, None)

    def shear_strain(self, xi: float | np.ndarray) -> np.ndarray:
        """w' - psi."""
        return self._sum(checked_position(xi, 0), None, 1)

    def stretched(self, count: int) -> StrainShapes:
        """These shapes and `count` more, whose axial strains are orthonormal polynomials."""
        n = self.curvature.shape[1]
        bent, sheared = (np.pad(a, ((0, 0), (0, count))) for a in (self.curvature, self.shear))
        return StrainShapes(bent, sheared, np.eye(count, n + count, n))

    def axial_strain(self, xi: float | np.ndarray) -> np.ndarray | None:
        """du/dx at xi (...,), (..., n); None of shapes that do not stretch."""
        if self.stretch is None:
            return None
        own = StrainShapes(self.stretch, np.zeros((0, self.stretch.shape[1])))
        return own._sum(checked_position(xi, 0), 1, None)


@dataclass(frozen=True, eq=False)
class Matrices(OwnsArrays):
    """Integrals of strain shapes, each (n, n). tension_* are those of N w'^2 - N (w' - psi)^2, see `matrices`."""

    bending: np.ndarray  # int psi' psi'^T
    shearing: np.ndarray  # int (w' - psi)(w' - psi)^T
    mass: np.ndarray  # int w w^T
    rotary: np.ndarray  # int psi psi^T
    tension_uniform: np.ndarray  # N = 1
    tension_hub: np.ndarray  # N = 1 - x
    tension_beam: np.ndarray  # N = (1 - x^2)/2


def matrices(shapes: StrainShapes) -> Matrices:
    """All matrices, by a Gauss rule exact for these polynomials.

    A span shortens by half of w'^2 - (w' - psi)^2 = psi^2 + 2 psi (w' - psi) to second order: a section turned by
    psi carries the shear sideways. The paper's Eq (13) has w'^2 alone, right for thin beams.
    """
    size = max(len(shapes.curvature), len(shapes.shear))
    x, w = np.polynomial.legendre.leggauss(size + 4)
    x, w = (1 + x) / 2, w / 2
    value, slope, psi, gamma = shapes(x), shapes(x, 1), shapes.rotation(x), shapes.shear_strain(x)

    def gram(f: np.ndarray, weight: np.ndarray) -> np.ndarray:
        product = f.T @ (weight[:, None] * f)
        return (product + product.T) / 2

    def tension(weight: np.ndarray) -> np.ndarray:
        return gram(slope, w * weight) - gram(gamma, w * weight)

    return Matrices(
        bending=shapes.curvature.T @ shapes.curvature,  # of orthonormal polynomials
        shearing=shapes.shear.T @ shapes.shear,
        mass=gram(value, w),
        rotary=gram(psi, w),
        tension_uniform=tension(np.ones_like(x)),
        tension_hub=tension(1 - x),
        tension_beam=tension((1 - x**2) / 2),
    )


@lru_cache(maxsize=64)
def modes(
    n: int, rotary: float, shear: float, tip_mass: float, tip_inertia: float, coupling: float = 0.0
) -> StrainShapes:
    """The lowest n modes of the clamped, loaded Timoshenko beam, int w^2 dx = 1, psi'(0) > 0.

    `coupling`: mass times its offset along the beam/(rho A L^2), with tip_inertia about the tip.
    """
    size = enough(n)
    trial = StrainShapes.unit(size, size)
    found = matrices(trial)
    tip, turn = trial(1.0), trial.rotation(1.0)
    M = found.mass + rotary * found.rotary + tip_mass * np.outer(tip, tip) + tip_inertia * np.outer(turn, turn)
    both = coupling * np.outer(tip, turn)
    M = M + both + both.T
    stiffness = np.concatenate([np.ones(size), np.full(size, 1 / shear)])
    scale = 1 / np.sqrt(stiffness)
    _, vectors = linalg.eigh(M * scale * scale[:, None])
    return normalised(trial.combined(scale[:, None] * vectors[:, ::-1][:, :n]))


def normalised(shapes: StrainShapes) -> StrainShapes:
    """The same shapes with int w^2 dx = 1 and psi'(0) > 0 (w'(0) > 0 where it is pure shear)."""
    n = shapes.curvature.shape[1]
    start = shapes.rotation(0.0, 1) if len(shapes.curvature) else np.zeros(n)
    sign = np.where(start == 0, 1.0, np.sign(start))
    return shapes.combined(np.diag(sign / np.sqrt(np.diag(matrices(shapes).mass))))


def shear_alone(n: int, rotary: float, shear: float) -> int:
    """How many of n shapes bend nothing: two of five, none where they would bring less than SLIGHT.

    The balanced curvatures leave out the shear -shear rotary omega^2 psi of sections that swing, and with it the share
    shear rotary^2 omega^4/beta^2, omega = beta^2, of omega^2: counted for the mode n/4, beta = pi n/4, about the last
    that n polynomials resolve well. On slender beams such shapes bring nothing but frequencies of 1/(shear rotary),
    beside which the first, 12.4, loses its digits; curvatures in their place bring more.
    """
    swings = shear * rotary**2 * (math.pi * n / 4) ** 6
    return 2 * (n - 2) // 5 if n > 2 and swings > SLIGHT else 0


def balanced(n: int, rotary: float, shear: float) -> StrainShapes:
    """n shapes: curvatures of rising degree with the shear that balances them, then those of shear alone.

    A section without rotary inertia is at rest where M' + Q = 0: its shear strain is -shear psi''. What rotary inertia
    changes of that the shapes of shear alone make up for, so that the whole converges to Timoshenko's beam.
    """
    sheared = shear_alone(n, rotary, shear)
    curved = n - sheared
    slope = _integrals(curved)[0]  # of the curvatures, by Legendre polynomials that are not normalised
    b = max(sheared, curved)
    balance = -shear * slope[:b] / np.sqrt(2 * np.arange(b) + 1)[:, None]
    alone = np.eye(b, sheared)
    return StrainShapes(np.eye(curved, n), np.hstack([balance, alone]))


@lru_cache(maxsize=64)
def polynomial(n: int, rotary: float, shear: float) -> StrainShapes:
    """The natural modes, lowest first, that a bare clamped beam has in the space of `balanced` shapes.

    As they stand those are nearly dependent, their mass matrix as ill-conditioned as 1/shear. From QR of the strains
    and the singular values 1/omega of the motion beside them, not from matrices, whose condition is the square.
    """
    raw = balanced(n, rotary, shear)
    if not n:
        return raw
    x, w = np.polynomial.legendre.leggauss(max(len(raw.curvature), len(raw.shear)) + 4)
    xi, w = (1 + x) / 2, np.sqrt(w / 2)[:, None]
    strain = np.vstack([raw.curvature, raw.shear / math.sqrt(shear)])
    unit = np.linalg.norm(strain, axis=0)
    motion = np.vstack([w * raw(xi), math.sqrt(rotary) * w * raw.rotation(xi)]) / unit
    R = np.asarray(np.linalg.qr(strain / unit, mode="r"))
    _, _, modes = np.linalg.svd(np.linalg.solve(R.T, motion.T).T, full_matrices=False)
    return normalised(raw.combined(np.linalg.solve(R, modes.T) / unit[:, None]))


def tip_force(
    n: int, hinged: bool, tip_mass: float = 0.0, tip_inertia: float = 0.0, coupling: float = 0.0
) -> StrainShapes:
    """n shapes that serve a force at the tip, without shear: the natural modes in the space of curvatures that vanish
    at a tip free to turn, and at the root if it is `hinged`.

    A tip force bends a beam by a moment that is zero at the tip, straight or bent: 1 - x of a straight one, the shape
    when there is one alone. Natural modes sum that as 1/n^3, polynomials exactly. Where a payload resists turning
    curvatures need not vanish at the tip. int w^2 dx = 1, psi'(0) > 0 (psi(1) > 0 where `hinged`).
    """
    free = tip_inertia == 0 and coupling == 0
    ends = [-1.0] * hinged + [1.0] * (free or n == 1)
    k = np.arange(n + len(ends))
    at = np.array([np.sqrt(2 * k + 1) * end**k for end in ends]).reshape(len(ends), len(k))
    raw = np.linalg.qr(at.T, mode="complete").Q[:, len(ends) :]
    trial = StrainShapes(raw, np.zeros((0, n)))
    tip, turn = trial(1.0), trial.rotation(1.0)
    both = coupling * np.outer(tip, turn)
    M = matrices(trial).mass + tip_mass * np.outer(tip, tip) + tip_inertia * np.outer(turn, turn) + both + both.T
    _, modes = np.linalg.eigh(M)  # where stiffness is 1 mass is 1/omega^2
    shapes = trial.combined(modes[:, ::-1])
    size = np.sqrt(np.diag(matrices(shapes).mass))
    size = np.copysign(size, shapes.rotation(1.0) if hinged else shapes.rotation(0.0, 1))
    return shapes.combined(np.diag(1 / size))
