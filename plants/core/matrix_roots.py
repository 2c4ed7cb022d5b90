"""The root of a semidefinite matrix, in any units."""

from __future__ import annotations

import numpy as np

ROUNDING = 10 * np.finfo(float).eps  # times n: eigenvalues below this part of the largest are rounding


def semidefinite_root(weight: np.ndarray) -> np.ndarray:
    """S (.., n, n) with S S' = weight (.., n, n), symmetric and semidefinite; its negative part counts as zero.

    The diagonal is made ones first (zero where it is not positive), so that units of single rows and the size of the
    whole change nothing: what is cut off is cut relative to the equilibrated matrix. The columns that are cut are zero.
    """
    unit = np.sqrt(np.maximum(np.diagonal(weight, axis1=-2, axis2=-1), 0.0))
    by = np.where(unit > 0, unit, np.inf)
    even = weight / by[..., :, None] / by[..., None, :]
    value, vector = np.linalg.eigh((even + np.swapaxes(even, -1, -2)) / 2)
    least = ROUNDING * weight.shape[-1] * value.max(axis=-1, initial=0.0, keepdims=True)
    return unit[..., :, None] * vector * np.sqrt(np.where(value > least, value, 0.0))[..., None, :]
