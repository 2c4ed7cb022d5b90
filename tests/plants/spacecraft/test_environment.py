"""Light on a surface that reflects, by hand (Wertz, 1978, Eq (17-18)), on its front and on its back."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants.spacecraft.environment import Surface


def force(surface, sun, pressure=2.0):
    return np.array(ca.DM(ca.evalf(surface.force(ca.SX(ca.DM(sun)), pressure)))).ravel()


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.2])
def test_reflection_by_hand(angle):
    """-P A cos((1 - s) sun + 2 (s cos + d / 3) normal)."""
    sun, normal = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([1.0, 0.0, 0.0])
    front = Surface(area=3.0, normal=(1.0, 0.0, 0.0), specular=0.3, diffuse=0.2)
    c = np.cos(angle)
    wanted = -2.0 * 3.0 * c * (0.7 * sun + 2 * (0.3 * c + 0.2 / 3) * normal)
    np.testing.assert_allclose(force(front, sun), wanted, atol=1e-14)
    np.testing.assert_array_equal(force(front, -sun), 0.0)


def test_two_bright_sides_are_two_surfaces():
    options = {"area": 3.0, "specular": 0.3, "diffuse": 0.2}
    one, other = (Surface(normal=(s, 0.0, 0.0), **options) for s in (1.0, -1.0))
    both = Surface(normal=(1.0, 0.0, 0.0), both=True, **options)
    rng = np.random.default_rng(0)
    for sun in rng.normal(size=(20, 3)):
        sun = sun / np.linalg.norm(sun)
        np.testing.assert_allclose(force(both, sun), force(one, sun) + force(other, sun), atol=1e-14)
