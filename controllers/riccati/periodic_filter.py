"""The Kalman filter of a system that repeats after N steps, for ever: `dplqr`, backwards.

x[k+1] = A_k x[k] + w_k,  y[k] = C_k x[k] + v_k,  w and v white with covariances W_k and V_k, all of period N
S_k+1 = W_k + A_k S_k A_k' - A_k S_k C_k'(V_k + C_k S_k C_k')^-1 C_k S_k A_k'     before the reading
L_k   = S_k C_k'(V_k + C_k S_k C_k')^-1                                          of the innovation

With A', C', W, V and time turned round it is the regulator's equation (duality), and its stabilising solution that one.

Source   Bittanti, Colaneri and De Nicolao, "The difference periodic Riccati equation for the periodic prediction
         problem", 1988
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pliant.plants.core.argument_gates import require_finite
from pliant.plants.core.errors import UncontrollableError

from .periodic import dplqr

Array = np.ndarray


class PeriodicFilter(NamedTuple):
    """Gains and covariances at the N readings of a period.

    Example
    -------
    >>> A, C = np.ones((2, 1, 1)), np.ones((2, 1, 1))
    >>> found = dpkalman(A, C, np.eye(1), np.eye(1))
    >>> isinstance(found, PeriodicFilter), found.before.shape
    (True, (2, 1, 1))
    """

    L: Array  # (N, nx, ny) of the innovation
    before: Array  # (N, nx, nx) covariance of the estimate before the reading
    after: Array  # (N, nx, nx) and after it
    multipliers: Array  # (nx,) of the estimate's error over a period, largest first


def dpkalman(A: Any, C: Any, W: Any, V: Any) -> PeriodicFilter:
    """A (N, nx, nx), C (N, ny, nx); W (nx, nx) >= 0, V (ny, ny) > 0, the same at every step or with a leading N.

    ValueError names the step of a wrong covariance; UncontrollableError where an error does not decay that the readings
    do not see, or that the noise does not drive.

    Example
    -------
    >>> A, C = np.tile([[1.0, 0.1], [0.0, 1.0]], (2, 1, 1)), np.array([[[1.0, 0.0]], [[0.0, 1.0]]])
    >>> dpkalman(A, C, 0.01 * np.eye(2), np.eye(1)).L.shape
    (2, 2, 1)
    """
    A = require_finite("A", A, (-1, -1, -1))
    N, nx = A.shape[:2]
    C = require_finite("C", C, (N, -1, nx))
    ny = C.shape[1]
    W, V = _each("W", W, (N, nx, nx)), _each("V", V, (N, ny, ny))
    try:  # step j of the regulator is N - 1 - j of the filter
        found = dplqr(*(np.ascontiguousarray(M[::-1]) for M in (_t(A), _t(C), W, V)))
    except UncontrollableError as failure:
        raise UncontrollableError(
            "dpkalman: an error of the estimate does not decay: the readings do not see it, or the noise does not "
            f"drive it ({failure})",
            failure.modes,
        ) from None
    before = np.roll(found.P[::-1], 1, axis=0)
    L = before @ _t(C) @ np.linalg.inv(V + C @ before @ _t(C))
    kept = np.eye(nx) - L @ C
    after = kept @ before @ _t(kept) + L @ V @ _t(L)
    return PeriodicFilter(L, before, after, found.multipliers)


def _each(name: str, value: Any, shape: tuple[int, ...]) -> Array:
    value = np.asarray(value, dtype=float)
    each = value.ndim == len(shape)
    return np.array(np.broadcast_to(require_finite(name, value, shape if each else shape[1:]), shape))


def _t(M: Array) -> Array:
    return np.swapaxes(M, -1, -2)
