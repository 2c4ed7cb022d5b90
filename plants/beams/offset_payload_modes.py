"""Mode shapes of a clamped beam in bending and torsion with an offset payload; its roots are in `offset_payload_roots`.

The printed cosh and sinh shapes, Eqs (9)-(11) corrected, lose all digits by mode 15 and are 0/0 where bending and
torsion do not couple. Here the coefficients are null vectors of the end conditions on functions that stay bounded.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from pliant.plants.core.signals import OwnsArrays

from .euler_bernoulli_modes import _columns, checked_position, quadrature

SAME = 1e-9  # relative distance of roots that share one space of shapes


class CoupledBeam(Protocol):
    """What couples bending and torsion, in numbers without dimension: an `OffsetPayload`."""

    @property
    def chi(self) -> float:
        """chi^2 = EI/(GJ)."""

    @property
    def mu(self) -> float:
        """mu^2 = polar moment/(A L^2)."""

    @property
    def tip_mass(self) -> np.ndarray:
        """The payload's mass matrix (3, 3) on (V, V', Gamma) at the tip."""


@dataclass(frozen=True, eq=False)
class PayloadModes(OwnsArrays):
    """Modes (V_k, Gamma_k) with roots lambda (n,) and coefficients (n, 5): four terms of V, one of Gamma.

    V as in `euler_bernoulli_modes`.

    Orthonormal as Eq (12) corrected (mu^2 on torsion, minus on the a_z and I_xz couplings):
    int (V_r V_s + mu^2 G_r G_s) dxi + tip_r . M_tip tip_s = delta_rs with tip = (V, V', Gamma) at 1, and
    int (V_r'' V_s'' + G_r' G_s'/chi^2) dxi = lambda^4 delta_rs. Signs: V''(0) > 0, or Gamma'(0) > 0 where a mode
    twists only.
    """

    system: CoupledBeam
    roots: np.ndarray
    coefficients: np.ndarray = field(repr=False)

    def bending(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """d^derivative V/dxi^derivative at xi (...,) in [0, 1] -> (..., n)."""
        columns = _columns(self.roots, checked_position(xi, derivative), int(derivative))
        return sum(c * a for c, a in zip(columns, self.coefficients.T[:4], strict=True))

    def torsion(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """d^derivative Gamma/dxi^derivative at xi (...,) in [0, 1] -> (..., n)."""
        return self.coefficients[:, 4] * _twist(
            self.system, self.roots, checked_position(xi, derivative), int(derivative)
        )

    @property
    def mass(self) -> np.ndarray:
        """Eq (12): modal masses (n, n), the identity to rounding."""
        tip = np.stack([self.bending(1.0), self.bending(1.0, 1), self.torsion(1.0)])
        xi, w = self._rule
        V, G = self.bending(xi), self.torsion(xi)
        beam = V.T @ (w[:, None] * V) + self.system.mu**2 * G.T @ (w[:, None] * G)
        return beam + tip.T @ self.system.tip_mass @ tip

    @property
    def stiffness(self) -> np.ndarray:
        """Modal stiffnesses (n, n), diag(lambda^4) to rounding."""
        xi, w = self._rule
        V, G = self.bending(xi, 2), self.torsion(xi, 1)
        return V.T @ (w[:, None] * V) + G.T @ (w[:, None] * G) / self.system.chi**2

    @property
    def torsion_share(self) -> np.ndarray:
        """Share (n,) of each mode's strain energy that is torsion."""
        xi, w = self._rule
        return w @ self.torsion(xi, 1) ** 2 / self.system.chi**2 / self.roots**4

    @property
    def _rule(self) -> tuple[np.ndarray, np.ndarray]:
        largest = np.max(np.maximum(self.roots, self.roots**2 * self.system.chi * self.system.mu), initial=1.0)
        return quadrature(math.ceil(largest / math.pi) + 1)


def payload_modes(system: CoupledBeam, lam: np.ndarray) -> PayloadModes:
    """The orthonormal modes that belong to the system's ascending roots lambda (n,), equal ones repeated."""
    n = len(lam)
    coefficients = np.zeros((n, 5))
    i = 0
    while i < n:
        j = i + 1
        while j < n and j < i + 3 and lam[j] - lam[i] <= SAME * lam[i]:
            j += 1
        coefficients[i:j] = _orthonormal(system, lam[i:j])
        i = j
    for array in (lam, coefficients):
        array.setflags(write=False)
    return PayloadModes(system, lam, coefficients)


def _twist(system: CoupledBeam, lam: np.ndarray, xi: np.ndarray, derivative: int) -> np.ndarray:
    """Derivatives of sin(kappa xi)/min(kappa, 1) (..., n)."""
    kappa = lam**2 * system.chi * system.mu
    phase = kappa * xi[..., None]
    wave = (np.sin, np.cos)[derivative % 2](phase) * (-1) ** (derivative // 2)
    return kappa**derivative * wave / np.minimum(kappa, 1.0)


def _orthonormal(system: CoupledBeam, lam: np.ndarray) -> np.ndarray:
    """Coefficients (m, 5) of the modes with the m nearly equal roots lam.

    The null space of the end conditions V = V' = 0 at 0 and V''' = -lambda^4 (M tip)_1, V'' = lambda^4 (M tip)_2,
    Gamma'/chi^2 = lambda^4 (M tip)_3 at 1, by singular values; then made orthonormal in mass and stiffness.
    The row of torsion is scaled by the size of its terms, as its sum may vanish.
    """
    m, at = len(lam), np.full(1, lam.mean())
    zero, one = np.zeros(()), np.ones(())
    at_0 = [np.append(np.stack(_columns(at, zero, d))[:, 0], 0.0) for d in range(2)]
    at_1 = [np.append(np.stack(_columns(at, one, d))[:, 0], 0.0) for d in range(4)]
    twist = [np.append(np.zeros(4), _twist(system, at, one, d)) for d in range(2)]
    load = at**4 * (system.tip_mass @ np.stack([at_1[0], at_1[1], twist[0]]))
    ends = np.stack([*at_0, at_1[3] + load[0], at_1[2] - load[1], twist[1] / system.chi**2 - load[2]])
    terms = np.abs(ends).max(axis=1)
    swing = max(1.0, float(at[0] ** 2 * system.chi * system.mu)) / system.chi**2
    terms[4] = max(terms[4], swing, at[0] ** 4 * system.tip_mass[2, 2])
    ends /= terms[:, None]
    columns = np.append(np.abs(ends[:, :4]).max(axis=0), 1.0)
    null = np.linalg.svd(ends / columns)[2][5 - m :] / columns
    trial = PayloadModes(system, np.repeat(at, m), null)
    scale = np.sqrt(np.diag(trial.mass))
    trial = dataclasses.replace(trial, coefficients=null / scale[:, None])
    basis = np.linalg.inv(np.linalg.cholesky(trial.mass))
    _, turn = np.linalg.eigh(basis @ trial.stiffness @ basis.T)
    found = turn.T @ basis @ trial.coefficients
    modes = dataclasses.replace(trial, coefficients=found)
    sign = np.where(modes.torsion_share > 1 - 1e-6, modes.torsion(0.0, 1), modes.bending(0.0, 2))
    return found * np.where(sign < 0, -1.0, 1.0)[:, None]
