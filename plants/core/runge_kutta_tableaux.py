"""Explicit Runge-Kutta methods by their tableau: one step as a CasADi function, and the stability polynomial.

rk8   Dormand and Prince's twelve stages of order 8 without their error estimate; SciPy's DOP853 holds the coefficients
      (Hairer, Norsett and Wanner, "Solving Ordinary Differential Equations I", II.5)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from .signals import OwnsArrays

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Tableau(OwnsArrays):
    """k_i = f(t + c_i h, x + h sum_j A_ij k_j), x(t + h) = x + h sum_i b_i k_i: A (s, s) strictly lower, b, c (s,)."""

    A: Array
    b: Array
    c: Array

    @property
    def polynomial(self) -> Array:
        """R(z) = 1 + z b . (1 + A z + A^2 z^2 + ..), lowest power first, (s + 1,): x(t + h) = R(h lambda) x(t)."""
        power, found = np.ones(len(self.b)), [1.0]
        for _ in self.b:
            found.append(float(self.b @ power))
            power = self.A @ power
        return np.array(found)

    def stage(self, i: int) -> dict[int, float]:
        """Earlier stages that stage i takes, with their coefficients; i = s: those of the step."""
        row = self.b if i == len(self.b) else self.A[i]
        return {j: float(a) for j, a in enumerate(row) if a != 0.0}

    def step(self, name: str, f: ca.Function) -> ca.Function:
        """(t, x, us, w, p, h) -> x(t + h) for dx/dt = f(t, x, u, w, p); us (nu, s) the input at every stage."""
        nx, nu, nw, n_p = (f.size1_in(k) for k in range(1, 5))
        t, x, us = ca.MX.sym("t"), ca.MX.sym("x", nx), ca.MX.sym("us", nu, len(self.b))
        w, p, h = ca.MX.sym("w", nw), ca.MX.sym("p", n_p), ca.MX.sym("h")
        slopes: list[ca.MX] = []
        for i in range(len(self.b) + 1):
            taken = self.stage(i)
            at = x + h * ca.horzcat(*[slopes[j] for j in taken]) @ list(taken.values()) if taken else x
            if i < len(self.b):
                slopes.append(f(t + float(self.c[i]) * h, at, us[:, i], w, p))
        return ca.Function(name, [t, x, us, w, p, h], [at])


@lru_cache(maxsize=1)
def rk8() -> Tableau:
    """The tableau of order 8."""
    from scipy.integrate import DOP853

    return Tableau(DOP853.A[:12, :12], DOP853.B, DOP853.C[:12])


@lru_cache(maxsize=1)
def rk4() -> Tableau:
    """Kutta's classical method."""
    A = np.diag([0.5, 0.5, 1.0], -1)
    return Tableau(A, np.array([1.0, 2.0, 2.0, 1.0]) / 6, np.array([0.0, 0.5, 0.5, 1.0]))


TABLEAUS: dict[str, Callable[[], Tableau]] = {"rk4": rk4, "rk8": rk8}
