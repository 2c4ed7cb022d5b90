"""The two-link arm lumped into a chain of rigid segments on hinges, for engines without our beam coordinates.

Each link becomes n segments; a hinge between two segments of one link carries the spring E I / (link length / n). With
n = 3 the chain has six degrees of freedom, as many as the arm with two modes a link. Joint 2's mass and the payload
belong to the segment that they end.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from pliant.plants import TwoLinkArm

SEGMENTS = 3  # of a link
STEP = 2e-3  # [s]
GRAVITY = 9.81  # [m/s^2]
START = (-1.2, 0.0, 0.0, 0.3, 0.0, 0.0)  # joint angles [rad], at rest


@dataclass(frozen=True)
class Segment:
    """A rigid body on a hinge at its origin, along x."""

    length: float  # [m]
    mass: float  # [kg]
    centre: float  # of mass, along x [m]
    inertia: float  # about the centre of mass, about z [kg m^2]
    stiffness: float  # of the hinge at its root [N m/rad], 0 where a motor drives it
    driven: bool


def with_end(segment: Segment, mass: float, inertia: float) -> Segment:
    """The segment with a body of `mass` and `inertia` at its end."""
    total = segment.mass + mass
    centre = (segment.mass * segment.centre + mass * segment.length) / total
    about = segment.inertia + segment.mass * (segment.centre - centre) ** 2
    about += inertia + mass * (segment.length - centre) ** 2
    return Segment(segment.length, total, centre, about, segment.stiffness, segment.driven)


@cache
def segments() -> tuple[Segment, ...]:
    """The chain of TwoLinkArm.textbook()."""
    arm, found = TwoLinkArm.textbook(), []
    ends = ((arm.joint_mass, 0.0), (arm.payload.mass, arm.payload.inertia))
    for link, end in zip((arm.link1, arm.link2), ends):
        length = link.length / SEGMENTS
        mass = link.density * link.area * length
        for k in range(SEGMENTS):
            stiffness = link.E * link.I_z / length if k else 0.0
            found.append(Segment(length, mass, length / 2, mass * length**2 / 12, stiffness, k == 0))
        found[-1] = with_end(found[-1], *end)
    return tuple(found)


def mujoco_xml() -> str:
    """The chain for MuJoCo: RK4, nothing that can touch, no constraints, dense Jacobian (the fastest found)."""
    opened, hinge = "", '<joint name="joint{0}" type="hinge" axis="0 0 1" stiffness="{1!r}"/>'
    offset = 0.0
    for i, s in enumerate(segments()):
        opened += f'<body pos="{offset!r} 0 0">' + hinge.format(i, s.stiffness)
        inertia = " ".join([repr(s.inertia)] * 3)
        opened += f'<inertial pos="{s.centre!r} 0 0" mass="{s.mass!r}" diaginertia="{inertia}"/>'
        offset = s.length
    motors = "".join(f'<motor joint="joint{i}"/>' for i, s in enumerate(segments()) if s.driven)
    return (
        f'<mujoco><option timestep="{STEP!r}" integrator="RK4" gravity="0 {-GRAVITY!r} 0" jacobian="dense">'
        '<flag contact="disable" constraint="disable"/></option><compiler angle="radian"/>'
        f"<worldbody>{opened}{'</body>' * len(segments())}</worldbody><actuator>{motors}</actuator></mujoco>"
    )


def exudyn_system(mbs: object) -> int:
    """Add the chain to an Exudyn system as a kinematic tree in minimal coordinates; returns the tree's number."""
    import exudyn as exu
    from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree

    parts, n = segments(), len(segments())
    offsets = [0.0, *(s.length for s in parts[:-1])]
    node = mbs.AddNode(  # type: ignore[attr-defined]
        NodeGenericODE2(
            referenceCoordinates=[0.0] * n,
            initialCoordinates=list(START),
            initialCoordinates_t=[0.0] * n,
            numberOfODE2Coordinates=n,
        )
    )
    tree = mbs.AddObject(  # type: ignore[attr-defined]
        ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[exu.JointType.RevoluteZ] * n,
            linkParents=list(range(-1, n - 1)),
            jointTransformations=exu.Matrix3DList([np.eye(3)] * n),
            jointOffsets=exu.Vector3DList([[x, 0, 0] for x in offsets]),
            linkInertiasCOM=exu.Matrix3DList([np.diag([s.inertia] * 3) for s in parts]),
            linkCOMs=exu.Vector3DList([[s.centre, 0, 0] for s in parts]),
            linkMasses=[s.mass for s in parts],
            gravity=[0, -GRAVITY, 0],
            jointForceVector=[0.0] * n,
            jointPControlVector=[s.stiffness for s in parts],
            jointDControlVector=[0.0] * n,
            jointPositionOffsetVector=[0.0] * n,
            jointVelocityOffsetVector=[0.0] * n,
        )
    )
    mbs.Assemble()  # type: ignore[attr-defined]
    return int(tree)
