"""Where the eigenvalues of a matrix of doubles are, against the imaginary axis or the unit circle: counted.

Doubles are rational numbers, so that the characteristic polynomial p is one over the rationals, in exact arithmetic.
p = prod f_i^m_i with f_i free of squares. i w is a root of f where w is a real root of gcd(Re f(i w), Im f(i w)): those
on the axis are counted exactly. The others leave the axis once their balls are small enough, and only they do. Against
the circle z = (1 + s)/(1 - s) takes the half-plane of s inside; z = -1 is counted by itself. Of the minimal polynomial
a root on the edge of multiplicity m lets deviations grow like t^(m-1).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .balls import ends, flint

FIRST_BITS, MOST_BITS = 128, 1 << 15


@dataclass(frozen=True)
class Roots:
    """How many eigenvalues are beyond the edge, on it and within it, with their multiplicities."""

    outside: int
    on: int
    inside: int
    power: int  # of t, with which deviations of those on the edge may grow: 0 where each has its own direction
    largest: tuple[float, float]  # real part, or size, of the one farthest out: at least and at most
    values: tuple[complex, ...]  # doubles, and ..
    radii: tuple[float, ...]  # .. how far each eigenvalue may be from them
    bits: int


def counted(A: np.ndarray, *, circle: bool) -> Roots | None:
    """Of A (n, n), as its doubles are; None where MOST_BITS do not tell one from the edge."""
    library = flint()
    exact = library.fmpq_mat(*A.shape, [library.fmpq(*float(x).as_integer_ratio()) for x in A.ravel()])
    _, factors = exact.charpoly().numer().factor_squarefree()
    edges = [_on_edge(f, circle) for f, _ in factors]
    bits = FIRST_BITS
    while bits <= MOST_BITS:
        with library.ctx.workprec(bits):
            told = [_told(f, on, circle) for (f, _), on in zip(factors, edges)]
        if all(one is not None for one in told):
            break
        bits *= 2
    else:
        return None
    outside = inside = on = 0
    values, radii, low, high = [], [], [], []
    for (_, times), many, one in zip(factors, edges, told):
        beyond, within, roots = one or (0, 0, [])
        outside, inside, on = outside + times * beyond, inside + times * within, on + times * many
        for value, radius, (least, most) in roots:
            values += [value] * times
            radii += [radius] * times
            low.append(least)
            high.append(most)
    return Roots(outside, on, inside, _power(exact, circle), (max(low), max(high)), tuple(values), tuple(radii), bits)


def _power(exact: Any, circle: bool) -> int:
    _, factors = exact.minpoly().numer().factor_squarefree()
    return max((times - 1 for f, times in factors if _on_edge(f, circle)), default=0)


def _on_edge(f: Any, circle: bool) -> int:
    """How many roots of f, free of squares, are on the axis or the circle."""
    library = flint()
    last = 0
    if circle:
        if f(-1) == 0:
            f, last = f // library.fmpz_poly([1, 1]), 1
        f = _halved(f)
    real, imaginary = [], []
    for k, c in enumerate(f.coeffs()):  # f(i w)
        sign = 1 if k % 4 in (0, 1) else -1
        real.append(sign * c if k % 2 == 0 else 0)
        imaginary.append(sign * c if k % 2 else 0)
    both = library.fmpz_poly(real).gcd(library.fmpz_poly(imaginary))
    return last + sum(1 for w, _ in both.complex_roots() if w.imag == 0 and w.imag.is_exact())


def _halved(f: Any) -> Any:
    """(1 - s)^n f((1 + s)/(1 - s))."""
    library = flint()
    up, down, total = library.fmpz_poly([1, 1]), library.fmpz_poly([1, -1]), library.fmpz_poly([0])
    n = f.degree()
    for k, c in enumerate(f.coeffs()):
        total += c * up**k * down ** (n - k)
    return total


def _told(f: Any, on: int, circle: bool) -> tuple[int, int, list[tuple[complex, float, tuple[float, float]]]] | None:
    """(outside, inside, roots) once only `on` of them are left whose balls reach the edge."""
    outside = inside = left = 0
    roots = []
    for z, _ in f.complex_roots():
        size = abs(z) if circle else z.real
        beyond = size - 1 if circle else size
        edge = not (beyond > 0 or beyond < 0)  # comparisons of balls hold for all members
        outside, inside, left = outside + bool(beyond > 0), inside + bool(beyond < 0), left + edge
        value = complex(float(z.real.mid()), float(z.imag.mid()))
        radius = ends(abs(z - flint().acb(value.real, value.imag)))[1]
        exact_edge = (1.0, 1.0) if circle else (0.0, 0.0)
        roots.append((value, radius, exact_edge if edge else ends(size)))
    return (outside, inside, roots) if left == on else None
