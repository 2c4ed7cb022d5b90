"""Light on a surface that reflects, by hand (Wertz, 1978, Eq (17-18)), on its front and on its back."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.environment import Environment, Orbit, Sun, Surface
from pliant.plants.spacecraft_parts.hub import Hub

CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")


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


def test_sunlight_by_hand():
    """A black plate face on, and a mirror at 45 degrees, on a hub without spin."""
    sun = Environment(sun=Sun(direction=(1.0, 0.0, 0.0), pressure=1e-3))

    def push(**surface):
        hub = Hub(mass=10.0, inertia=(1.0, 1.0, 1.0), surfaces=(Surface(area=2.0, **surface),))
        craft = FlexibleSpacecraft(hub=hub, environment=sun)
        return craft.dynamics(craft.state())

    at = FlexibleSpacecraft(hub=CRAFT.hub).layout
    a = push(normal=(1.0, 0.0, 0.0), centre=(0.0, 0.5, 0.0))
    np.testing.assert_allclose(a[at.velocity], [-2e-4, 0, 0], atol=1e-18)
    np.testing.assert_allclose(a[at.omega], [0, 0, 1e-3], atol=1e-18)
    s = np.sqrt(0.5)
    a = push(normal=(s, s, 0.0), specular=1.0)
    np.testing.assert_allclose(a[at.velocity], [-2e-4 * s, -2e-4 * s, 0], atol=1e-18)
    assert not push(normal=(-1.0, 0.0, 0.0)).any()
    np.testing.assert_allclose(push(normal=(-1.0, 0.0, 0.0), both=True)[at.velocity], [-2e-4, 0, 0], atol=1e-18)


def test_orbit_by_hand(busy):
    """A point mass keeps Hill's equations near the orbit; the environment switched off leaves a free body."""
    n, craft = 1.1e-3, FlexibleSpacecraft(hub=CRAFT.hub, environment=Environment(orbit=Orbit(rate=1.1e-3)))
    x = craft.state(position_x=10.0, position_y=-20.0, position_z=30.0, velocity_x=0.1, velocity_y=0.2, velocity_z=-0.3)
    a = craft.dynamics(x)[craft.layout.velocity]
    hill = [2 * n * -0.3, -(n**2) * -20.0, 3 * n**2 * 30.0 - 2 * n * 0.1]  # x along the velocity, z down
    np.testing.assert_allclose(a, hill, atol=1e-9)
    still = dataclasses.replace(busy(), environment=Environment())
    x = still.state(rate_z=0.0)
    assert not still.dynamics(x).any()


BAD_ENVIRONMENT = {
    "sun": (lambda: Sun(direction=(1.0, 1.0, 0.0)), r"Sun\.direction = .* must be a unit vector"),
    "surface": (
        lambda: Surface(area=1.0, normal=(1.0, 0, 0), specular=0.7, diffuse=0.7),
        r"specular \+ diffuse = 1\.4 must be <= 1",
    ),
    "orbit": (lambda: Orbit(rate=-1.0), r"Orbit\.rate = -1\.0 must be > 0 \[rad/s\]"),
}


@pytest.mark.parametrize("name", BAD_ENVIRONMENT)
def test_bad_input(name):
    make, words = BAD_ENVIRONMENT[name]
    with pytest.raises(ValueError, match=words):
        make()
