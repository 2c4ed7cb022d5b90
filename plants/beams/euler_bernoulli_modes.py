"""Closed-form bending modes of uniform Euler-Bernoulli beams, stable to mode 200.

phi'''' = beta^4 phi on xi = x/L in [0, 1], beta^4 = rho A L^4 omega^2 / (E I). Textbooks write phi with cosh
and sinh, whose difference loses all digits before mode 15. Here phi = a cos(beta xi) + b sin(beta xi) + c
e^(-beta xi) + d e^(-beta (1 - xi)), in which no term exceeds its coefficient.

Signs   positive slope at xi = 0 where the end is pinned, else positive curvature there
Loaded  a rigid body at the free end, with tip mass matrix [[m, e], [e, j]] on (phi, phi'):
        m = mass/(rho A L), e = mass offset_x/(rho A L^2), j = inertia about the tip/(rho A L^3)
Source  "On the dynamic modelling of flexible manipulators", bending part. Roots are counted as by Wittrick
and Williams, "A general algorithm for computing natural frequencies of elastic structures" (1971)
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from pliant.plants.core.argument_gates import finite_array, real_array, require_number
from pliant.plants.core.parameters import require_choice, require_count
from pliant.plants.core.signals import OwnsArrays

MOST_MODES = 200
LARGEST_RATIO = 1e12  # tip mass or inertia against the beam's own
BOUNDARIES = ("clamped-free", "pinned-pinned", "clamped-clamped", "pinned-free")
LOADED = ("payload", "pinned-payload")
_SERIES_BELOW = 1.0  # beta under which powers replace the trigonometric form, which cancels as eps / beta^3

# What vanishes at each end, as orders of derivative.
_ENDS = {"clamped": (0, 1), "pinned": (0, 2), "free": (2, 3)}


@dataclass(frozen=True, eq=False)
class ModeShapes(OwnsArrays):
    """Shapes phi_k, int phi_k^2 dxi = 1, with roots beta (n,) and coefficients (n, 4) of their four terms."""

    boundary: str
    roots: np.ndarray
    coefficients: np.ndarray = field(repr=False)

    def __call__(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """d^derivative phi / dxi^derivative at xi (...,) in [0, 1] -> (..., n); derivative 0 to 4."""
        xi = checked_position(xi, derivative)
        return sum(
            column * factor
            for column, factor in zip(_columns(self.roots, xi, derivative), self.coefficients.T, strict=True)
        )


def checked_position(xi: float | np.ndarray, derivative: int) -> np.ndarray:
    """xi as an array; ValueError unless it lies in [0, 1] (1e-9 of slack) and derivative is 0 to 4."""
    require_count("shape", "derivative", derivative, 0, 4)
    xi = real_array("xi", xi)
    outside = ~((xi >= -1e-9) & (xi <= 1 + 1e-9))
    if np.any(outside):
        raise ValueError(f"xi = {xi[outside].flat[0]!r} must be within [0, 1]")
    return xi


def roots(boundary: str, n: int) -> np.ndarray:
    """The lowest n roots beta (n,) of an unloaded beam; "pinned-free" leaves out the rigid rotation.

    Newton on the characteristic equation divided by cosh: cos + sech, cos - sech, sin - tanh cos.

    Example
    -------
    >>> roots("clamped-free", 2).round(4)
    array([1.8751, 4.6941])
    """
    require_choice("modes", "boundary", boundary, BOUNDARIES)
    n = require_count("modes", "n", n, 0, MOST_MODES)
    k = np.arange(1, n + 1)
    if boundary == "pinned-pinned":
        return math.pi * k
    start = {"clamped-free": -0.5, "clamped-clamped": 0.5, "pinned-free": 0.25}[boundary]
    beta = math.pi * (k + start)
    for _ in range(8):
        sech, tanh = 1 / np.cosh(beta), np.tanh(beta)
        sin, cos = np.sin(beta), np.cos(beta)
        if boundary == "pinned-free":
            beta = beta - (sin - tanh * cos) / (cos + tanh * sin - sech**2 * cos)
        else:
            sign = 1 if boundary == "clamped-free" else -1
            beta = beta + (cos + sign * sech) / (sin + sign * sech * tanh)
    return beta


def loaded_roots(n: int, mass: float, inertia: float, coupling: float = 0.0) -> np.ndarray:
    """The lowest n roots beta (n,) of a clamped beam with a load at its tip (ratios as above).

    Bisection on the count of roots. Brackets: a tip load lowers every root of the clamped-free beam;
    Dunkerley's bound, with tip compliances 1/3 and 1, lies below the first; clamping the tip adds two
    constraints. ValueError where the coupling is larger than a load can have.

    Example
    -------
    >>> loaded_roots(2, mass=1.0, inertia=0.0).round(4)
    array([1.2479, 4.0311])
    """
    n = require_count("modes", "n", n, 0, MOST_MODES)
    mass = require_number("modes.mass", mass, least=0.0, most=LARGEST_RATIO)
    inertia = require_number("modes.inertia", inertia, least=0.0, most=LARGEST_RATIO)
    coupling = require_number("modes.coupling", coupling)
    if not coupling**2 <= mass * inertia * (1 + 1e-12):
        raise ValueError(f"modes.coupling = {coupling!r} must be within +-sqrt(mass inertia)")
    k = np.arange(1, n + 1)
    upper = 1.001 * roots("clamped-free", n)
    lowest = 0.999 * (1 / 1.8751**4 + mass / 3 + abs(coupling) + inertia) ** -0.25
    lower = np.full(n, lowest)
    lower[2:] = np.maximum(lowest, 0.999 * roots("clamped-clamped", n)[: max(n - 2, 0)])
    for _ in range(80):
        middle = 0.5 * (lower + upper)
        above = count_loaded(middle, mass, inertia, coupling) >= k
        lower, upper = np.where(above, lower, middle), np.where(above, middle, upper)
        if np.all(upper - lower <= 2e-16 * upper):
            break
    return 0.5 * (lower + upper)


def pinned_loaded_roots(n: int, mass: float, inertia: float, coupling: float = 0.0) -> np.ndarray:
    """The lowest n roots beta (n,) of a pinned beam with a load at its tip, without the rigid rotation.

    Clamping the root adds one constraint: one root lies between each two neighbours of the clamped, loaded beam. There
    (1 - beta^4 (m j - e^2)) (s ch - c sh) + 2 beta m s sh + 2 beta^2 e (s ch + c sh) + 2 beta^3 j c ch changes sign.
    """
    clamped = loaded_roots(n + 1, mass, inertia, coupling) if n else np.zeros(1)
    lower, upper = clamped[:-1], clamped[1:]

    def determinant(beta: np.ndarray) -> np.ndarray:
        plus_one, pole, plus, minus, sin_sinh = _products(beta)
        found = (1 - beta**4 * (mass * inertia - coupling**2)) * minus + 2 * beta * mass * sin_sinh
        return found + 2 * beta**2 * coupling * plus + beta**3 * inertia * (plus_one - pole)

    side = np.sign(determinant(lower * (1 + 1e-15)))
    for _ in range(80):
        middle = 0.5 * (lower + upper)
        same = np.sign(determinant(middle)) == side
        lower, upper = np.where(same, middle, lower), np.where(same, upper, middle)
        if np.all(upper - lower <= 2e-16 * upper):
            break
    return 0.5 * (lower + upper)


def count_loaded(beta: np.ndarray, mass: float, inertia: float, coupling: float = 0.0) -> np.ndarray:
    """How many roots of the loaded clamped beam lie below each beta (...,), none missed.

    It is the number of roots of the clamped-clamped beam below beta plus the number of negative eigenvalues
    of the dynamic stiffness of the tip, K_b - beta^4 [[mass, coupling], [coupling, inertia]].

    Example
    -------
    >>> count_loaded(np.array([1.0, 2.0]), 0.0, 0.0)
    array([0, 1])
    """
    beta = finite_array("count_loaded.beta", beta)
    mass = require_number("count_loaded.mass", mass, "nonnegative")
    inertia = require_number("count_loaded.inertia", inertia, "nonnegative")
    coupling = require_number("count_loaded.coupling", coupling)
    plus_one, pole, plus, minus, sin_sinh = _products(beta)
    determinant = (
        plus_one
        - mass * beta * minus
        - inertia * beta**3 * plus
        - 2 * coupling * beta**2 * sin_sinh
        + (mass * inertia - coupling**2) * beta**4 * pole
    )
    corner = beta**3 * plus - beta**4 * mass * pole
    negative = np.where(determinant * np.sign(pole) < 0, 1, np.where(corner * np.sign(pole) < 0, 2, 0))
    # Root j of the clamped-clamped beam lies within 0.02 of (j + 1/2) pi; `pole` tells the side.
    nearest = np.maximum(np.rint(beta / math.pi - 0.5), 0).astype(int)
    passed = (pole < 0) == (nearest % 2 == 1)
    return np.where(nearest > 0, nearest - 1 + passed, 0) + negative


def _products(beta: np.ndarray) -> tuple[np.ndarray, ...]:
    """1 + c ch, 1 - c ch, s ch + c sh, s ch - c sh and s sh of beta, all times one positive factor.

    The factor is e^-beta, and 1 for small beta, where the series of cos cosh and its derivatives do not
    cancel.
    """
    decay = np.exp(-beta)
    cosh, sinh = (1 + decay**2) / 2, (1 - decay**2) / 2
    sin, cos = np.sin(beta), np.cos(beta)
    scaled = (
        decay + cos * cosh,
        decay - cos * cosh,
        sin * cosh + cos * sinh,
        sin * cosh - cos * sinh,
        sin * sinh,
    )
    few = beta < _SERIES_BELOW
    if not np.any(few):
        return scaled
    small = np.minimum(beta, _SERIES_BELOW)
    cc = [  # derivatives 0 to 3 of cos cosh - 1
        sum((-4.0) ** k * small ** (4 * k - d) / math.factorial(4 * k - d) for k in range(1, 6)) for d in range(4)
    ]
    series = (2 + cc[0], -cc[0], -cc[3] / 2, -cc[1], -cc[2] / 2)
    return tuple(np.where(few, s, t) for s, t in zip(series, scaled, strict=True))


def _columns(beta: np.ndarray, xi: np.ndarray, derivative: int) -> list[np.ndarray]:
    """Derivatives of four independent solutions of phi'''' = beta^4 phi, each (..., n)."""
    xi = xi[..., None]
    phase, power = beta * xi, beta**derivative
    cos, sin = np.cos(phase), np.sin(phase)
    cycle = (cos, -sin, -cos, sin)
    columns = [
        power * cycle[derivative % 4],
        power * cycle[(derivative + 3) % 4],
        power * (-1) ** derivative * np.exp(-phase),
        power * np.exp(-beta * (1 - xi)),
    ]
    small = beta < _SERIES_BELOW
    if np.any(small):
        few = beta[small] ** 4
        for j, column in enumerate(columns):
            turns, order = divmod(j - derivative, 4)  # solution j starts as xi^j / j!; four derivatives give beta^4
            column[..., small] = few**-turns * sum(
                few**m * xi ** (4 * m + order) / math.factorial(4 * m + order) for m in range(6)
            )
    return columns


def shapes(boundary: str, n: int, *, mass: float = 0.0, inertia: float = 0.0, coupling: float = 0.0) -> ModeShapes:
    """The lowest n modes of a beam with these ends; "payload" is clamped-free with a loaded tip, "pinned-payload"
    pinned-free with one.

    mass, inertia and coupling of the load over rho A L, rho A L^3 and rho A L^2 [-].
    The coefficients are the null vector of the 4 x 4 matrix of end conditions, by singular value
    decomposition. Loaded modes are orthogonal in the mass of beam and load together, but scaled to int phi^2
    dxi = 1 as the rest.

    Example
    -------
    >>> shapes("clamped-free", 2).roots.round(4)
    array([1.8751, 4.6941])
    """
    require_choice("modes", "boundary", boundary, (*BOUNDARIES, *LOADED))
    n, loaded = require_count("modes", "n", n, 0, MOST_MODES), boundary in LOADED
    if loaded:
        found = loaded_roots if boundary == "payload" else pinned_loaded_roots
        beta = found(n, mass, inertia, coupling)
        left, right = "clamped" if boundary == "payload" else "pinned", "free"
    else:
        beta = roots(boundary, n)
        left, right = boundary.split("-")
    at_0 = [np.stack(_columns(beta, np.zeros(()), d), axis=-1) for d in range(4)]
    at_1 = [np.stack(_columns(beta, np.ones(()), d), axis=-1) for d in range(4)]
    rows = [at_0[d] for d in _ENDS[left]]
    if loaded:
        b4 = beta[:, None] ** 4
        rows.append(at_1[3] + b4 * (mass * at_1[0] + coupling * at_1[1]))
        rows.append(at_1[2] - b4 * (coupling * at_1[0] + inertia * at_1[1]))
    else:
        rows += [at_1[d] for d in _ENDS[right]]
    ends = np.stack(rows, axis=1)
    ends /= np.abs(ends).max(axis=2, keepdims=True)
    coefficients = np.linalg.svd(ends)[2][:, 3, :] if n else np.zeros((0, 4))
    first_nonzero = at_0[1 if left == "pinned" else 2]
    coefficients = coefficients * np.sign(np.sum(coefficients * first_nonzero, axis=1))[:, None]
    xi, weights = quadrature(n)
    norm = np.sqrt(weights @ ModeShapes(boundary, beta, coefficients)(xi) ** 2)
    coefficients = coefficients / norm[:, None]
    beta.setflags(write=False)
    coefficients.setflags(write=False)
    return ModeShapes(boundary, beta, coefficients)


@lru_cache(maxsize=32)
def quadrature(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights (m,) on [0, 1] that integrate products of the first n shapes exactly to rounding.

    Composite Gauss-Legendre, 14 points on n + 2 panels. Roots lie below (n + 1/2) pi, so a product of two
    shapes is a sum of e^(z xi) with |z| < (2 n + 1) pi: |z h| < pi on a panel of half-length h. The rule's
    relative error is then below pi^28 2^29 (14!)^4 / (29 (28!)^3) < 1e-23.
    """
    x, w = np.polynomial.legendre.leggauss(14)
    panels = n + 2
    start = np.arange(panels)[:, None]
    return ((start + (1 + x) / 2) / panels).ravel(), np.tile(w / (2 * panels), panels)
