"""A clamped beam in bending (x-y) and torsion that carries a rigid payload with an offset mass centre.

V'''' = lambda^4 V and Gamma'' = -kappa^2 Gamma on xi = x/L in [0, 1], kappa = lambda^2 chi mu,
lambda^4 = rho A L^4 omega^2/(E I). The payload couples them at the tip through its mass matrix on (V, V', Gamma).
All roots are found by counting, so that none is missed, whether roots are close, double or crossing.

Source   "On the dynamic modelling of flexible manipulators", section 3: Eq (7) as printed, times e^-lambda; (9)-(12)
         corrected: see PayloadModes. For a section that is not circular mu^2 = (I_y + I_z)/(A L^2), chi^2 = EI/(GJ)
         with J the torsion constant
Valid    bending about z only; small deflection, no gravity
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from pliant.plants.modes import (
    LARGEST_RATIO,
    MOST_MODES,
    _columns,
    _products,
    checked_position,
    count_loaded,
    quadrature,
    roots,
)
from pliant.plants.parameters import require_count

if TYPE_CHECKING:
    from pliant.plants.beams import Beam, Payload

SECTIONS = 16  # of an interval in each step of the search
SAME = 1e-9  # relative distance of roots that share one space of shapes


@dataclass(frozen=True, kw_only=True)
class OffsetPayload:
    """A beam and its payload in numbers without dimension.

    mass = m/(rho A L), offset = o/L, inertia about the mass centre over rho A L^3: one number for every axis, a
    3 x 3 tensor, or the paper's (I_xx, I_zz, I_xz) with I_xz = + integral of x z dm. chi^2 = EI/(GJ),
    mu^2 = polar moment/(A L^2).
    """

    mass: float = 0.0
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: Any = 0.0
    chi: float = 1.0
    mu: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "offset", tuple(float(a) for a in self.offset))
        for name, value in (("mass", self.mass), ("chi", self.chi), ("mu", self.mu)):
            low = 0 if name == "mass" else 1e-12
            if not low <= value <= LARGEST_RATIO:
                raise ValueError(
                    f"OffsetPayload.{name} = {value!r} must be within [{low:g}, {LARGEST_RATIO:g}]"
                )
        if len(self.offset) != 3 or not np.all(np.isfinite(self.offset)):
            raise ValueError(f"OffsetPayload.offset = {self.offset!r} must be three finite numbers")
        I_xx, I_zz, I_xz = self.moments
        if not (0 <= I_xx <= LARGEST_RATIO and 0 <= I_zz <= LARGEST_RATIO):
            raise ValueError(
                f"OffsetPayload.inertia = {self.inertia!r} must have moments within [0, {LARGEST_RATIO:g}]"
            )
        if not I_xz**2 <= I_xx * I_zz * (1 + 1e-12):
            raise ValueError(
                f"OffsetPayload.inertia = {self.inertia!r} must have I_xz within +-sqrt(I_xx I_zz)"
            )

    @classmethod
    def of(cls, beam: Beam, payload: Payload) -> Self:
        """From a beam and a payload with dimensions."""
        scale = beam.mass * beam.length**2
        return cls(
            mass=payload.mass / beam.mass,
            offset=tuple(o / beam.length for o in payload.offset),  # type: ignore[arg-type]
            inertia=np.asarray(payload.inertia, dtype=float) / scale,
            chi=math.sqrt(beam.EI / beam.GJ),
            mu=math.sqrt(beam.polar_moment / beam.area) / beam.length,
        )

    @property
    def moments(self) -> tuple[float, float, float]:
        """(I_xx, I_zz, I_xz) about the mass centre."""
        given = np.asarray(self.inertia, dtype=float)
        if not np.all(np.isfinite(given)):
            raise ValueError(f"OffsetPayload.inertia = {self.inertia!r} must be finite")
        if given.shape == ():
            return float(given), float(given), 0.0
        if given.shape == (3,):
            return float(given[0]), float(given[1]), float(given[2])
        if given.shape != (3, 3):
            raise ValueError(f"OffsetPayload.inertia = {self.inertia!r} must be a number, three or 3 x 3")
        return float(given[0, 0]), float(given[2, 2]), -float(given[0, 2])

    @property
    def tip_mass(self) -> np.ndarray:
        """Mass matrix (3, 3) of the payload on the tip's (V, V', Gamma)."""
        (I_xx, I_zz, I_xz), (ax, ay, az), m = self.moments, self.offset, self.mass
        about_z, about_x = I_zz + m * (ax**2 + ay**2), I_xx + m * (ay**2 + az**2)
        product = I_xz + m * ax * az
        return np.array(
            [[m, m * ax, -m * az], [m * ax, about_z, -product], [-m * az, -product, about_x]]
        )

    def equation(self, lam: np.ndarray) -> np.ndarray:
        """Eq (7) times e^-lambda and a positive factor: zero at the roots, finite for any lambda (...,)."""
        determinant, turning = self._terms(np.asarray(lam, dtype=float))
        return determinant * turning

    def count(self, lam: np.ndarray) -> np.ndarray:
        """How many roots lie below each lambda (...,), by Wittrick and Williams: exact, close pairs included.

        The dynamic stiffness of the tip is reduced from bending to torsion: the bending of the loaded beam is
        counted as in `modes`, and what is left of torsion, its stiffness less the bending's share, is one number.
        """
        lam = np.asarray(lam, dtype=float)
        M, kappa = self.tip_mass, lam**2 * self.chi * self.mu
        _, turning = self._terms(lam)
        nearest = np.rint(kappa / math.pi)
        sine = np.sin(kappa)
        passed = (sine >= 0) == (nearest % 2 == 0)  # the sign of the sine decides here as below
        clamped = np.where(nearest > 0, nearest - 1 + passed, 0).astype(int)
        left = turning * np.where(sine >= 0, 1.0, -1.0) < 0
        return count_loaded(lam, M[0, 0], M[1, 1], M[0, 1]) + clamped + left

    def _terms(self, lam: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(determinant of bending alone, sin(kappa) times torsion's stiffness left): their product is Eq (7)."""
        M, kappa = self.tip_mass, lam**2 * self.chi * self.mu
        plus_one, pole, plus, minus, sin_sinh = _products(lam)
        determinant = (
            plus_one
            - M[0, 0] * lam * minus
            - M[1, 1] * lam**3 * plus
            - 2 * M[0, 1] * lam**2 * sin_sinh
            + (M[0, 0] * M[1, 1] - M[0, 1] ** 2) * lam**4 * pole
        )
        share = (  # coupling . adjugate of the bending part . coupling
            M[0, 2] ** 2 * (lam * minus - lam**4 * M[1, 1] * pole)
            + 2 * M[0, 2] * M[1, 2] * (lam**2 * sin_sinh + lam**4 * M[0, 1] * pole)
            + M[1, 2] ** 2 * (lam**3 * plus - lam**4 * M[0, 0] * pole)
        )
        safe = np.where(determinant == 0, np.finfo(float).tiny, determinant)
        with np.errstate(over="ignore"):
            inertia = lam**4 * (M[2, 2] + np.where(share == 0, 0.0, share / safe))
        return determinant, kappa * np.cos(kappa) / self.chi**2 - np.sin(kappa) * inertia

    def roots(self, n: int) -> np.ndarray:
        """The lowest n roots lambda (n,), equal ones repeated."""
        require_count("clamped_payload_roots", "n", n, 0, MOST_MODES)
        return self._section(np.arange(1, n + 1))

    def roots_between(self, low: float, high: float) -> np.ndarray:
        """All roots lambda in [low, high)."""
        if not 0 <= low < high < math.inf:
            raise ValueError(f"roots_between: [{low!r}, {high!r}) must have 0 <= low < high")
        first, last = (int(k) for k in self.count(np.array([max(low, 1e-300), high])))
        if last > MOST_MODES:
            raise ValueError(f"roots_between: high = {high!r} has {last} roots below it, at most {MOST_MODES}")
        return self._section(np.arange(first + 1, last + 1))

    def _section(self, k: np.ndarray) -> np.ndarray:
        """Roots number k (ascending, from 1) by section on their count.

        Brackets: the payload lowers every root of the bare beam; clamping the tip adds three constraints;
        Dunkerley's bound with the tip's static compliances lies below the first.
        """
        n = int(k[-1]) if len(k) else 0
        bare, held = self._uncoupled(n, "clamped-free", 0.5), self._uncoupled(n, "clamped-clamped", 1.0)
        M = self.tip_mass
        load = M[0, 0] / 3 + abs(M[0, 1]) + M[1, 1] + self.chi**2 * M[2, 2]
        lowest = 0.999 * (bare[:1] ** -4.0 + load) ** -0.25 if n else np.zeros(1)
        upper, lower = 1.001 * bare, np.full(n, lowest[0])
        lower[3:] = np.maximum(lower[3:], 0.999 * held[: max(n - 3, 0)])
        lower, upper = lower[k - 1], upper[k - 1]
        cuts = np.arange(1, SECTIONS) / SECTIONS
        for _ in range(40):
            inner = lower[:, None] + (upper - lower)[:, None] * cuts
            below = np.sum(self.count(inner) < k[:, None], axis=1)
            edges = np.column_stack([lower, inner, upper])
            lower, upper = edges[np.arange(len(k)), below], edges[np.arange(len(k)), below + 1]
            if np.all(upper - lower <= 4e-16 * upper):
                break
        return 0.5 * (lower + upper)

    def _uncoupled(self, n: int, boundary: str, start: float) -> np.ndarray:
        """The lowest n of bending roots with this boundary and torsion roots kappa = (k + start) pi, k >= 0."""
        torsion = np.sqrt(math.pi * (np.arange(n) + start) / (self.chi * self.mu))
        return np.sort(np.concatenate([roots(boundary, n), torsion]))[:n]

    def shapes(self, n: int) -> PayloadModes:
        """The lowest n mode shapes, orthonormal as in Eq (12)."""
        lam = self.roots(n)
        coefficients = np.zeros((n, 5))
        i = 0
        while i < n:
            j = i + 1
            while j < n and j < i + 3 and lam[j] - lam[i] <= SAME * lam[i]:
                j += 1
            coefficients[i:j] = _orthonormal(self, lam[i:j])
            i = j
        for array in (lam, coefficients):
            array.setflags(write=False)
        return PayloadModes(self, lam, coefficients)


@dataclass(frozen=True, eq=False)
class PayloadModes:
    """Modes (V_k, Gamma_k) with roots lambda (n,) and coefficients (n, 5): four terms of V as in `modes`, one of Gamma.

    Orthonormal as Eq (12) corrected (mu^2 on torsion, minus on the a_z and I_xz couplings):
    int (V_r V_s + mu^2 G_r G_s) dxi + tip_r . M_tip tip_s = delta_rs with tip = (V, V', Gamma) at 1, and
    int (V_r'' V_s'' + G_r' G_s'/chi^2) dxi = lambda^4 delta_rs. Signs: V''(0) > 0, or Gamma'(0) > 0 where a mode
    twists only.
    """

    system: OffsetPayload
    roots: np.ndarray
    coefficients: np.ndarray = field(repr=False)

    def bending(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """d^derivative V/dxi^derivative at xi (...,) in [0, 1] -> (..., n)."""
        columns = _columns(self.roots, checked_position(xi, derivative), derivative)
        return sum(c * a for c, a in zip(columns, self.coefficients.T[:4], strict=True))

    def torsion(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """d^derivative Gamma/dxi^derivative at xi (...,) in [0, 1] -> (..., n)."""
        return self.coefficients[:, 4] * _twist(
            self.system, self.roots, checked_position(xi, derivative), derivative
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


def _twist(system: OffsetPayload, lam: np.ndarray, xi: np.ndarray, derivative: int) -> np.ndarray:
    """Derivatives of sin(kappa xi)/min(kappa, 1) (..., n)."""
    kappa = lam**2 * system.chi * system.mu
    phase = kappa * xi[..., None]
    wave = (np.sin, np.cos)[derivative % 2](phase) * (-1) ** (derivative // 2)
    return kappa**derivative * wave / np.minimum(kappa, 1.0)


def _orthonormal(system: OffsetPayload, lam: np.ndarray) -> np.ndarray:
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


def clamped_payload_roots(
    n: int,
    *,
    mass: float = 0.0,
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0),
    inertia: Any = 0.0,
    chi: float,
    mu: float,
) -> np.ndarray:
    """The lowest n roots lambda (n,), none missed, of a clamped beam with an offset payload; see OffsetPayload."""
    return OffsetPayload(mass=mass, offset=offset, inertia=inertia, chi=chi, mu=mu).roots(n)
