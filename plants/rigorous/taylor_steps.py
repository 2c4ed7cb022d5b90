"""The transition matrix of dz/dt = A(t) z over one step of a cubic A(t), enclosed by its Taylor series and a remainder.

On s = time/h in [0, 1] and H_j = A_j h^(j+1), A = sum A_j time^j:
    Phi = sum P_k,   P_0 = 1,   (k + 1) P_k+1 = sum_j H_j P_k-j
The same recursion of the norms a_j >= |H_j| majorises |P_k| by y_k, and all y_k together are exp(a_0 + a_1/2 + a_2/3 +
a_3/4): what remains after N terms is at most that less y_0 + .. + y_N.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .balls import ends, flint, identity, row_sum, widened

ACROSS = 4.0  # |A| h of a step: fewer, longer ones cost less
MOST_TERMS, MOST_PARTS = 400, 1 << 20


def shifted(A: list[Any], by: Any) -> list[Any]:
    """The coefficients of the same cubic about a time that is later by so much."""
    a0, a1, a2, a3 = A
    return [a0 + (a1 + (a2 + a3 * by) * by) * by, a1 + (a2 * 2 + a3 * 3 * by) * by, a2 + a3 * 3 * by, a3]


def parts(A: list[Any], h: Any) -> int:
    """In how many steps of |A| h at most ACROSS the interval is to be cut."""
    size = ends(sum((row_sum(a) * h ** (j + 1) for j, a in enumerate(A)), flint().arb(0)))[1]
    return max(1, math.ceil(size / ACROSS)) if size < np.inf else MOST_PARTS


def step(A: list[Any], h: Any) -> Any:
    """Phi (n, n) of every member over a step h from the coefficients A of its cubic about its start."""
    H = [a * h ** (j + 1) for j, a in enumerate(A)]
    size = [row_sum(a) for a in H]
    H = H[: max((j + 1 for j, a in enumerate(size) if a != 0), default=0)]
    count, left = _terms(size)
    P = [identity(A[0].nrows())]
    total = P[0]
    for k in range(count):
        term = H[0] * P[k] if H else total * 0
        for j in range(1, min(k, len(H) - 1) + 1):
            term += H[j] * P[k - j]
        P.append(term / (k + 1))
        total += P[-1]
    return widened(total, left)


def _terms(a: list[Any]) -> tuple[int, Any]:
    """How many terms leave less than the last bit, and what they leave."""
    library = flint()
    bits = library.ctx.prec
    with library.ctx.workprec(2 * bits + 64):
        whole = sum((x / (j + 1) for j, x in enumerate(a)), library.arb(0)).exp()
        least, y = library.arb(2) ** -(bits + 8), [library.arb(1)]
        left = whole - 1
        while not left.upper() < least and len(y) <= MOST_TERMS:
            k = len(y) - 1
            y.append(sum((a[j] * y[k - j] for j in range(min(k, 3) + 1)), library.arb(0)) / (k + 1))
            left -= y[-1]
        return len(y) - 1, left.upper().max(library.arb(0))
