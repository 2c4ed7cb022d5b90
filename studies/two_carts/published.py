"""Laws that others published for the two carts, u = -B(s)/A(s) x2, and what they say of them.

Coefficient diagram   Manabe and Kim 2021, "Coefficient Diagram Method for Control System Design", Section 4.3: A and B
         of degree 3 that give the loop m1 m2/k s^4 A + (m1 + m2) s^2 A + B the stability indices and the time constant
         named. Indices and scores are quoted by an example of the package cdmtb 0.2.4; the book was not at hand. That
         program has 6.70 for the fourth, for which the book's score is quoted as 8.54
Fastest  Henrion and Overton 2006, "Maximizing the closed loop asymptotic decay rate for the two-mass-spring control
         problem": of all laws of degree 2 this one, all six poles at -sqrt(15)/5 1/s, decays fastest
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pliant.controllers.analysis.linear_laws import LinearLaw

Array = np.ndarray
PLANT = np.array([1.0, 0.0, 2.0, 0.0, 0.0])  # s^4 m1 m2/k + s^2 (m1 + m2), as published: y = 1/PLANT u
FASTEST = np.sqrt(15.0) / 5.0  # [1/s]


@dataclass(frozen=True)
class Published:
    """A law as numerator and denominator, highest power first, and what is printed of it."""

    name: str
    source: str
    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    score: float | None = None  # see `merit.score`
    decay: float | None = None  # [1/s] of the slowest pole

    @property
    def law(self) -> LinearLaw:
        """In controller canonical form; acts at every time."""
        A, B = np.array(self.denominator), np.array(self.numerator)
        A, B = A / A[0], np.concatenate([np.zeros(len(A) - len(B)), B]) / A[0]
        m, direct = len(A) - 1, B[0]
        companion = np.vstack([-A[1:], np.eye(m - 1, m)])
        return LinearLaw(
            companion, np.eye(m, 1), (B[1:] - direct * A[1:])[None], np.array([[direct]]), ("tip_x",), None
        )


def characteristic(indices: Sequence[float], time: float) -> Array:
    """Coefficients, highest power first, whose stability indices a_i^2/(a_i+1 a_i-1) are (gamma_1, ..) and whose time
    constant a_1/a_0 is `time` [s]; a_0 = 1."""
    n = len(indices) + 1
    falls = [np.prod([indices[i - j - 1] ** j for j in range(1, i)]) for i in range(n + 1)]
    return np.array([time**i / fall for i, fall in enumerate(falls)])[::-1]


def by_coefficient_diagram(name: str, indices: Sequence[float], time: float, score: float) -> Published:
    """A and B of degree 3 with PLANT A + B the characteristic polynomial: eight equations."""
    columns = [np.convolve(PLANT, np.eye(4)[i]) for i in range(4)] + [np.eye(8)[4 + i] for i in range(4)]
    found = np.linalg.solve(np.array(columns).T, characteristic(indices, time))
    source = "Manabe and Kim 2021"
    return Published(name, source, tuple(found[4:] / found[0]), tuple(found[:4] / found[0]), score)


def fastest() -> Published:
    """(s + a)^6 = PLANT (s^2 + 6 a s + 7) + B, which takes 20 a^3 = 2 (6 a): a^2 = 3/5."""
    a = FASTEST
    B = np.poly([-a] * 6) - np.convolve(PLANT, [1.0, 6 * a, 7.0])
    return Published("fastest of degree 2", "Henrion and Overton 2006", tuple(B[4:]), (1.0, 6 * a, 7.0), decay=a)


PUBLISHED = (
    by_coefficient_diagram("coefficient diagram 1", (2.5, 2.0, 2.0, 2.0, 2.0, 2.0), 6.0, -1.41),
    by_coefficient_diagram("coefficient diagram 2", (2.5, 2.0, 1.5, 1.5, 1.5, 2.0), 6.0, 0.35),
    by_coefficient_diagram("coefficient diagram 3", (2.0, 2.5, 1.5, 1.5, 1.5, 4.0), 6.0, 5.99),
    by_coefficient_diagram("coefficient diagram 4", (2.0, 2.5, 1.5, 1.5, 1.5, 4.0), 6.4, 8.54),
    fastest(),
)
