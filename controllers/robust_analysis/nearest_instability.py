"""The smallest box of parameters in which a loop was found unstable: a lower bound of the structured singular value.

Spectral abscissa (or radius less one) of the state matrix over boxes |delta_i| <= k: the largest is looked for from
corners and random points by steps along its slopes, from eigenvectors; k falls to the first instability on the way
there, until no larger is found. What comes back was seen: the state matrix itself has an eigenvalue on the boundary.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np

Array = np.ndarray
StateMatrix = Callable[[Array], Array]
STARTS, STEPS = 40, 25
CORNERS = 6  # parameters of which all corners are tried
SLOPE = 1e-5  # of delta, in its differences
SHRINK = 0.995  # of k, in which the next instability is looked for
MOST = 30  # boxes
ALONG = 40  # points of a ray, so that the first crossing is found


def growth(A: Array, dt: float | None) -> float:
    """[1/s]: of the fastest growing eigenvalue."""
    values = np.linalg.eigvals(A)
    if dt is None:
        return float(values.real.max())
    return float(np.log(max(np.abs(values).max(), 1e-300)) / dt)


def nearest(
    state_matrix: StateMatrix, count: int, dt: float | None, most: float, seed: int = 0
) -> tuple[float, Array] | None:
    """(k, delta (count,) with largest |delta_i| = k) at which the loop is at its limit, k <= most; None: none found."""
    rng = np.random.default_rng(seed)

    def rate(delta: Array) -> float:
        return growth(state_matrix(delta), dt)

    starts = list(np.array(list(product((-1.0, 1.0), repeat=count)))) if count <= CORNERS else []
    starts += list(rng.choice((-1.0, 1.0), (STARTS // 2, count))) if count > CORNERS else []
    starts += list(rng.uniform(-1, 1, (STARTS // 2 if count > 1 else 2, count)))
    ranked = sorted(starts, key=lambda d: -rate(most * d))[: max(4, count)]
    best: tuple[float, Array] | None = None
    for start in ranked:
        k = most if best is None else best[0] * SHRINK
        for _ in range(MOST):
            found = _climb(rate, k * np.clip(start, -1, 1), k)
            if rate(found) <= 0:
                break
            best = first_along(rate, found)
            start, k = best[1] / best[0], best[0] * SHRINK
    return best


def first_along(rate: Callable[[Array], float], delta: Array) -> tuple[float, Array]:
    """The first instability on the ray to delta."""
    from scipy.optimize import brentq

    shares = np.linspace(0, 1, ALONG + 1)
    at = next(i for i, s in enumerate(shares) if rate(s * delta) > 0 or i == ALONG)
    share = brentq(lambda s: rate(s * delta), shares[max(at - 1, 0)], shares[at], xtol=1e-13) if at else 1e-12
    found = share * delta
    return float(np.abs(found).max()), found


def _climb(rate: Callable[[Array], float], delta: Array, k: float) -> Array:
    """Steps along the slope within the box, as long as they gain; ends where it is unstable."""
    now, length = rate(delta), k
    for _ in range(STEPS):
        if now > 0:
            break
        h = SLOPE * k
        slope = np.array([(rate(delta + h * e) - rate(delta - h * e)) / (2 * h) for e in np.eye(len(delta))])
        if not np.abs(slope).max() > 0:
            break
        while length > 1e-4 * k:
            tried = np.clip(delta + length * slope / np.abs(slope).max(), -k, k)
            then = rate(tried)
            if then > now:
                delta, now, length = tried, then, 2 * length
                break
            length /= 2
        else:
            break
    return delta
