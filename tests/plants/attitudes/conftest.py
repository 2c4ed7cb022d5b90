"""A free hub with an arm and a ball that hangs on a wall, which the tests of this room share."""

import pytest

from pliant.plants import FlexibleTree, Joint, Payload, TreeBody


@pytest.fixture(scope="session")
def craft():
    """A free rigid base with two bodies, one on a ball joint with a spring."""
    ball = Joint(name="ball", kind="spherical", drive="none", stiffness=2.0, damping=0.1, position=(0.0, 0.3, 0.0))
    bodies = [
        TreeBody(name="arm", joint=Joint(name="arm", axis=(0, 0.6, 0.8)), mass=1.0, centre=(0.4, 0, 0), inertia=0.05),
        TreeBody(name="pod", joint=ball, mass=0.5, centre=(0.1, 0.2, 0), inertia=0.02),
    ]
    return FlexibleTree.serial(bodies, base="free", platform=Payload(mass=4.0, inertia=0.5), gravity=(0, 0, 0))


@pytest.fixture(scope="session")
def pendulum():
    """A rod that hangs on a ball joint."""
    rod = TreeBody(name="rod", joint=Joint(name="ball", kind="spherical"), mass=2.0, centre=(0, 0, -0.5), inertia=0.1)
    return FlexibleTree.serial([rod])
