"""How far a motion can miss its nominal for any parameters in a box: a bound from above beside one that was simulated.

Over the box, delta in [-1, 1]^k, what an output misses at one time is smooth in delta. The nonlinear plant is simulated
at all points of a Chebyshev grid, in lanes of one native step, and the polynomial through them

    e(t, delta) = sum_a c_a(t) T_a1(delta_1) .. T_ak(delta_k) + rest,   of degree d in each parameter

is bounded without a gap: |T_a| <= 1 for coefficients too small to matter, and for the others, of degrees d_i, by the
values on the m_i + 1 extrema of a Chebyshev polynomial a parameter (Ehlich and Zeller 1964)

    max |e| <= max over the points |e| / prod_i cos(pi d_i / (2 m_i)).

The terms of the first degree are those of the linear model along the nominal, whose affine term is there because the
nominal is no motion of the changed plant; the higher ones are what that model leaves out.

What is not shown is the rest: it was measured at some hundred other points, corners among them, and twice the largest
that was found stands for it. Between the nominal's nodes nothing is looked at.

Source   Ehlich and Zeller 1964, "Schwankung von Polynomen zwischen Gitterpunkten"; Trefethen 2013, "Approximation
         theory and approximation practice", Chapter 4, for the coefficients
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_count
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.plant import Plant

from .worst_parameters import MotionsInBox, WorstParameters, motions_in_box, worst_parameters

Array = np.ndarray
DEGREES = (3, 5, 8, 12, 18, 26, 38)  # of the polynomial in each parameter, one after the other
MOST_LANES = 20_000  # motions of one grid
MOST = 5  # parameters
CHECKED, CORNERS = 200, 5  # random points at which the rest is measured; parameters of which all corners are too
TWICE = 2.0  # times the largest rest that was measured
CLOSE = 2e-3  # of the miss: a rest that needs no higher degree
SMALL = 1e-3  # of the miss: coefficients that are bounded by their sum
FINE, LEAST, POINTS = 40.0, 2.0, 2e5  # points of a mesh for each degree, at most and at least, and all together
POOR = 0.5  # of the miss: a rest past which there is no bound


@dataclass(frozen=True, eq=False)
class MissOverBox(OwnsArrays):
    """Of one output over one box [unit of the output]: at least `lower` and at most `upper` from the nominal.

    Example
    -------
    >>> found = miss_over_box(arm, motion, {"payload.mass": (0.09, 0.11)}, ["tip_deflection"])["tip_deflection"]
    >>> found.lower <= found.upper
    True
    >>> found.words[:18]
    'For all of the box'
    """

    output: str
    upper: float
    lower: float  # simulated, with `worst`
    worst: WorstParameters
    rest: float  # part of `upper`: twice the largest that the polynomial was seen to lack
    first_order: float  # the largest of the linear model along the nominal in the middle of the box, for comparison
    degree: int
    t: Array = field(repr=False)  # (nt,) [s]
    tube: Array = field(repr=False)  # (nt, 2): within which the output less its nominal stays

    @property
    def words(self) -> str:
        """What an engineer would write."""
        at = ", ".join(f"{n} = {v:.4g}" for n, v in self.worst.parameters.items())
        return (
            f"For all of the box {self.output} misses its nominal by at most {self.upper:.4g}, {self.rest:.2g} of "
            f"which stands for what was sampled and not shown; by {self.lower:.4g} it does, with {at}."
        )


def miss_over_box(
    plant: Plant,
    nominal: Trajectory,
    box: Mapping[str, tuple[float, float]],
    outputs: tuple[str, ...] | list[str],
    *,
    gains: Any = None,
    substeps: int = 10,
    seed: int = 0,
) -> dict[str, MissOverBox]:
    """By name of the output [its unit]; arguments as in `worst_parameters`, box of at most 5 parameters, gains
    (nt, nu, nx).

    PliantError where the miss is no smooth function over the box that polynomials follow: take a smaller box.

    Example
    -------
    >>> found = miss_over_box(arm, motion, {"payload.mass": (0.09, 0.11)}, ["tip_deflection"])["tip_deflection"]
    >>> print(found.words)
    For all of the box tip_deflection misses its nominal by at most 0.01234, 2.6e-06 of which stands for what
    was sampled and not shown; by 0.01232 it does, with payload.mass = 0.09.
    """
    motions = motions_in_box("miss_over_box", plant, nominal, box, outputs, gains, substeps)
    if (k := len(motions.box)) > MOST:
        raise ValueError(f"miss_over_box.box names {k} parameters, must be at most {MOST}")
    seed = require_count("miss_over_box", "seed", seed, 0, 2**31)
    lower = worst_parameters(plant, nominal, box, motions.outputs, gains=gains, substeps=substeps, seed=seed)
    checked = _checked(k, np.random.default_rng(seed))
    truth = motions.missed(checked)
    for degree in DEGREES:
        if (degree + 1) ** k > MOST_LANES:
            break
        c, reached = _coefficients(motions, degree), degree
        lacks = np.abs(truth - _values(c, checked)).max(axis=(0, 1))
        if (TWICE * lacks <= CLOSE * np.array([f.miss for f in lower.values()])).all():
            break
    found = {}
    for j, (name, worst) in enumerate(lower.items()):
        rest = TWICE * float(lacks[j])
        if rest > POOR * worst.miss:
            raise PliantError(
                f"miss_over_box: over this box what {name} misses changes too fast for polynomials of degree "
                f"{reached}: they lack {lacks[j]:.3g} of {worst.miss:.3g}; take a smaller box"
            )
        own = c[..., j]
        upper, where = _largest(own)
        played = np.abs(motions.missed(where[None])[0, :, j])
        if played.max() > worst.miss:
            when = float(nominal.t[played.argmax()])
            worst = WorstParameters(name, float(played.max()), when, motions.named(where))
        upper = max(upper + rest, worst.miss)
        middle, around = own[(0,) * k], np.abs(own).reshape(-1, own.shape[-1]).sum(axis=0) - np.abs(own[(0,) * k])
        tube = np.column_stack([middle - around - rest, middle + around + rest])
        tube = np.clip(tube, -upper, upper)
        found[name] = MissOverBox(
            name, upper, worst.miss, worst, rest, _first_order(own), reached, motions.nominal.t, tube
        )
    return found


def _checked(k: int, rng: np.random.Generator) -> Array:
    """Points inside, on edges, and at corners."""
    edges = rng.uniform(-1, 1, (CHECKED // 2, k))
    edges[np.arange(len(edges)), rng.integers(k, size=len(edges))] = rng.choice((-1.0, 1.0), len(edges))
    corners = np.array(list(product((-1.0, 1.0), repeat=k))) if k <= CORNERS else rng.choice((-1.0, 1.0), (CHECKED, k))
    return np.vstack([rng.uniform(-1, 1, (CHECKED, k)), edges, corners])


def _coefficients(motions: MotionsInBox, degree: int) -> Array:
    """c (degree + 1, .., degree + 1, nt, outputs) of the Chebyshev polynomials, through the motions of a grid."""
    n, k = degree + 1, len(motions.box)
    angles = (np.arange(n) + 0.5) * np.pi / n
    grid = np.array(list(product(np.cos(angles), repeat=k)))
    found = motions.missed(grid)
    c = found.reshape(*(n,) * k, *found.shape[1:])
    onto = 2 / n * np.cos(np.outer(np.arange(n), angles))
    onto[0] /= 2
    for axis in range(k):
        c = np.moveaxis(np.tensordot(onto, c, (1, axis)), 0, axis)
    return c


def _values(c: Array, at: Array) -> Array:
    """(m, nt, outputs) of delta (m, k)."""
    n, k = len(c), at.shape[1]
    T = np.cos(np.arange(n) * np.arccos(np.clip(at, -1, 1))[..., None])  # (m, k, n)
    found = np.einsum("mi,i...->m...", T[:, 0], c)
    for axis in range(1, k):
        found = np.einsum("mi,mi...->m...", T[:, axis], found)
    return found


def _largest(c: Array) -> tuple[float, Array]:
    """A bound of |polynomial| over the box and all times, c (n, .., n, nt), and where about it is largest (k,)."""
    k, nt = c.ndim - 1, c.shape[-1]
    sums = np.abs(c).reshape(-1, nt).sum(axis=0)
    best, where = 0.0, np.zeros(k)
    for i in np.argsort(-sums):
        if sums[i] <= best:
            break
        own, cut = _shortened(c[..., i], SMALL * float(sums[i]))
        degrees = [n - 1 for n in own.shape]
        fine = (POINTS / np.prod([max(d, 1) for d in degrees])) ** (1 / k)
        values, factor, ends = own, 1.0, []
        for axis, d in enumerate(degrees):
            m = int(np.ceil(np.clip(fine, LEAST, FINE) * d)) + 1
            T = np.cos(np.outer(np.arange(m + 1) * np.pi / m, np.arange(d + 1)))
            values = np.moveaxis(np.tensordot(T, values, (1, axis)), 0, axis)
            factor *= np.cos(np.pi * d / (2 * m))
            ends.append(np.cos(np.arange(m + 1) * np.pi / m))
        at = np.unravel_index(int(np.abs(values).argmax()), values.shape)
        if (found := min(float(np.abs(values[at])) / factor + cut, float(sums[i]))) > best:
            best, where = found, np.array([end[j] for end, j in zip(ends, at)])
    return best, where


def _shortened(c: Array, small: float) -> tuple[Array, float]:
    """Without the last coefficients of each parameter as long as their sum is small, and that sum."""
    cut = 0.0
    while True:
        ends = [np.abs(c.take(-1, axis=a)).sum() if c.shape[a] > 1 else np.inf for a in range(c.ndim)]
        at = int(np.argmin(ends))
        if not cut + ends[at] <= small:
            return c, cut
        cut += float(ends[at])
        c = c.take(np.arange(c.shape[at] - 1), axis=at)


def _first_order(c: Array) -> float:
    """|e(t, 0)| + sum_i |de/d(delta_i)| in the middle of the box, the largest over time."""
    k, n = c.ndim - 1, len(c)
    level = np.array([np.cos(a * np.pi / 2) for a in range(n)])  # T_a(0)
    slope = np.array([a * np.sin(a * np.pi / 2) for a in range(n)])  # T_a'(0)
    total: Array = np.zeros(c.shape[-1])
    for which in range(-1, k):
        part = c
        for axis in range(k):
            part = np.tensordot(slope if axis == which else level, part, (0, 0))
        total = total + np.abs(part)
    return float(total.max())
