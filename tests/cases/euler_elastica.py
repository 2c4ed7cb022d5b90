"""A clamped, inextensible beam under a force across its tip, by elliptic integrals.

Source   Bisshopp and Drucker, Quarterly of Applied Mathematics 3 (1945), 272
"""

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc


def elastica(alpha):
    """Tip position (x, y)/L and angle under F L^2/(E I) = alpha, F across the straight beam and dead."""

    def integrals(angle):
        k = np.sqrt((1 + np.sin(angle)) / 2)
        start = np.arcsin(1 / (k * np.sqrt(2)))
        return ellipk(k * k) - ellipkinc(start, k * k), ellipe(k * k) - ellipeinc(start, k * k)

    angle = brentq(lambda a: integrals(a)[0] - np.sqrt(alpha), 1e-9, np.pi / 2 - 1e-12, xtol=1e-15)
    return np.sqrt(2 * np.sin(angle) / alpha), 1 - 2 / np.sqrt(alpha) * integrals(angle)[1], angle
