"""What rounding leaves open in the entries of a matrix that came out of a computation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

EPS = float(np.finfo(float).eps)
CANCELLED = 16  # times the rounding of a term: sums of as many


def rounding(A: np.ndarray) -> np.ndarray:
    """What rounding leaves open (n, n) in a matrix that came out of a computation; zeros are taken as meant."""
    size = np.abs(A)
    row, column = size.sum(axis=1, keepdims=True), size.sum(axis=0, keepdims=True)
    return EPS * (2 * len(A) * size + 4 * np.minimum(row, column)) * (size > 0)


def cancelled(A: np.ndarray, units: Sequence[str]) -> np.ndarray:
    """What is open (n, n) in entries that are left where larger ones cancel: rounding of the largest entry of their row
    among states of the same unit, which no choice of units changes. Zeros, and states without a unit, leave nothing.
    """
    size, D = np.abs(A), np.zeros(A.shape)
    for unit in {unit for unit in units if unit}:
        own = [k for k, name in enumerate(units) if name == unit]
        D[:, own] = CANCELLED * EPS * size[:, own].max(axis=1, keepdims=True)
    return D * (size > 0)
