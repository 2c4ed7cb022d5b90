"""Which rigid craft the gravity gradient holds: the library's linear models against the inequalities of DeBra and Delp.

"Rigid body attitude stability and natural frequencies in a circular orbit", J. Astronaut. Sci. 8 (1961). With roll x
along the velocity, pitch y normal to the orbit, yaw z vertical, k_R = (I_y - I_z)/I_x and k_Y = (I_y - I_x)/I_z: no
deviation grows where k_R > k_Y (pitch), k_R k_Y > 0 and 1 + 3 k_R + k_R k_Y > 4 sqrt(k_R k_Y).
"""

import numpy as np
import pytest

from pliant.plants import Environment, FlexibleSpacecraft, Hub, Orbit
from pliant.plants.stability import floquet

RATE = 0.0011  # [rad/s]


def growth(I):
    """Largest real part [1/s] of the roots about the attitude at rest in the orbit's axes, of RATE."""
    hub = Hub(mass=100.0, inertia=tuple(map(tuple, np.diag(I))))
    orbit = Environment(orbit=Orbit(rate=RATE))
    craft = FlexibleSpacecraft(hub=hub, appendages=(), translation=False, environment=orbit)
    model = craft.linearize(craft.state({"rate_y": -RATE}), np.zeros(craft.nu))
    assert np.abs(model.f0).max() < 1e-12
    return float(np.linalg.eigvals(model.A).real.max()) / RATE


def held(I):
    """The inequalities, and how far the nearest is from its edge."""
    x, y, z = I
    kr, ky = (y - z) / x, (y - x) / z
    roots = 1 + 3 * kr + kr * ky - 4 * np.sqrt(max(kr * ky, 0.0))
    slack = np.array([kr - ky, kr * ky, roots])
    return bool((slack > 0).all()), float(np.abs(slack).min())


def test_debra_and_delp():
    rng, seen = np.random.default_rng(5), []
    while len(seen) < 24:
        I = 10.0 * rng.uniform(0.2, 1.0, 3)
        if 2 * I.max() >= I.sum():  # no body has such moments
            continue
        wanted, slack = held(I)
        if slack < 0.02:
            continue
        assert (growth(I) < 1e-4) == wanted, I
        seen.append(wanted)
    assert sum(seen) >= 2 and len(seen) - sum(seen) >= 2


@pytest.mark.parametrize(("k_r", "k_y", "stable"), [(0.6, 0.3, True), (-0.05, -0.3, True), (-0.6, -0.8, False)])
def test_the_lagrange_and_the_delp_region(k_r, k_y, stable):
    """By ratios: the second lies where the inertia about the pitch is the least (Delp's, by gyroscopic stiffness)."""
    # I_x = 1; I_y - I_z = k_r, I_y - 1 = k_y I_z
    z = (1 - k_r) / (1 - k_y)
    assert (growth(10.0 * np.array([1.0, z + k_r, z])) < 1e-4) == stable == held([1.0, z + k_r, z])[0]


def spun(J, alpha):
    """Largest growth [RATE] of a symmetric craft that spins about the orbit's normal, alpha RATE faster than the orbit.

    C/A = J. By hand, n the axis in the orbit's axes, b = J (1 + alpha), K = 3 (J - 1), times in 1/RATE:
    n_z'' + (b - 2) n_x' + (b - 1 + K) n_z = 0, n_x'' - (b - 2) n_z' + (b - 1) n_x = 0 (Thomson 1962; Likins 1965 and
    Pringle 1966): no growth where p > 0, q > 0 and p^2 > 4 q, p = 2b - 2 + K + (b - 2)^2, q = (b - 1)(b - 1 + K).
    """
    b, K = J * (1 + alpha), 3 * (J - 1)
    p, q = 2 * b - 2 + K + (b - 2) ** 2, (b - 1) * (b - 1 + K)
    squares = np.roots([1.0, p, q])
    return float(np.abs(np.sqrt(squares.astype(complex)).real).max()), p > 0 and q > 0 and p**2 > 4 * q


def spun_growth(J, alpha):
    """The same by Floquet's multipliers of the library's model along the spin."""
    A = 10.0
    hub = Hub(mass=100.0, inertia=((A, 0.0, 0.0), (0.0, J * A, 0.0), (0.0, 0.0, A)))
    orbit = Environment(orbit=Orbit(rate=RATE))
    craft = FlexibleSpacecraft(hub=hub, appendages=(), translation=False, environment=orbit)
    period = 2 * np.pi / abs(alpha * RATE)
    start = craft.state({"rate_y": -(1 + alpha) * RATE})
    turn = craft.simulate(start, None, np.linspace(0.0, period, 129), rtol=1e-11, atol=1e-13)
    cycle = floquet(craft.linearize_along(turn), period)
    return float(np.log(np.abs(cycle.multipliers).max()) / period / RATE)


@pytest.mark.parametrize(
    ("J", "alpha"),
    [(1.5, 1.0), (1.5, -2.0), (0.6, 1.2), (0.6, 4.0), (0.3, -3.0), (0.8, -3.0), (1.9, -0.7), (0.5, 2.5)],
)
def test_likins_and_pringle(J, alpha):
    wanted, stable = spun(J, alpha)
    found = spun_growth(J, alpha)
    assert found == pytest.approx(wanted, abs=2e-3)
    assert (found < 5e-3) == stable
