"""The two-link arm as a chain of rigid segments on hinges, for engines without our beam coordinates.

The chain is that of `pliant.studies.peers.rigid_segments`: with two hinges in each link it has six degrees of freedom,
as many as the arm with two modes a link. Joint 2's mass and the payload belong to the segment that they end.
"""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np

from pliant.envs import scenes
from pliant.plants import TwoLinkArm
from pliant.studies.peers import mujoco_chain, rigid_segments
from pliant.studies.peers.planar_machine import Machine, machine_of
from pliant.studies.peers.programs import Setting
from pliant.studies.peers.rigid_segments import Segment

HINGES = 2  # of a link, besides the joint
STEP = 2e-3  # [s]
START = (-1.2, 0.0, 0.0, 0.3, 0.0, 0.0)  # joint angles [rad], at rest


@cache
def machine() -> Machine:
    """TwoLinkArm.textbook(), without torques."""
    scene = scenes.get("two-link-reach")
    found = machine_of(scene.with_plant(TwoLinkArm.textbook()))
    return dataclasses.replace(found, dt=STEP, held=np.zeros((1, 2)))


@cache
def segments() -> tuple[Segment, ...]:
    """From the root to the tip."""
    return rigid_segments.segments(machine(), HINGES)


def mujoco_xml(integrator: str = "RK4") -> str:
    """The chain for MuJoCo: nothing that can touch, no constraints, dense Jacobian (the fastest found)."""
    return mujoco_chain.xml(machine(), segments(), Setting(HINGES, 1, integrator))


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
            gravity=[*machine().gravity, 0.0],
            jointForceVector=[0.0] * n,
            jointPControlVector=[s.stiffness for s in parts],
            jointDControlVector=[s.damping for s in parts],
            jointPositionOffsetVector=[0.0] * n,
            jointVelocityOffsetVector=[0.0] * n,
        )
    )
    mbs.Assemble()  # type: ignore[attr-defined]
    return int(tree)
