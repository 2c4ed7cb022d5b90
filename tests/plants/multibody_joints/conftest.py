"""One body on a joint of any kind, which the tests of this room share."""

import pytest

from pliant.plants import FlexibleTree, Joint, Payload, TreeBody
from pliant.plants.multibody_parts.joint import Sliding

HELD = {
    "damping": 0.3, "friction": 0.2, "friction_rate": 0.3, "stiffness": 2.0, "stop_stiffness": 40.0, "upper": 0.5,
    "stop_width": 0.2,
}  # fmt: skip
KINDS = {
    "revolute": {"lower": -0.4, "rest": 0.2, "axis": (0.6, 0.0, 0.8)},
    "prismatic": {"lower": -0.4, "rest": 0.2},
    "spherical": {},
    "planar": {"lower": -0.4, "sliding": Sliding(lower=-0.3, **HELD), "axis": (0.0, 0.6, 0.8)},
    "free": {"sliding": Sliding(lower=-0.3, **HELD)},
}


@pytest.fixture(scope="session", params=KINDS)
def held(request):
    """A body on a joint with spring, stops, damping and friction, a second one hung on it."""
    joint = Joint(name="j", kind=request.param, rotation=(0.3, -0.2, 0.5), **HELD, **KINDS[request.param])
    bodies = [
        TreeBody(name="a", joint=joint, mass=1.0, centre=(0.1, 0.2, 0), inertia=0.05),
        TreeBody(name="b", joint=Joint(name="k", axis=(0, 1, 0), position=(0.2, 0, 0)), mass=0.4, inertia=0.01),
    ]
    return FlexibleTree.serial(bodies, payload=Payload(mass=0.2, inertia=0.001, offset=(0.1, 0, 0.1)))
