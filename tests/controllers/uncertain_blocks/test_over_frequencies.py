"""Bounds over all frequencies: Doyle's satellite, the two carts of the ACC benchmark, one block."""

import numpy as np
import pytest
import scipy.signal as signal
from evidence import agrees

from pliant.controllers.solvers.hinf_norm import peak
from pliant.controllers.uncertain_blocks.blocks import Block
from pliant.controllers.uncertain_blocks.fractional_form import FractionalForm, fitted
from pliant.controllers.uncertain_blocks.over_frequencies import bound

SPIN = 10.0  # Doyle's satellite: a = 10, K = I, each input times 1 + delta


def satellite(delta):
    A, C = np.array([[0.0, SPIN], [-SPIN, 0.0]]), np.array([[1.0, SPIN], [-SPIN, 1.0]])
    return A - np.diag(1 + np.asarray(delta)) @ C


def carts():
    """Two carts and a spring, 1 +- 20 % each, under 100 ((s + 1)/(0.001 s + 1))^3 from the second to the first."""
    Ac, Bc, Cc, Dc = signal.tf2ss(100 * np.poly([-1, -1, -1]), 1e-9 * np.poly([-1000] * 3))
    A, B = np.zeros((7, 7)), np.zeros((7, 3))
    spring = np.zeros(7)
    spring[0], spring[1] = 1, -1
    A[0, 2] = A[1, 3] = 1
    A[2], A[3] = -np.r_[0, Dc[0, 0], 0, 0, Cc[0]] - spring, spring
    A[4:, 4:], A[4:, 1] = Ac, Bc[:, 0]
    B[2], B[3] = [-0.2, 0, -0.2], [0, -0.2, 0.2]
    D = np.vstack([B[2], B[3], np.zeros(3)])
    return FractionalForm(A, B, np.vstack([A[2], A[3], spring]), D, (Block("real"),) * 3)


def test_doyles_satellite():
    """delta_1 = -delta_2 = 1/sqrt(1 + a^2) ends it (Zhou, Doyle and Glover 1996, section 9.4): real mu at 0 alone."""
    form = fitted(satellite, 2)
    assert form.left < 1e-12
    found = bound(form, 5.0)
    agrees(
        found.beta,
        np.sqrt(1 + SPIN**2),
        within=3e-3,
        of="robust_stability",
        what="bound of real mu of Doyle's satellite",
        source="Zhou, Doyle and Glover (1996), section 9.4",
        kind="closed form",
    )
    assert found.omega == 0
    assert found.beta >= np.sqrt(1 + SPIN**2)


def test_carts_of_the_benchmark():
    """MathWorks, "Robust stability and worst-case gain of uncertain system": 2.8826 to 2.8864, at 575 rad/s."""
    found = bound(carts(), 0.3)
    assert 2.8826 * 0.998 < 1 / found.beta < 2.8864
    told = {"of": "robust_stability", "source": "MATLAB's Robust Control Toolbox, example", "kind": "other program"}
    agrees(1 / found.beta, 2.8826, within=2e-3, what="stability margin of two carts, lower bound", **told)
    agrees(found.omega, 575.0, within=0.02, what="the frequency [rad/s] at which it is attained", **told)


@pytest.mark.parametrize("dt", [None, 0.1])
def test_one_full_block_is_the_norm(dt):
    rng = np.random.default_rng(3)
    A = rng.normal(size=(4, 4))
    A = A - (np.linalg.eigvals(A).real.max() + 0.3) * np.eye(4) if dt is None else 0.9 * A / np.linalg.norm(A, 2)
    B, C, D = rng.normal(size=(4, 2)), rng.normal(size=(2, 4)), 0.1 * rng.normal(size=(2, 2))
    norm = peak(A, B, C, D, dt).value
    found = bound(FractionalForm(A, B, C, D, (Block("full", 2),), dt), norm / 3)
    assert norm <= found.beta <= 1.003 * norm
