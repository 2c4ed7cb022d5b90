"""A cantilever boom as frame elements: its mass and stiffness matrices."""

import numpy as np

from pliant.plants import Beam

BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8, damping=0.01)


def frame_matrices(count=20, lumped=True):
    """Mass and stiffness of a cantilever boom of 6-freedom nodes, bending in x-z and x-y, stretching, twisting."""
    h, n = 5.0 / count, count + 1
    K, M = np.zeros((6 * n, 6 * n)), np.zeros((6 * n, 6 * n))
    for e in range(count):
        for t, r, sign, EI in ((2, 4, -1.0, 100.0), (1, 5, 1.0, 400.0)):
            k = (
                EI
                / h**3
                * np.array(
                    [
                        [12, 6 * h, -12, 6 * h],
                        [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                        [-12, -6 * h, 12, -6 * h],
                        [6 * h, 2 * h * h, -6 * h, 4 * h * h],
                    ]
                )
            )
            s = np.diag([1, sign, 1, sign])
            at = [6 * e + t, 6 * e + r, 6 * e + 6 + t, 6 * e + 6 + r]
            K[np.ix_(at, at)] += s @ k @ s
        for t, stiff in ((0, 1e6), (3, 160.0)):
            at = [6 * e + t, 6 * e + 6 + t]
            K[np.ix_(at, at)] += stiff / h * np.array([[1, -1], [-1, 1]])
        for node in (e, e + 1):
            M[6 * node : 6 * node + 3, 6 * node : 6 * node + 3] += h * np.eye(3)
    positions = np.column_stack([np.linspace(0, 5, n), np.zeros(n), np.zeros(n)])
    return M, K, positions
