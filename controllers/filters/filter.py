"""A linear filter of one signal, and Tustin's rule with prewarping.

    x' = A x + B v, y = C x + D v,  x' the rate, or the next sample where dt is given

Sampled by s = c (z - 1)/(z + 1), c = 2/dt, or c = w/tan(w dt/2), under which the sampled filter has at the frequency w
what the continuous one has there: a notch stays where it is (Franklin, Powell, Workman, "Digital Control of Dynamic
Systems", Section 6.1). The frequencies above pi/dt are folded into the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self, final

import numpy as np

from pliant.plants.core.argument_gates import (
    real_array,
    require_finite,
    require_instance,
    require_number,
    require_seconds,
)
from pliant.plants.core.signals import OwnsArrays, read_only

Array = np.ndarray


@final
@dataclass(frozen=True, eq=False)
class Filter(OwnsArrays):
    """Of one signal, by its matrices. `frequency` [rad/s]: where a sampled form is to be exact; None: at zero."""

    A: Array  # (m, m)
    B: Array  # (m, 1)
    C: Array  # (1, m)
    D: Array  # (1, 1)
    dt: float | None = None  # [s]
    frequency: float | None = None

    def __post_init__(self) -> None:
        m = len(require_finite("Filter.A", self.A, (-1, -1)))
        for name, shape in (("A", (m, m)), ("B", (m, 1)), ("C", (1, m)), ("D", (1, 1))):
            object.__setattr__(self, name, read_only(f"Filter.{name}", getattr(self, name), shape))
        if self.dt is not None:
            object.__setattr__(self, "dt", require_seconds("Filter.dt", self.dt))
        if self.frequency is not None:
            own = require_number("Filter.frequency", self.frequency, "positive", "rad/s")
            object.__setattr__(self, "frequency", own)

    @classmethod
    def from_coefficients(
        cls, numerator: Any, denominator: Any, *, dt: float | None = None, frequency: float | None = None
    ) -> Self:
        """Polynomials numerator (m,) over denominator (n,) in s (in z where dt is given), highest power first, m <= n.

        dt: sampling time [s]; frequency: where it is warped least [rad/s]. ValueError where it is not proper.
        """
        top = require_finite("Filter.numerator", numerator, (-1,))
        bottom = require_finite("Filter.denominator", denominator, (-1,))
        if not len(bottom) or bottom[0] == 0 or not 0 < len(top) <= len(bottom):
            raise ValueError(
                f"Filter.denominator = {bottom.tolist()} must begin with a number that is not 0, and be of no lower "
                f"degree than the numerator {top.tolist()}"
            )
        m = len(bottom) - 1
        a, b = bottom[1:] / bottom[0], np.concatenate([np.zeros(len(bottom) - len(top)), top]) / bottom[0]
        A = np.eye(m, k=-1)
        A[:1] = -a
        C = (b[1:] - b[0] * a)[None]
        return cls(A, np.eye(m, 1), C, np.array([[b[0]]]), dt, frequency)

    @property
    def poles(self) -> Array:
        """Eigenvalues of A (n,) [rad/s], of a sampled one in the z plane."""
        return np.linalg.eigvals(self.A).astype(complex)

    def at(self, omega: Any) -> Array:
        """Its transfer (k,) at frequencies omega (k,) [rad/s].

        ValueError where omega is not a list of finite frequencies.
        """
        omega = np.atleast_1d(real_array("Filter.at: omega", omega))
        if omega.ndim != 1 or not np.isfinite(omega).all():
            raise ValueError(f"Filter.at: omega of shape {omega.shape} must be (k,) finite frequencies [rad/s]")
        s = 1j * omega if self.dt is None else np.exp(1j * omega * self.dt)
        inner = s[:, None, None] * np.eye(len(self.A)) - self.A
        return np.asarray((self.C @ np.linalg.solve(inner, self.B + 0j * inner[:, :, :1]))[:, 0, 0] + self.D[0, 0])

    def discretised(self, dt: float, *, prewarp: float | None = None) -> Filter:
        """By Tustin's rule, exact at `prewarp` [rad/s]; None: at the filter's own `frequency`, at zero without one.

        ValueError where the filter is sampled already, or the frequency is not below pi/dt.
        """
        dt = require_seconds("Filter.discretised.dt", dt)
        if self.dt is not None:
            raise ValueError(f"Filter.discretised: the filter is sampled already, dt = {self.dt} must be None")
        at = self.frequency if prewarp is None else require_number("Filter.prewarp", prewarp, "positive", "rad/s")
        if at is not None and not at * dt < np.pi:
            raise ValueError(
                f"Filter.discretised: {at:.4g} rad/s must be below pi/dt = {np.pi / dt:.4g} rad/s: sample faster"
            )
        c = 2 / dt if at is None else at / np.tan(at * dt / 2)
        inverse = np.linalg.inv(c * np.eye(len(self.A)) - self.A)
        A, root = inverse @ (c * np.eye(len(self.A)) + self.A), np.sqrt(2 * c)
        return Filter(A, root * inverse @ self.B, root * self.C @ inverse, self.D + self.C @ inverse @ self.B, dt, at)

    def then(self, other: Filter) -> Filter:
        """This filter, then the other. ValueError where their dt differ."""
        require_instance("Filter.then", other, Filter)
        if self.dt != other.dt:
            raise ValueError(f"Filter.then: dt = {other.dt} must be the first one's, {self.dt}")
        n, m = len(self.A), len(other.A)
        A = np.block([[self.A, np.zeros((n, m))], [other.B @ self.C, other.A]])
        B = np.vstack([self.B, other.B @ self.D])
        return Filter(A, B, np.hstack([other.D @ self.C, other.C]), other.D @ self.D, self.dt)
