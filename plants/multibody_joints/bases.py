"""The base of a tree that is free, or whose motion is given: joints between it and what does not move.

A free base has the coordinates of a "free" joint: place in the axes of what does not move, a quaternion, the place's
rates and the angular velocity in its own axes. A driven base has those of its freedoms alone, whose accelerations are
inputs: it slides along x, y, z, then turns; all three turns are those of a "spherical" joint, by a quaternion, one or
two are angles about its axes x, y, z in that order.
"""

from __future__ import annotations

import numpy as np

from pliant.plants.beams.payload import Payload
from pliant.plants.core.parameters import is_symbolic
from pliant.plants.multibody_parts.joint import Joint
from pliant.plants.multibody_parts.tree_body import TreeBody

WORLD = ""  # what a base hangs on
KINDS = ("fixed", "free", "driven")
FREEDOMS = ("x", "y", "z", "turn_x", "turn_y", "turn_z")


def base_bodies(kind: str, root: str, platform: Payload, wanted: tuple[str, ...]) -> tuple[TreeBody, ...]:
    """Bodies without mass but the last, which is the base called `root`; () where it is fixed."""
    if kind == "fixed":
        return ()
    if kind == "free":
        joints = [Joint(name=root, kind="free", drive="none")]
    else:
        axes = {c: tuple(float(c == d) for d in "xyz") for c in "xyz"}
        given = {"drive": "acceleration"}
        joints = [
            Joint(name=f"{root}_{c}", kind="prismatic", axis=axes[c], **given)  # type: ignore[arg-type]
            for c in "xyz"
            if c in wanted
        ]
        turns = [f for f in FREEDOMS[3:] if f in wanted]
        if len(turns) == 3:
            joints.append(Joint(name=root, kind="spherical", **given))  # type: ignore[arg-type]
        else:
            joints += [Joint(name=f"{root}_{f}", axis=axes[f[-1]], **given) for f in turns]  # type: ignore[arg-type]
    names = [*(f"{root} by {joint.name}" for joint in joints[:-1]), root]
    found = [TreeBody(name=n, joint=j, parent=p) for n, j, p in zip(names, joints, [WORLD, *names], strict=False)]
    own = {"mass": platform.mass, "centre": platform.offset, "inertia": platform.inertia}
    return (*found[:-1], TreeBody(name=root, joint=joints[-1], parent=found[-1].parent, **own))


def check_platform(owner: str, root: str, platform: Payload, bodies: tuple[TreeBody, ...]) -> None:
    """ValueError where a free base, with what is fixed to it, has no mass."""
    welded = {root}
    found = [platform.mass]
    for body in bodies:
        if body.joint.kind == "fixed" and body.parent in welded:
            welded.add(body.name)
            found += [body.mass, *[part.mass for part in (body.beam, body.modal) if part is not None]]
    heavy = [m for m in found if is_symbolic(m) or m > 0]
    if not heavy:
        raise ValueError(
            f"{owner}.platform.mass = {platform.mass!r} must be > 0 [kg] where base = 'free', or a body with mass "
            f"fixed to {root!r}"
        )
    own = np.ravel(np.array(platform.inertia, dtype=object))
    if len(heavy) == 1 and heavy[0] is platform.mass and not any(map(is_symbolic, own)):
        J = np.array(platform.inertia, dtype=float)
        if not np.linalg.eigvalsh(J if J.ndim else J * np.eye(3))[0] > 0:
            raise ValueError(
                f"{owner}.platform.inertia = {platform.inertia!r} must have moments > 0 [kg m^2] where base = 'free'"
            )
