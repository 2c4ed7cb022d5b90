"""Models of A(t) by its nodes, and their transition matrices by an independent method."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pliant.plants import LTVModel
from pliant.plants.linear.lti import LinearModel


def make_model_of(t, A):
    nt, n = len(t), A.shape[-1]
    none = np.zeros((nt, n, 0))
    rows = {k: np.zeros((nt, n if k in "cx" else 0)) for k in ("c", "x", "u", "y")}
    gone = {"C": np.zeros((nt, 0, n)), "D": np.zeros((nt, 0, 0)), "F": np.zeros((nt, 0, 0))}
    names = tuple(f"x{i + 1}" for i in range(n))
    return LTVModel(t, A, none, none, **gone, **rows, states=names, inputs=(), disturbances=(), outputs=())


def make_random_path(n=4, seed=2, duration=3.0, shift=1.0):
    """A smooth A(t) without a period, and its nodes."""
    M0, M1, M2 = np.random.default_rng(seed).standard_normal((3, n, n))

    def A(t):
        return M0 - shift * np.eye(n) + np.sin(t + 0.2 * t**2) * M1 + np.exp(-t) * M2

    t = np.linspace(0.0, duration, 601)
    return A, make_model_of(t, np.array([A(s) for s in t]))


def make_integrated(A, span, n):
    run = solve_ivp(
        lambda t, y: (A(t) @ y.reshape(n, n)).ravel(), span, np.eye(n).ravel(), method="DOP853", rtol=1e-12, atol=1e-13
    )
    return run.y[:, -1].reshape(n, n)


def make_linear(A, dt=None):
    A = np.asarray(A, dtype=float)
    return LinearModel.from_matrices(A, np.zeros((len(A), 0)), dt=dt)


def make_pulsating(damping=0.15, nodes=129):
    t = np.linspace(0.0, np.pi, nodes)
    A = np.zeros((nodes, 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -(2.0 - 0.5 * np.cos(2 * t)), -2 * damping
    return make_model_of(t, A)


@pytest.fixture
def model_of():
    return make_model_of


@pytest.fixture
def random_path():
    return make_random_path


@pytest.fixture
def integrated():
    return make_integrated


@pytest.fixture
def linear():
    return make_linear


@pytest.fixture
def pulsating():
    return make_pulsating
