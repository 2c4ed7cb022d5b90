"""The integrals of |c Phi(t, s) E(s)|, against SciPy's quadrature of matrix exponentials and closed forms."""

import numpy as np
import pytest
from horizon_models import constant, made
from scipy.integrate import trapezoid
from scipy.linalg import expm

from pliant.plants.finite_horizon import finite_horizon
from pliant.plants.finite_horizon.pushed_moduli import pushed_moduli

SOFT = np.array([[0.0, 1.0, 0.0], [-30.0, -0.4, 2.0], [0.5, 0.0, -1.0]])
INTO = np.array([[0.0, 0.1], [1.0, 0.0], [0.0, 1.0]])


def test_of_a_constant_model_at_times_of_any_order_of_beginning():
    """By the trapezoidal rule on 20,001 exponentials; some rows begin within a chain, one twice, one at the end."""
    on = finite_horizon(constant(SOFT.tolist(), INTO.tolist(), [[1.0, 0.0, 0.0], [0.0, 0.3, 1.0]], 3.0))._on
    at = np.array([7, 7, 150, 151, 399, len(on.h)])
    found = pushed_moduli(on, at, on.nodes[1][at])
    step, C = expm(SOFT * 3.0 / 20_000), on.nodes[1][0]
    later = [C @ INTO * on.nodes[0][0, 1, 0]]
    moved = C
    for _ in range(20_000):
        moved = moved @ step
        later.append(moved @ INTO * on.nodes[0][0, 1, 0])
    size = np.abs(np.array(later))
    fine = np.linspace(0.0, 3.0, 20_001)
    for k, end in enumerate(at):
        count = np.searchsorted(fine, on.t[end] * (1 + 1e-12), side="right")
        true = trapezoid(size[:count], fine[:count], axis=0)
        assert (found[k] >= true * (1 - 1e-2) - 1e-9).all() and (found[k] <= true * 1.02 + 1e-4 * size.max()).all()


@pytest.mark.parametrize("slow", [1.0, 1e-4])
def test_stretches_that_share_an_exponent_push_as_the_others_do(slow):
    """A swing of 60 rad/s beside a slow one; at 1e-4 of the change of A stretches share exponents."""
    t = np.linspace(0.0, 20.0, 401)
    A = np.zeros((401, 10, 10))
    for k in range(5):
        w = 2.0 + k if k else 600.0
        A[:, 2 * k, 2 * k + 1], A[:, 2 * k + 1, 2 * k], A[:, 2 * k + 1, 2 * k + 1] = 1.0, -(w**2), -0.2
    A[:, 3, 2] -= 0.5 * slow * np.sin(t)
    E, C = np.zeros((401, 10, 1)), np.zeros((401, 1, 10))
    E[:, 1::2, 0], C[:, 0, 2::2] = 1.0, 1.0
    on = finite_horizon(made(t, A, E, C, np.zeros((401, 1, 1))))._on
    assert on.alike and len(on.moves[0]) < len(on.h) / 2
    last = np.array([len(on.h)])
    found = pushed_moduli(on, last, on.nodes[1][last])[0, 0, 0]
    Phi, Gamma = on.held
    moved, total = on.nodes[1][-1, 0], 0.0
    for k in range(len(on.h) - 1, -1, -1):
        total += abs(float(moved @ Gamma[k, :, 0]))
        moved = moved @ Phi[k]
    assert total * (1 - 1e-12) <= found <= 1.02 * total
