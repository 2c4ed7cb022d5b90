"""Spacecraft, a vibration and a state that blows up, which the tests of several rooms share."""

import dataclasses

import numpy as np
import pytest
from space_tree import space_tree
from vibrations import Blowing, Vibration

from pliant.plants import Beam
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.appendage import Appendage, Hinge
from pliant.plants.spacecraft_parts.environment import Environment, Orbit, Sun, Surface
from pliant.plants.spacecraft_parts.hub import Hub, Thruster, Wheel

BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8)
CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")


def _hinged(craft=CRAFT, **hinge):
    """The reference spacecraft with both booms hinged about their y."""
    options = {"axes": ((0.0, 1.0, 0.0),), "stiffness": 100.0, **hinge}
    parts = tuple(dataclasses.replace(a, hinge=Hinge(**options), damping=0.005) for a in craft.appendages)
    return dataclasses.replace(craft, appendages=parts)


def _busy(kinematics="stiffened", drive="torque", **changes):
    """Wheels, thrusters, two-axis hinges, sunlight and an orbit all at once."""
    hinge = Hinge(axes=((0.0, 1.0, 0.0), (0.6, 0.0, 0.8)), stiffness=(100.0, 50.0), damping=2.0, drive=drive)
    plate = Surface(area=4.0, normal=(0.0, 0.0, 1.0), specular=0.3, diffuse=0.2, both=True)
    parts = tuple(dataclasses.replace(a, hinge=hinge, damping=0.01, surface=plate) for a in CRAFT.appendages)
    hub = Hub(
        mass=500.0,
        inertia=((200.0, 5.0, -3.0), (5.0, 150.0, 2.0), (-3.0, 2.0, 180.0)),
        wheels=(Wheel(axis=(1.0, 0.0, 0.0), inertia=0.1, friction=1e-3), Wheel(axis=(0.0, 0.6, 0.8), inertia=0.2)),
        thrusters=(Thruster(position=(0.5, 0.2, 0.0), direction=(0.0, 0.0, 1.0)),),
        surfaces=(Surface(area=2.0, normal=(1.0, 0.0, 0.0), centre=(0.5, 0.1, 0.0)),),
    )
    outside = Environment(
        orbit=Orbit(rate=1.1e-3),
        sun=Sun(direction=(0.0, 0.6, 0.8)),
        dipole=(1.0, 2.0, 0.5),
        magnetic_field=(2e-5, 0.0, 3e-5),
        torque=(1e-5, 0.0, 0.0),
    )
    made = FlexibleSpacecraft(hub=hub, appendages=parts, kinematics=kinematics, environment=outside)
    return dataclasses.replace(made, **changes)


def _anywhere(craft, seed=0, size=0.1):
    """A random state."""
    rng = np.random.default_rng(seed)
    x = size * rng.normal(size=craft.nx)
    x[craft.layout.quaternion] = rng.normal(size=4)
    x[craft.layout.quaternion] /= np.linalg.norm(x[craft.layout.quaternion])
    return x


def _ring(count):
    """A hub with booms of four modes around it."""
    parts = []
    for k in range(count):
        c, s = np.cos(0.3 * k), np.sin(0.3 * k)
        turn = ((c, -s, 0), (s, c, 0), (0, 0, 1))
        parts.append(Appendage(position=(c, s, 0.1 * k), orientation=turn, body=BOOM, modes=(2, 2)))
    return FlexibleSpacecraft(hub=CRAFT.hub, appendages=tuple(parts))


@pytest.fixture(scope="session", name="hinged")
def hinged_fixture():
    return _hinged


@pytest.fixture(scope="session", name="busy")
def busy_fixture():
    return _busy


@pytest.fixture(scope="session", name="anywhere")
def anywhere_fixture():
    return _anywhere


@pytest.fixture(scope="session", name="ring")
def ring_fixture():
    return _ring


@pytest.fixture
def vibration():
    return Vibration()


@pytest.fixture
def blowing():
    return Blowing()


@pytest.fixture(scope="session", name="space")
def space_fixture():
    """Beams and sliders in space, nothing of them aligned."""
    return space_tree
