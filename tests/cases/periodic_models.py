"""Linear models with periodic coefficients, and their monodromy matrices by another integrator."""

import numpy as np
from scipy.integrate import solve_ivp

from pliant.plants import LTVModel


def model_of(t, A, states=None):
    nt, n = len(t), A.shape[-1]
    none = np.zeros((nt, n, 0))
    return LTVModel(
        t,
        A,
        none,
        none,
        np.zeros((nt, 0, n)),
        np.zeros((nt, 0, 0)),
        np.zeros((nt, 0, 0)),
        c=np.zeros((nt, n)),
        x=np.zeros((nt, n)),
        u=np.zeros((nt, 0)),
        y=np.zeros((nt, 0)),
        states=states or tuple(f"x{i + 1}" for i in range(n)),
        inputs=(),
        disturbances=(),
        outputs=(),
    )


def oscillator(stiffness, period, nodes=97, damping=0.0):
    """x'' + 2 d x' + k(t) x = 0."""
    t = np.linspace(0.0, period, nodes)
    A = np.zeros((nodes, 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -stiffness(t), -2 * damping
    return model_of(t, A)


def integrated(A, period, n):
    """Monodromy matrix (n, n) by an adaptive method at a tight tolerance."""
    run = solve_ivp(
        lambda t, y: (A(t) @ y.reshape(n, n)).ravel(),
        (0.0, period),
        np.eye(n).ravel(),
        method="DOP853",
        rtol=1e-12,
        atol=1e-14,
    )
    return run.y[:, -1].reshape(n, n)
