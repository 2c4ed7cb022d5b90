"""The plants that every shared test must pass: a new plant joins by adding its variants to PLANTS."""

import dataclasses

from pliant.plants import (
    ElasticJoint,
    FlexibleTree,
    Joint,
    LargeDeflectionBeam,
    Payload,
    SingleLinkArm,
    SliderCrank,
    TreeBody,
    TwoLinkArm,
)
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.appendage import Hinge
from pliant.plants.spacecraft_parts.environment import Environment, Orbit
from pliant.plants.spacecraft_parts.hub import Hub, Thruster, Wheel

ARM = TwoLinkArm.textbook()
LINK = SingleLinkArm.textbook()
BEAM = LargeDeflectionBeam.textbook()
CRANK = SliderCrank.textbook()
CRAFT = FlexibleSpacecraft.textbook()


def two(**changes):
    return dataclasses.replace(ARM, **changes)


def one(**changes):
    return dataclasses.replace(LINK, **changes)


def damped(beam):
    return dataclasses.replace(beam, damping=3e-4)


def large(**changes):
    return dataclasses.replace(BEAM, **changes)


def crank(**changes):
    return dataclasses.replace(CRANK, **changes)


def craft(drive="torque", outside=None, **changes):
    """The textbook spacecraft with two-axis hinges, wheels and a thruster."""
    hinge = Hinge(axes=((0.0, 1.0, 0.0), (0.6, 0.0, 0.8)), stiffness=(100.0, 50.0), damping=2.0, drive=drive)
    parts = tuple(dataclasses.replace(a, hinge=hinge, damping=0.01, modes=1) for a in CRAFT.appendages)
    hub = Hub(
        mass=500.0,
        inertia=((200.0, 5.0, -3.0), (5.0, 150.0, 2.0), (-3.0, 2.0, 180.0)),
        wheels=(Wheel(axis=(1.0, 0.0, 0.0), inertia=0.1, friction=1e-3), Wheel(axis=(0.0, 0.6, 0.8), inertia=0.2)),
        thrusters=(Thruster(position=(0.5, 0.2, 0.0), direction=(0.0, 0.0, 1.0)),),
    )
    outside = Environment(torque=(0.1, 0.0, 0.2)) if outside is None else outside
    return FlexibleSpacecraft(hub=hub, appendages=parts, environment=outside, **changes)


def tree(**changes):
    """A beam on an elastic joint and a rigid slider, in space."""
    gear = ElasticJoint(stiffness=500.0, damping=0.1, ratio=20.0, rotor_inertia=1e-3)
    bodies = [
        TreeBody(name="boom", joint=Joint(name="j1", elastic=gear), inertia=0.1, beam=ARM.link1, modes=(1, 1, 0, 0)),
        TreeBody(
            name="hand", joint=Joint(name="j2", axis=(0.0, 0.6, 0.8)), mass=0.3, centre=(0.2, 0.0, 0.1), inertia=0.02
        ),
    ]
    return FlexibleTree.serial(bodies, **changes)


HUBS = {"hub_inertia": (0.1, 0.02)}
OFFSET = Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.04, 0.0))

ARMS = {
    "two": ARM,
    "two no slope": two(tip_slope=False),
    "two hubs": two(**HUBS),
    "two polynomial": two(basis="polynomial"),
    "two stiffened": two(basis="polynomial", kinematics="stiffened", modes=(1, 2)),
    "two payload": two(basis="payload", modes=(2, 1)),
    "two offset": two(payload=OFFSET, kinematics="stiffened", basis="polynomial", modes=(1, 1)),
    "two strain": two(basis="polynomial", kinematics="strain", payload=OFFSET, modes=(1, 1)),
    "two one-sided": two(modes=(0, 2)),
    "two rigid-inertia": two(reduction="rigid-inertia", **HUBS),
    "two rigid-coupling": two(reduction="rigid-coupling"),
    "two rigid": two(reduction="rigid"),
    "two damped": two(
        link1=damped(ARM.link1), link2=damped(ARM.link2), joint_friction=(0.2, 0.1), modes=(2, 1), **HUBS
    ),
    "one": LINK,
    "one rigid": one(kinematics="rigid"),
    "one linear": one(kinematics="linear", basis="clamped-free", modes=3),
    "one gravity": one(basis="polynomial", gravity=9.81),
    "one offset": one(payload=OFFSET, modes=1),
    "one driven": one(drive="motion"),
    "one timoshenko": one(theory="timoshenko", modes=2),
    "one strain": one(kinematics="strain", payload=OFFSET, hub_radius=0.1, modes=1),
    "one strain sheared": one(kinematics="strain", theory="timoshenko"),
    "one pinned": one(frame="pinned", payload=OFFSET, hub_radius=0.1),
    "one damped": one(link=damped(LINK.link), hub_friction=0.1),
}
OTHERS = {
    "large": BEAM,
    "large hinged": large(root="hinged", modes=2, payload=Payload(mass=0.3)),
    "large driven": large(root="driven", modes=2),
    "large chain": large(kinematics="substructured", segments=2, modes=2),
    "large space": large(planar=False, modes=1),
    "tree": tree(),
    "tree rigid": tree(kinematics="rigid"),
    "crank": CRANK,
    "crank free": crank(crank_speed=None, modes=1),
    "crank rigid": crank(kinematics="rigid", crank_speed=None),
    "crank frame": crank(basis="frame-elements", modes=2),
}
CRAFTS = {
    "craft": CRAFT,
    "craft rigid": craft(kinematics="rigid"),
    "craft linear": craft("motion", kinematics="linear"),
    "craft hinged": craft(),
    "craft turning": craft("angle", translation=False),
    "craft orbit": craft(outside=Environment(orbit=Orbit(rate=1.1e-3), dipole=(9.0, 0.0, 0.0))),
    "craft bare": dataclasses.replace(CRAFT, appendages=()),
}
LAGRANGIAN = ARMS | OTHERS
PLANTS = LAGRANGIAN | CRAFTS
# What these vary, others vary beside something else: in `make campaign` alone.
SELDOM = {
    *("two no slope", "two polynomial", "two one-sided", "two rigid-inertia", "two rigid-coupling"),
    *(
        "one linear",
        "one gravity",
        "one driven",
        "one strain sheared",
        "large hinged",
        "large driven",
        "crank rigid",
        "tree rigid",
    ),
    *("craft linear", "craft bare", "tree rigid"),
}
DAMPED = ("two damped", "one damped")
UNDAMPED = tuple(name for name in ARMS if name not in DAMPED)
