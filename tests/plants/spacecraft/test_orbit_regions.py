"""Which rigid craft the gravity gradient holds: the library's linear models against the inequalities of DeBra and Delp.

"Rigid body attitude stability and natural frequencies in a circular orbit", J. Astronaut. Sci. 8 (1961). With roll x
along the velocity, pitch y normal to the orbit, yaw z vertical, k_R = (I_y - I_z)/I_x and k_Y = (I_y - I_x)/I_z: no
deviation grows where k_R > k_Y (pitch), k_R k_Y > 0 and 1 + 3 k_R + k_R k_Y > 4 sqrt(k_R k_Y).
"""

import numpy as np
import pytest

from pliant.plants import Environment, FlexibleSpacecraft, Hub, Orbit

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
    while len(seen) < 40:
        I = 10.0 * rng.uniform(0.2, 1.0, 3)
        if 2 * I.max() >= I.sum():  # no body has such moments
            continue
        wanted, slack = held(I)
        if slack < 0.02:
            continue
        assert (growth(I) < 1e-4) == wanted, I
        seen.append(wanted)
    assert sum(seen) >= 5 and len(seen) - sum(seen) >= 5


@pytest.mark.parametrize(("k_r", "k_y", "stable"), [(0.6, 0.3, True), (-0.05, -0.3, True), (-0.6, -0.8, False)])
def test_the_lagrange_and_the_delp_region(k_r, k_y, stable):
    """By ratios: the second lies where the inertia about the pitch is the least (Delp's, by gyroscopic stiffness)."""
    # I_x = 1; I_y - I_z = k_r, I_y - 1 = k_y I_z
    z = (1 - k_r) / (1 - k_y)
    assert (growth(10.0 * np.array([1.0, z + k_r, z])) < 1e-4) == stable == held([1.0, z + k_r, z])[0]
