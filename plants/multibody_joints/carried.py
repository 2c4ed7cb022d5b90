"""That every joint moves something: without inertia along a joint's freedoms the equations have no answer."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.plants.beams.payload import Payload
from pliant.plants.core.parameters import is_symbolic
from pliant.plants.multibody_parts.joint import Joint
from pliant.plants.multibody_parts.tree_body import TreeBody

Array = np.ndarray
TURNED = ("revolute", "planar", "spherical", "free")


def _numbers(*values: Any) -> bool:
    return not any(is_symbolic(e) for value in values for e in np.ravel(np.array(value, dtype=object)))


def check_carried(owner: str, bodies: tuple[TreeBody, ...], payload: Payload, holder: str) -> None:
    """ValueError for the first joint that moves neither mass nor inertia, and for a body at the end of the tree, other
    than the payload's `holder`, that has none along its own joint. A joint whose motion is given needs none.
    """
    loaded = payload.mass, payload.inertia
    heavy = {holder} if not _numbers(*loaded) or np.any(np.array(loaded[0]) > 0) or np.any(loaded[1]) else set[str]()
    ends = {b.name for b in bodies} - {b.parent for b in bodies} - heavy
    for k, body in reversed(list(enumerate(bodies))):
        joint = body.joint
        if not body.weightless:
            heavy.add(body.name)
        if body.name in heavy:
            heavy.add(body.parent)
        if not joint.moves or joint.drive == "acceleration" or is_symbolic(joint.armature) or joint.armature > 0:
            continue
        if body.name not in heavy:
            raise ValueError(
                f"{owner}.bodies[{k}].mass = {body.mass!r} of body {body.name!r}, which joint {joint.name!r} moves "
                "with nothing heavier beyond it, must be > 0 [kg]"
            )
        if body.name in ends and not body.bends and _numbers(body.mass, body.centre, body.inertia):
            _check_end(f"{owner}.bodies[{k}]", body, joint)


def _check_end(name: str, body: TreeBody, joint: Joint) -> None:
    """Of one body alone on its joint."""
    if joint.kind not in ("revolute", "spherical") and not body.mass > 0:
        raise ValueError(
            f"{name}.mass = {body.mass!r} of body {body.name!r} must be > 0 [kg]: joint {joint.name!r} shifts it"
        )
    if joint.kind not in TURNED:
        return
    m, c = float(body.mass), np.array(body.centre, dtype=float)
    own = np.array(body.inertia, dtype=float)
    J = own if own.ndim else own * np.eye(3)
    if joint.kind != "free":  # which shifts as well, so that the mass centre may be the point that it turns about
        J = J + m * (c @ c * np.eye(3) - np.outer(c, c))
    e = np.array(joint.axis)
    moment = float(e @ J @ e) if joint.kind == "revolute" else float(np.linalg.eigvalsh(J)[0])
    if joint.kind == "planar":
        moment = float(e @ own @ e) if own.ndim else float(own)
    if not moment > 1e-12 * max(m * float(c @ c), float(np.abs(own).max())):
        raise ValueError(
            f"{name}.inertia = {body.inertia!r} of body {body.name!r}, with mass {m:g} kg at {body.centre}, must give "
            f"a moment > 0 [kg m^2] where joint {joint.name!r} ({joint.kind}) turns it"
        )
