"""Matrices of balls (midpoint and radius, Arb by python-flint): made of doubles exactly, their norms, and back.

A number m +- r stands for every real number in it; each operation gives a ball that holds the result of every member.
What goes back to doubles is rounded outwards.
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np


def flint() -> Any:
    """The library of balls; ImportError that says how to get it."""
    try:
        return importlib.import_module("flint")
    except ImportError as missing:
        raise ImportError("assess.rigorous = True needs python-flint: pip install pliant[rigorous]") from missing


def matrix(values: np.ndarray) -> Any:
    """Doubles (m, n) as they are."""
    values = np.atleast_2d(values)
    return flint().arb_mat(*values.shape, [float(x) for x in values.ravel()])


def identity(n: int) -> Any:
    return matrix(np.eye(n))


def midpoint(M: Any) -> np.ndarray:
    """The nearest doubles (m, n) of the midpoints: no bound."""
    return np.array([float(x.mid()) for x in M.entries()]).reshape(M.nrows(), M.ncols())


def ends(x: Any) -> tuple[float, float]:
    """Doubles below and above every member of a ball."""
    low, high = float(x.lower()), float(x.upper())
    if np.isnan(low) or np.isnan(high):
        return -np.inf, np.inf
    return float(np.nextafter(low, -np.inf)), float(np.nextafter(high, np.inf))


def radii(M: Any, about: np.ndarray) -> np.ndarray:
    """How far (m, n) members may be from doubles `about` at most."""
    found = [ends(abs(x - float(c)))[1] for x, c in zip(M.entries(), about.ravel())]
    return np.array(found).reshape(about.shape)


def row_sum(M: Any) -> Any:
    """The largest row sum of |M| of any member, as a number without a radius."""
    arb, most = flint().arb, flint().arb(0)
    rows, columns = M.nrows(), M.ncols()
    for i in range(rows):
        total = arb(0)
        for j in range(columns):
            total += M[i, j].abs_upper()
        most = most.max(total.upper())
    return most


def widened(M: Any, radius: Any) -> Any:
    """Each entry by -radius to radius more."""
    off = flint().arb(0, radius)
    return flint().arb_mat(M.nrows(), M.ncols(), [x + off for x in M.entries()])


def part(M: Any, keep: Any) -> Any:
    """The rows and columns `keep`."""
    return flint().arb_mat(len(keep), len(keep), [M[int(i), int(j)] for i in keep for j in keep])


def spectral_bounds(M: Any) -> tuple[Any, Any]:
    """Bounds of the 2-norm of every member of M (n, n): below by |M v|/|v|, above by Gershgorin's disks of V^-1 M'M V,
    v and V the singular vectors of the midpoint as doubles.
    """
    arb, centre = flint().arb, midpoint(M)
    if not np.isfinite(centre).all():
        return arb(0), arb.pos_inf()
    size = float(np.abs(centre).max())
    scale = 2.0 ** -np.frexp(size)[1] if 1e-290 < size < 1e290 else 1.0
    _, _, right = np.linalg.svd(centre * scale)
    moved = M * matrix(right.T)
    start = sum((arb(float(x)) ** 2 for x in right[0]), arb(0)).sqrt()
    low = sum((moved[i, 0].abs_lower() ** 2 for i in range(M.nrows())), arb(0)).sqrt() / start
    try:
        disks = matrix(right.T).solve(M.transpose() * moved)
    except ZeroDivisionError:
        return low.lower().max(arb(0)), arb.pos_inf()
    return low.lower().max(arb(0)), row_sum(disks).sqrt().upper()
