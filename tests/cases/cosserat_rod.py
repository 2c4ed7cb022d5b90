"""A clamped elastic rod at rest under a dead force and moment at its tip, by shooting: no shapes, no quadrature.

r' = R (e_1 + R^T n/stiffness), R' = R k~, k = k_rest + R^T m/rigidity, n = F, m(s) = M + (r(L) - r(s)) x F in
inertial axes; the unknown r(L) is where the integration from the root must end.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve


def tip_of_rod(length, rigidity, force, moment=(0.0, 0.0, 0.0), rest=(0.0, 0.0, 0.0), stiffness=None, steps=1):
    """Tip (3,) and its axes (3, 3); rigidity (G J, E I_y, E I_z), stiffness (E A, kappa G A, kappa G A) or None,
    rest curvature (3,) [1/m]. Loads grow in `steps`, from the rod at rest.
    """
    rigidity, rest = np.asarray(rigidity, float), np.asarray(rest, float)
    soft = np.zeros(3) if stiffness is None else 1 / np.asarray(stiffness, float)

    def shot(end, F, M):
        def slope(_, y):
            r, R = y[:3], y[3:].reshape(3, 3)
            k = rest + R.T @ (M + np.cross(end - r, F)) / rigidity
            K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
            onward = np.array([1.0, 0.0, 0.0]) + soft * (R.T @ F)
            return np.concatenate([R @ onward, (R @ K).ravel()])

        start = np.concatenate([np.zeros(3), np.eye(3).ravel()])
        return solve_ivp(slope, (0.0, length), start, method="DOP853", rtol=1e-10, atol=1e-11 * length).y[:, -1]

    end = shot(np.zeros(3), np.zeros(3), np.zeros(3))[:3]
    for k in range(1, steps + 1):
        F, M = (np.asarray(load, float) * k / steps for load in (force, moment))
        end, _, found, why = fsolve(lambda e: shot(e, F, M)[:3] - e, end, xtol=1e-10, full_output=True)  # noqa: B023
        assert found == 1, why
    return end, shot(end, F, M)[3:].reshape(3, 3)
