"""Rosenbrock methods by their coefficients, in variables that need no products with the Jacobian.

With J = df/dx and f' = df/dt at the start of a step, and W = I / (gamma h) - J, the stages k_i solve

    W k_i = f(t + alpha_i h, x + sum_j A_ij k_j) + sum_j C_ij k_j / h + h d_i f',      x(t + h) = x + sum_i m_i k_i.

rodas3    order 3, L-stable, four stages of which two share a right-hand side: Sandu et al., "Benchmarking stiff ODE
          solvers for atmospheric chemistry problems II", Atmospheric Environment 31, 1997
rodas5p   order 5 with an embedded method of order 4 and dense output of order 4, L-stable, stiffly accurate, eight
          stages, made so that parabolic problems keep the order: Steinebach, "Construction of Rosenbrock-Wanner method
          Rodas5P and numerical benchmarks within the Julia Differential Equations package", BIT 63, 2023
Both end in x(t + h) = y_s + k_s, y_s where the last stage stands, and k_s is the estimate of the error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from pliant.plants.core.signals import OwnsArrays

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class RosenbrockTableau(OwnsArrays):
    """A, C (s, s) strictly lower, alpha, d (s,); dense (r, s), r = 0 where there is no dense output.

    Between t and t + h, at the fraction c of the step and with b_j = sum_i dense_ji k_i,
    x = (1 - c) x(t) + c (x(t + h) + (1 - c) (b_1 + c b_2 + c^2 b_3 ..)). It errs most near c = `worst`.
    """

    gamma: float
    A: Array
    C: Array
    alpha: Array
    d: Array
    dense: Array
    order: int  # of the embedded method, by which steps are chosen
    worst: float = 0.0

    @property
    def m(self) -> Array:
        """Of the step: the last stage stands at x + sum_j A_sj k_j, and the step adds k_s."""
        return np.append(self.A[-1, :-1], 1.0)

    def along(self, c: float) -> Array:
        """Coefficients (s,) of the stages at the fraction c of the step: x(t + c h) = x(t) + sum_i along_i k_i."""
        powers = c ** np.arange(len(self.dense))
        return c * (self.m + (1 - c) * powers @ self.dense)

    def slope_along(self, c: float) -> Array:
        """Coefficients (s,) of h dx/dt there."""
        powers, n = c ** np.arange(len(self.dense)), np.arange(len(self.dense))
        slopes = n * c ** np.maximum(n - 1, 0)
        return self.m + (1 - 2 * c) * powers @ self.dense + c * (1 - c) * slopes @ self.dense

    @property
    def untransformed(self) -> tuple[Array, Array, Array]:
        """(alpha (s, s), beta (s, s), b (s,)) of the order conditions: Hairer and Wanner II, Section IV.7."""
        G = np.linalg.inv(np.eye(len(self.d)) / self.gamma - self.C)
        return self.A @ G, self.A @ G + G, self.m @ G


def _lower(rows: Sequence[Sequence[float]]) -> Array:
    """Strictly lower triangular, row i of i numbers."""
    found = np.zeros((len(rows), len(rows)))
    for i, row in enumerate(rows):
        found[i, : len(row)] = row
    return found


@lru_cache(maxsize=1)
def rodas3() -> RosenbrockTableau:
    return RosenbrockTableau(
        gamma=0.5,
        A=_lower([(), (0.0,), (2.0, 0.0), (2.0, 0.0, 1.0)]),
        C=_lower([(), (4.0,), (1.0, -1.0), (1.0, -1.0, -8 / 3)]),
        alpha=np.array([0.0, 0.0, 1.0, 1.0]),
        d=np.array([0.5, 1.5, 0.0, 0.0]),
        dense=np.zeros((0, 4)),
        order=2,
    )


@lru_cache(maxsize=1)
def rodas5p() -> RosenbrockTableau:
    sixth = -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946
    A = [
        (),
        (3.0,),
        (2.849394379747939, 0.45842242204463923),
        (-6.954028509809101, 2.489845061869568, -10.358996098473584),
        (2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641),
        sixth,
        (*sixth, 1.0),
        (*sixth, 1.0, 1.0),
    ]
    C = [
        (),
        (-14.155112264123755,),
        (-17.97296035885952, -2.859693295451294),
        (147.12150275711716, -1.41221402718213, 71.68940251302358),
        (165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306),
        (24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471),
        (
            *(30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783),
            *(-19.097331116725623, -28.087943162872662),
        ),
        (
            *(37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047),
            *(-40.06618937091002, -54.66780262877968, -9.48861652309627),
        ),
    ]
    dense = [
        (
            *(25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204),
            *(0.524948541321073, 1.1241088310450404, 0.4272876194431874, -0.17202221070155493),
        ),
        (
            *(-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796),
            *(20.176138334709044, 15.98066361424651, -6.789040303419874, -6.710236069923372),
        ),
        (
            *(11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643),
            *(-52.072871366152654, -59.78993625266729, -0.15582684282751913, 4.883087185713722),
        ),
    ]
    return RosenbrockTableau(
        gamma=0.21193756319429014,
        A=_lower(A),
        C=_lower(C),
        alpha=np.array(
            [0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0]
        ),
        d=np.array(
            [
                *(0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734),
                *(2.325825639765069, 0.0, 0.0, 0.0),
            ]
        ),
        dense=np.array(dense),
        order=4,
        worst=0.85,
    )
