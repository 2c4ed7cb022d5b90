"""Explicit Runge-Kutta methods by their tableau: one step as a CasADi function, and the stability polynomial.

rk8   Dormand and Prince's twelve stages of order 8; with the estimates of its error beside it the pair 8(5,3) of
      DOP853, whose coefficients these are (Hairer, Norsett and Wanner, "Solving Ordinary Differential Equations I",
      II.5 and II.10)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from .signals import OwnsArrays

Array = np.ndarray
_DOP853_C = (
    0.0,
    0.05260015195876773,
    0.0789002279381516,
    0.1183503419072274,
    0.2816496580927726,
    1 / 3,
    1 / 4,
    4 / 13,
    0.6512820512820513,
    3 / 5,
    6 / 7,
    1.0,
)
_DOP853_A: tuple[dict[int, float], ...] = (  # of each stage: {earlier stage: coefficient}
    {},
    {0: 0.05260015195876773},
    {0: 0.0197250569845379, 1: 0.0591751709536137},
    {0: 0.02958758547680685, 2: 0.08876275643042054},
    {0: 0.2413651341592667, 2: -0.8845494793282861, 3: 0.924834003261792},
    {0: 0.037037037037037035, 3: 0.17082860872947386, 4: 0.12546768756682242},
    {0: 0.037109375, 3: 0.17025221101954405, 4: 0.06021653898045596, 5: -0.017578125},
    {
        0: 0.03709200011850479,
        3: 0.17038392571223998,
        4: 0.10726203044637328,
        5: -0.015319437748624402,
        6: 0.008273789163814023,
    },
    {
        0: 0.6241109587160757,
        3: -3.3608926294469414,
        4: -0.868219346841726,
        5: 27.59209969944671,
        6: 20.154067550477894,
        7: -43.48988418106996,
    },
    {
        0: 0.47766253643826434,
        3: -2.4881146199716677,
        4: -0.590290826836843,
        5: 21.230051448181193,
        6: 15.279233632882423,
        7: -33.28821096898486,
        8: -0.020331201708508627,
    },
    {
        0: -0.9371424300859873,
        3: 5.186372428844064,
        4: 1.0914373489967295,
        5: -8.149787010746927,
        6: -18.52006565999696,
        7: 22.739487099350505,
        8: 2.4936055526796523,
        9: -3.0467644718982196,
    },
    {
        0: 2.273310147516538,
        3: -10.53449546673725,
        4: -2.0008720582248625,
        5: -17.9589318631188,
        6: 27.94888452941996,
        7: -2.8589982771350235,
        8: -8.87285693353063,
        9: 12.360567175794303,
        10: 0.6433927460157636,
    },
)
_DOP853_B = {  # {stage: coefficient}
    0: 0.054293734116568765,
    5: 4.450312892752409,
    6: 1.8915178993145003,
    7: -5.801203960010585,
    8: 0.3111643669578199,
    9: -0.1521609496625161,
    10: 0.20136540080403034,
    11: 0.04471061572777259,
}
_DOP853_FIFTH = {  # the step less one of order 5
    0: 0.01312004499419488,
    5: -1.2251564463762044,
    6: -0.4957589496572502,
    7: 1.6643771824549864,
    8: -0.35032884874997366,
    9: 0.3341791187130175,
    10: 0.08192320648511571,
    11: -0.022355307863886294,
}
_DOP853_THIRD = {  # .. and of order 3
    0: -0.18980075407240762,
    5: 4.450312892752409,
    6: 1.8915178993145003,
    7: -5.801203960010585,
    8: -0.4226823213237919,
    9: -0.1521609496625161,
    10: 0.20136540080403034,
    11: 0.02265179219836082,
}


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
    stages = range(len(_DOP853_C))
    A = np.array([[row.get(j, 0.0) for j in stages] for row in _DOP853_A])
    return Tableau(A, _of_all_stages(_DOP853_B), np.array(_DOP853_C))


@lru_cache(maxsize=1)
def dop853_errors() -> tuple[Array, Array]:
    """Weights (12,) of rk8's slopes in the estimates of orders 5 and 3 of its error per unit of the step.

    SciPy's DOP853 has the same numbers, and takes 0.3 s to import.
    """
    return _of_all_stages(_DOP853_FIFTH), _of_all_stages(_DOP853_THIRD)


def _of_all_stages(weights: dict[int, float]) -> Array:
    return np.array([weights.get(j, 0.0) for j in range(len(_DOP853_C))])


@lru_cache(maxsize=1)
def rk4() -> Tableau:
    """Kutta's classical method."""
    A = np.diag([0.5, 0.5, 1.0], -1)
    return Tableau(A, np.array([1.0, 2.0, 2.0, 1.0]) / 6, np.array([0.0, 0.5, 0.5, 1.0]))


TABLEAUS: dict[str, Callable[[], Tableau]] = {"rk4": rk4, "rk8": rk8}
