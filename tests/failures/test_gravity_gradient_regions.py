"""A rigid spacecraft in a circular orbit: stable in Lagrange's region and, undamped, in DeBra and Delp's; else not.

Axes 1 roll (velocity), 2 pitch (against the normal), 3 yaw (down); k1 = (I2 - I3)/I1, k3 = (I2 - I1)/I3. Pitch is
stable where k1 > k3; roll and yaw where k1 k3 > 0 and 1 + 3 k1 + k1 k3 > 4 sqrt(k1 k3) (DeBra and Delp 1961).
Lagrange: k1 > k3 > 0.
"""

import numpy as np
import pytest

from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.environment import Environment, Orbit
from pliant.plants.spacecraft_parts.hub import Hub

RATE = 1e-3


def made(gravity=True):
    """A hub with axes along the orbit's; the moments about roll and yaw are inputs p."""
    hub = Hub(mass=100.0, inertia=(90.0, 100.0, 80.0))
    outside = Environment(orbit=Orbit(rate=RATE, gravity=gravity))
    return FlexibleSpacecraft(hub=hub, translation=False, environment=outside).vary(
        "hub.inertia.0.0", "hub.inertia.2.2"
    )


CRAFT, FREE = made(), made(gravity=False)


def roots(craft, k1, k3):
    """Frozen roots over the orbital rate: k1 I1 = I2 - I3, k3 I3 = I2 - I1."""
    p = np.linalg.solve([[k1, 1.0], [1.0, k3]], [100.0, 100.0])
    x = craft.state(rate_y=-RATE)
    assert np.abs(craft.dynamics(x, p=p)).max() < 1e-15
    return craft.linearize(x, p=p).eigenvalues / RATE


def growth(k1, k3):
    return roots(CRAFT, k1, k3).real.max()


def stable(k1, k3):
    """The analytic regions, and the distance from their boundaries."""
    mixed = k1 * k3
    if mixed <= 0:
        return False, min(abs(k1), abs(k3), abs(k1 - k3))
    edge = 1 + 3 * k1 + mixed - 4 * np.sqrt(mixed)
    return k1 > k3 and edge > 0, min(abs(k1 - k3), abs(edge), abs(k1), abs(k3))


def test_the_whole_chart():
    """A grid over the physical square |k| < 1: every verdict as the analytic regions say."""
    seen = {"Lagrange": 0, "DeBra-Delp": 0, "unstable": 0}
    for k1 in np.linspace(-0.93, 0.93, 31):
        for k3 in np.linspace(-0.95, 0.95, 21):
            wanted, distance = stable(k1, k3)
            if distance < 0.01:
                continue
            found = growth(k1, k3)
            assert (found < 1e-4) == wanted, (k1, k3, found)
            seen["unstable" if not wanted else "Lagrange" if k3 > 0 else "DeBra-Delp"] += 1
    assert seen["Lagrange"] > 40
    assert seen["DeBra-Delp"] >= 2
    assert seen["unstable"] > 100


def test_the_debra_delp_boundary():
    """On k1 = -0.1 the boundary in k3 by bisection of the model's growth, against the analytic root."""
    k1 = -0.1
    # 1 + 3 k1 + s^2 = 4 s with s = sqrt(k1 k3): s = 2 - sqrt(4 - (1 + 3 k1))
    s = 2 - np.sqrt(3 - 3 * k1)
    exact = s * s / k1
    low, high = exact * 0.5, exact * 2.0  # towards zero: stable; towards minus one: not
    assert growth(k1, low) < 1e-4 < growth(k1, high)
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if growth(k1, middle) < 1e-5 else (low, middle)
    assert low == pytest.approx(exact, abs=1e-6)


def test_lagrange_boundary_of_pitch():
    """Pitch: theta'' + 3 n^2 (I1 - I3)/I2 theta = 0, beyond the boundary a growth in closed form."""
    for k in (0.2, 0.6):
        assert growth(k + 1e-3, k) < 1e-4
        I1, I3 = np.linalg.solve([[k, 1.0], [1.0, k + 1e-3]], [1.0, 1.0])
        assert growth(k, k + 1e-3) == pytest.approx(np.sqrt(3 * (I3 - I1)), rel=1e-4)


def test_gravity_switched_off_has_no_regions():
    """Without gravity no verdict depends on k1 > k3: roots of pitch at zero."""
    assert np.abs(roots(CRAFT, 0.5, 0.2)).min() > 0.1
    assert np.sort(np.abs(roots(FREE, 0.5, 0.2)))[1] < 1e-6
