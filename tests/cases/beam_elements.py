"""Finite elements of a uniform clamped beam without dimension: what the closed forms are checked against.

Bending   Hermite cubics, unknowns (w, w') at each node; frequencies converge as h^4
Torsion   quadratics, unknowns at nodes and mid-points; frequencies converge as h^4
Shear     Timoshenko beam: cubics for w with slope unknowns, quadratics for the rotation psi, no locking; h^4
Scale     x in [0, 1]; omega^2 in E I/(rho A L^4). All matrices are for the clamped beam, tip unknowns last
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from pliant.plants.beams.offset_payload_roots import OffsetPayload
from pliant.plants.core.parameters import require_count

_POINT, _WEIGHT = np.polynomial.legendre.leggauss(5)
_S, _W = (1 + _POINT) / 2, _WEIGHT / 2


def _hermite(s: np.ndarray, h: float, derivative: int) -> np.ndarray:
    """d^derivative/dx^derivative of the four cubics at s = x/h (m,) -> (m, 4)."""
    cubics = np.array([[1, 0, -3, 2], [0, h, -2 * h, h], [0, 0, 3, -2], [0, 0, -h, h]])
    return _polynomials(cubics, s, h, derivative)


def _quadratic(s: np.ndarray, h: float, derivative: int) -> np.ndarray:
    """The same of the three quadratics of a node, the mid-point and the next node -> (m, 3)."""
    return _polynomials(np.array([[1, -3, 2], [0, 4, -4], [0, -1, 2]]), s, h, derivative)


def _polynomials(rows: np.ndarray, s: np.ndarray, h: float, derivative: int) -> np.ndarray:
    return np.stack([np.polynomial.Polynomial(c).deriv(derivative)(s) for c in rows], axis=-1) / h**derivative


@dataclass(frozen=True)
class Mesh:
    """Equal elements. `cubic` and `quadratic` are values at the integration points of all unknowns of one field."""

    elements: int

    def __post_init__(self) -> None:
        require_count("Mesh", "elements", self.elements, 1, 2000)

    @property
    def points(self) -> np.ndarray:
        """Integration points (m,)."""
        return ((np.arange(self.elements)[:, None] + _S) / self.elements).ravel()

    @property
    def weights(self) -> np.ndarray:
        """Integration weights (m,)."""
        return np.tile(_W / self.elements, self.elements)

    def cubic(self, derivative: int, clamped: bool = True) -> np.ndarray:
        """(m, unknowns): Hermite shapes of (w, w'), w(0) = 0 and, `clamped`, w'(0) = 0."""
        return self._field(_hermite, 2, 4, derivative)[:, 2 if clamped else 1 :]

    def quadratic(self, derivative: int) -> np.ndarray:
        """(m, unknowns): quadratic shapes, zero at x = 0."""
        return self._field(_quadratic, 2, 3, derivative)[:, 1:]

    def _field(
        self, shape: Callable[[np.ndarray, float, int], np.ndarray], step: int, size: int, derivative: int
    ) -> np.ndarray:
        value = shape(_S, 1 / self.elements, derivative)
        m = len(_S)
        full = np.zeros((m * self.elements, step * (self.elements - 1) + size))
        for e in range(self.elements):
            full[e * m : (e + 1) * m, e * step : e * step + size] = value
        return full

    def gram(self, a: np.ndarray, b: np.ndarray, weight: np.ndarray | float = 1.0) -> np.ndarray:
        """Integral of weight a b^T."""
        return a.T @ ((self.weights * weight)[:, None] * b)


def bending_torsion(system: OffsetPayload, elements: int) -> tuple[np.ndarray, np.ndarray]:
    """(K, M): bending and torsion with the offset payload; the eigenvalues are lambda^4."""
    mesh = Mesh(elements)
    bending = [mesh.gram(mesh.cubic(d), mesh.cubic(d)) for d in (2, 0)]
    torsion = [mesh.gram(mesh.quadratic(d), mesh.quadratic(d)) for d in (1, 0)]
    K = scipy.linalg.block_diag(bending[0], torsion[0] / system.chi**2)
    M = scipy.linalg.block_diag(bending[1], torsion[1] * system.mu**2)
    n = len(bending[0])
    tip = [n - 2, n - 1, len(K) - 1]
    M[np.ix_(tip, tip)] += system.tip_mass
    return K, M


def rotating(
    gamma: float,
    elements: int,
    *,
    plane: str = "lag",
    stiffened: bool = True,
    tip_mass: float = 0.0,
    tip_inertia: float = 0.0,
    hub_radius: float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """(K, M) of an Euler-Bernoulli beam that rotates at gamma; the arguments are those of rotating_frequencies."""
    mesh = Mesh(elements)
    value, slope, curvature = (mesh.cubic(d) for d in range(3))
    x = mesh.points
    M = mesh.gram(value, value)
    M[-2, -2] += tip_mass
    K = mesh.gram(curvature, curvature)
    if stiffened:
        tension = tip_mass * (hub_radius + 1) + (1 - x) * (hub_radius + (1 + x) / 2)
        K += gamma**2 * mesh.gram(slope, slope, tension)
    if plane == "lag":
        K -= gamma**2 * M
    M[-1, -1] += tip_inertia
    return K, M


def timoshenko(
    elements: int,
    *,
    gamma: float = 0.0,
    shear: float,
    rotary: float,
    tip_mass: float = 0.0,
    tip_inertia: float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """(K, M) of a Timoshenko beam turning at gamma in its plane; see rotating_frequencies. Unknowns (w, w'; psi).

    The span shortens by half of w'^2 - (w' - psi)^2, to second order.
    """
    mesh = Mesh(elements)
    w, slope, psi, bend = mesh.cubic(0, False), mesh.cubic(1, False), mesh.quadratic(0), mesh.quadratic(1)
    n = w.shape[1]
    strain, tension = np.hstack([slope, -psi]), gamma**2 * (tip_mass + (1 - mesh.points**2) / 2)
    K = mesh.gram(strain, strain, 1 / shear - tension)
    K[n:, n:] += mesh.gram(bend, bend)
    M = mesh.gram(w, w)
    M[-2, -2] += tip_mass
    K[:n, :n] += mesh.gram(slope, slope, tension) - gamma**2 * M
    turning = rotary * mesh.gram(psi, psi)
    turning[-1, -1] += tip_inertia
    return K, scipy.linalg.block_diag(M, turning)


def count_below(K: np.ndarray, M: np.ndarray, square: float) -> int:
    """How many eigenvalues of the pencil (K, M) lie below `square`: Sylvester's inertia of K - square M."""
    scale = 1 / np.sqrt(np.diag(K) + abs(square) * np.diag(M))
    return _negative_blocks(scipy.linalg.ldl((K - square * M) * scale * scale[:, None])[1])


def _negative_blocks(D: np.ndarray) -> int:
    """Negative eigenvalues of a block-diagonal matrix with 1 x 1 and 2 x 2 blocks."""
    negative, i = 0, 0
    while i < len(D):
        if i + 1 < len(D) and D[i + 1, i] != 0:
            negative += int(np.sum(np.linalg.eigvalsh(D[i : i + 2, i : i + 2]) < 0))
            i += 2
        else:
            negative += int(D[i, i] < 0)
            i += 1
    return negative


def lowest(K: np.ndarray, M: np.ndarray, n: int) -> np.ndarray:
    """The lowest n eigenvalues (n,) of the pencil; M positive definite.

    Where K is definite too they are the inverses of the largest of (M, K), whose rounding does not grow with
    the highest eigenvalue of the mesh.
    """
    try:
        largest = scipy.linalg.eigh(M, K, eigvals_only=True)[::-1][:n]
    except np.linalg.LinAlgError:
        return scipy.linalg.eigh(K, M, eigvals_only=True)[:n]
    return 1 / largest
