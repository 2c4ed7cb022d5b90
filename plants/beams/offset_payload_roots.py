"""A clamped beam in bending (x-y) and torsion that carries a rigid payload with an offset mass centre.

V'''' = lambda^4 V and Gamma'' = -kappa^2 Gamma on xi = x/L in [0, 1], kappa = lambda^2 chi mu,
lambda^4 = rho A L^4 omega^2/(E I). The payload couples them at the tip through its mass matrix on (V, V', Gamma).
All roots are found by counting, so that none is missed, whether roots are close, double or crossing.

Source   "On the dynamic modelling of flexible manipulators", section 3: Eq (7) as printed, times e^-lambda; (9)-(12)
         corrected: see `offset_payload_modes`. For a section that is not circular mu^2 = (I_y + I_z)/(A L^2),
         chi^2 = EI/(GJ) with J the torsion constant
Valid    bending about z only; small deflection, no gravity
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from pliant.plants.core.argument_gates import finite_array, real_array, require_finite, require_instance, require_number
from pliant.plants.core.parameters import require_count

from .euler_bernoulli_modes import LARGEST_RATIO, MOST_MODES, _products, count_loaded, roots
from .offset_payload_modes import PayloadModes, payload_modes
from .payload import Payload
from .section import Beam

SECTIONS = 16  # of an interval in each step of the search


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
        for name, low in (("mass", 0.0), ("chi", 1e-12), ("mu", 1e-12)):
            value = require_number(f"OffsetPayload.{name}", getattr(self, name), least=low, most=LARGEST_RATIO)
            object.__setattr__(self, name, value)
        offset = require_finite("OffsetPayload.offset", self.offset, (3,))
        if np.abs(offset).max() > LARGEST_RATIO:
            raise ValueError(f"OffsetPayload.offset = {offset.tolist()} must be within +-{LARGEST_RATIO:g}")
        object.__setattr__(self, "offset", tuple(offset.tolist()))
        I_xx, I_zz, I_xz = self.moments
        if not (0 <= I_xx <= LARGEST_RATIO and 0 <= I_zz <= LARGEST_RATIO):
            raise ValueError(
                f"OffsetPayload.inertia = {self.inertia!r} must have moments within [0, {LARGEST_RATIO:g}]"
            )
        if not I_xz**2 <= I_xx * I_zz * (1 + 1e-12):
            raise ValueError(f"OffsetPayload.inertia = {self.inertia!r} must have I_xz within +-sqrt(I_xx I_zz)")

    @classmethod
    def of(cls, beam: Beam, payload: Payload) -> Self:
        """From a beam and a payload with dimensions."""
        require_instance("OffsetPayload.beam", beam, Beam)
        require_instance("OffsetPayload.payload", payload, Payload)
        scale = beam.mass * beam.length**2
        return cls(
            mass=payload.mass / beam.mass,
            offset=tuple(o / beam.length for o in payload.offset),
            inertia=np.asarray(payload.inertia, dtype=float) / scale,
            chi=math.sqrt(beam.EI / beam.GJ),
            mu=math.sqrt(beam.polar_moment / beam.area) / beam.length,
        )

    @property
    def moments(self) -> tuple[float, float, float]:
        """(I_xx, I_zz, I_xz) about the mass centre.

        Dimensionless; ValueError where the inertia is no number, three or 3 x 3.
        """
        given = real_array("OffsetPayload.inertia", self.inertia)
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
        return np.array([[m, m * ax, -m * az], [m * ax, about_z, -product], [-m * az, -product, about_x]])

    def equation(self, lam: np.ndarray) -> np.ndarray:
        """Eq (7) times e^-lambda and a positive factor: zero at the roots, finite for any lambda, lam (...,).

        It is dimensionless.
        """
        determinant, turning = self._terms(finite_array("OffsetPayload.equation.lam", lam))
        return determinant * turning

    def count(self, lam: np.ndarray) -> np.ndarray:
        """How many roots lie below each lambda, lam (...,), by Wittrick and Williams: exact, close pairs included.

        The dynamic stiffness of the tip is reduced from bending to torsion: the bending of the loaded beam is
        counted as in `euler_bernoulli_modes`, and what is left of torsion, its stiffness less the bending's share, is
        one number. lambda is dimensionless.
        """
        lam = finite_array("OffsetPayload.count.lam", lam)
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
        n = require_count("clamped_payload_roots", "n", n, 0, MOST_MODES)
        return self._section(np.arange(1, n + 1))

    def roots_between(self, low: float, high: float) -> np.ndarray:
        """All roots lambda in [low, high).

        (n,), dimensionless. ValueError where the range is empty or holds too many.
        """
        low, high = (require_number(f"roots_between.{k}", v) for k, v in (("low", low), ("high", high)))
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
        return payload_modes(self, self.roots(n))


def clamped_payload_roots(
    n: int,
    *,
    mass: float = 0.0,
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0),
    inertia: Any = 0.0,
    chi: float,
    mu: float,
) -> np.ndarray:
    """The lowest n roots lambda (n,), none missed, of a clamped beam with an offset payload; see OffsetPayload.

    inertia: (I_xx, I_zz, I_xz) about its mass centre over rho A L^3, one number for the first two alike.

    Example
    -------
    >>> clamped_payload_roots(2, mass=1.0, chi=1.1, mu=0.05).round(4)
    array([1.2479, 4.0311])
    """
    return OffsetPayload(mass=mass, offset=offset, inertia=inertia, chi=chi, mu=mu).roots(n)
