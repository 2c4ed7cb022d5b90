"""Multi-blade coordinates, held against a rotor on a soft support by hand."""

import numpy as np
import pytest

from pliant.plants.periodic import multi_blade, multi_blade_model


@pytest.mark.parametrize("blades", [1, 2, 3, 4, 5, 8])
def test_columns_are_orthogonal_and_slopes_their_derivative(blades):
    T, S = multi_blade(blades, 0.7)
    gram = T.T @ T
    assert gram == pytest.approx(np.diag(np.diagonal(gram)), abs=1e-12)
    assert np.diagonal(gram)[0] == pytest.approx(blades)
    assert (
        pytest.approx((multi_blade(blades, 0.7 + 1e-6)[0] - multi_blade(blades, 0.7 - 1e-6)[0]) / 2e-6, abs=1e-8) == S
    )


def rotor(angle, speed, blades=3):
    """Coleman's: a hub on springs in x, y, and lagging blades (mass 1, hinge at the hub, arm 1, spring k); linear."""
    m, M0, k, kx = 1.0, 4.0, 3.0, 50.0
    psi = angle + 2 * np.pi * np.arange(blades) / blades
    n = 2 + blades
    M, D, K = np.diag([M0 + blades * m] * 2 + [m] * blades), np.zeros((n, n)), np.diag([kx, kx] + [k] * blades)
    for b, p in enumerate(psi):  # a blade's mass at r (cos, sin) + lag (-sin, cos), r = 1
        c = np.array([-np.sin(p), np.cos(p)])
        dc, ddc = speed * np.array([-np.cos(p), -np.sin(p)]), -(speed**2) * c
        M[:2, 2 + b], M[2 + b, :2] = m * c, m * c
        D[:2, 2 + b], K[:2, 2 + b] = 2 * m * dc, m * ddc
    return M, D, K


def test_a_rotor_on_an_even_support_is_constant():
    for speed in (0.5, 4.0):
        first = multi_blade_model(*rotor(0.3, speed), 3, 0.3, speed)
        for angle in (1.1, 4.0):
            for a, b in zip(first, multi_blade_model(*rotor(angle, speed), 3, angle, speed)):
                assert a == pytest.approx(b, abs=1e-12)
        assert np.abs(rotor(0.3, speed)[2] - rotor(1.1, speed)[2]).max() > 0.1  # in the blades' own it is not


def test_its_roots_are_those_of_floquet():
    """Multipliers over a period by RK4 steps in blade coordinates, against e^(lambda T) of the constant model."""
    from scipy.integrate import solve_ivp

    speed = 4.0
    period = 2 * np.pi / speed

    def rates(t, y):
        M, D, K = rotor(speed * t, speed)
        z = y.reshape(10, 10)
        return np.vstack([z[5:], -np.linalg.solve(M, D @ z[5:] + K @ z[:5])]).ravel()

    run = solve_ivp(rates, (0, period), np.eye(10).ravel(), rtol=1e-11, atol=1e-12, method="DOP853")
    wanted = np.linalg.eigvals(run.y[:, -1].reshape(10, 10))
    M, D, K = multi_blade_model(*rotor(0.0, speed), 3, 0.0, speed)
    A = np.block([[np.zeros((5, 5)), np.eye(5)], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]])
    found = np.exp(np.linalg.eigvals(A) * period)
    assert max(np.abs(wanted - z).min() for z in found) < 1e-7


def test_bad_input():
    with pytest.raises(ValueError, match="blades"):
        multi_blade(0, 0.0)
    with pytest.raises(ValueError, match="angle"):
        multi_blade(3, np.nan)
    with pytest.raises(ValueError, match="blades"):
        multi_blade_model(np.eye(2), np.eye(2), np.eye(2), 3, 0.0, 1.0)
