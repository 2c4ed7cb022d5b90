"""A tree of rigid and flexible bodies on a base that is fixed, free, or moves as its inputs say.

States   q = [joints in the order of the tree, motors of elastic joints, elastic coordinates body by body], x = [q; v];
         a base that moves first. Turns in space are unit quaternions, their speeds angular velocities in the axes that
         turn with them; linear models are in small turns (see `attitudes`)
Inputs   torques of the joints [N m] (forces [N] of those that slide), of motors at their own shafts, or accelerations
         of joints whose motion is given; disturbances: force [N] and torque [N m] at the tip, at other frames that
         `loads` names, in the base's axes
Outputs  joints and motors [rad, m]; by flexible body the deflections of its end across its beam [m], their rates and
         the curvatures at its root [1/m]; position [m] and velocity [m/s] of the tip and of every frame, base's axes;
         where `devices` has them "gyro" [rad/s] and "accelerometer" [m/s^2] there, in the place's own axes, and the
         "reaction" on the base [N, N m]
Valid    beams inextensible or stretched to first order, their slopes up to 0.3 rad; "linear" up to a fifth of the
         first bending frequency of spin
Source   R. Featherstone, "Rigid Body Dynamics Algorithms" (2008), composite bodies and recursive Newton-Euler; A. A.
         Shabana, "Dynamics of Multibody Systems", floating frame of reference, each frame clamped to its beam's root.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import casadi as ca
import numpy as np

from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import require_all, require_text
from pliant.plants.core.casadi_functions import Built, NumericFunction, built_once, function
from pliant.plants.core.imports import Late
from pliant.plants.dynamics.arguments import line_points, one_state
from pliant.plants.elastic_bodies.of_body import readings_of
from pliant.plants.elastic_bodies.ranges import ranges_of
from pliant.plants.multibody_parts.joint import ElasticJoint
from pliant.plants.multibody_parts.tree_body import TreeBody
from pliant.plants.multibody_parts.urdf import read
from pliant.plants.multibody_recursion.kinematics import drawn, in_plane, poses, twists
from pliant.plants.multibody_recursion.layout import vector
from pliant.plants.multibody_recursion.newton_euler import pulls
from pliant.plants.validity.ranges import Range

from .from_urdf import bodies, platform, tell_repairs
from .measurements import readings
from .tree_dynamics import TreeDynamics

FILES = Late("pliant.plants.tables.tree_files")  # which imports this room


@dataclass(frozen=True, kw_only=True)
class FlexibleTree(TreeDynamics):
    """M(q) q'' + h(q, q') + K q + D q' = B u + sum over frames of J^T w.

    `bodies` stand parents first. `tip` is the body or the frame that holds the payload ("": the end of the last body);
    `frames` are further places, of which `loads` feel forces. `modes` of the bodies, `kinematics` ("rigid", "linear",
    "stiffened", "strain") and `basis` ("polynomial", "clamped-free") are the fidelity.

    `base`: "fixed", "free" (of inertia `platform`, its offset from the base's origin), or "driven" in `base_freedoms`,
    whose accelerations are inputs. `state` makes states by name, with unit quaternions.

    >>> from pliant.plants import Joint
    >>> link = TreeBody(name="link", joint=Joint(name="hub"), beam=arm.link)
    >>> FlexibleTree.serial([link], gravity=(0, 0, 0)).nx
    12
    """

    @classmethod
    def serial(cls, bodies: Any, **options: Any) -> Self:
        """A chain: each body hangs on the one before it, whatever its `parent` says; keywords as the class has them."""
        chain = require_all(f"{cls.__name__}.serial.bodies", bodies, TreeBody)
        return cls(bodies=tuple(dataclasses.replace(b, parent="") for b in chain), **options)

    def output(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        n = len(self.coordinates)
        q, v = x[:n], x[n:]
        places = self.told(q)
        y = [places[k] for k in self.measured]
        bent = dict(zip((b.name for b in self.flexible), self._beams(), strict=True))
        for body in self.slender:
            if body.name not in bent:
                y += [ca.SX.zeros(len(readings_of(body)))]
                continue
            own, at, rates = bent[body.name]
            y += own.readings(q[at], v[rates])
        walk = self._walk_at(x)
        stands, moves = poses(walk), twists(walk)
        at_places = [self.tree.places[place] for place in self.places]
        for k in at_places:
            y += [stands[k].p, stands[k].R @ moves[k].v]
        if self.devices:
            a = self.inner(self.solved(t, x, u, w)[0])
            loads = self._wrenches(walk, u, w)
            y += readings(walk, a, vector(self.gravity), loads, self.devices, at_places)
        return ca.vertcat(*y)

    def ranges(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, y: ca.SX) -> tuple[Range, ...]:
        """Small slopes and strains; without stiffening also the shortening and the axial force that it leaves out."""
        found, walk = list[Range](), self._walk_at(x)
        axial = pulls(walk, vector(self.gravity), self._wrenches(walk, u, w))
        turning = twists(walk)
        bent = zip(self.flexible, self.tree.beams, self.nominal.tree.beams, self._beams(), strict=True)
        for body, (k, own), (_, numbers), (_, at, _) in bent:
            found += ranges_of(body.name, own, numbers, x[at], axial[k], turning[k].omega)
        return tuple(found)

    @cached_property
    def drawn_as(self) -> str:
        """Lines of a plane, "links", where all joints turn or slide in the one that `outline` shows, else "tree"."""
        still, across = ca.SX.zeros(len(self.coordinates)), 1 if self.nominal.gravity[2] else 2
        plain = self.base == "fixed" and {joint.kind for joint in self.moving} <= {"revolute", "prismatic"}
        return "links" if plain and in_plane(self.nominal._walk(still, still), across) else "tree"

    def outline(self, x: np.ndarray, points: int = 30) -> list[np.ndarray]:
        """The bodies as lines (points, 2) [m], root first, at a state x (nx,): along `outline_axes`."""
        seen = ["xyz".index(axis) for axis in self.outline_axes]
        return [line[:, seen] for line in self.lines(x, points)]

    @property
    def outline_axes(self) -> tuple[str, str]:
        return ("x", "z") if self.nominal.gravity[2] else ("x", "y")

    def lines(self, x: np.ndarray, points: int = 30) -> list[np.ndarray]:
        """The bodies as lines (points, 3) [m] in the base's axes, at a state x (nx,)."""
        x, points = one_state(self, x), line_points(self, points)
        lines = self.nominal._drawings.of(points, lambda: self.nominal._drawing(points))
        return [line.T for line in lines(x[: len(self.coordinates)])]

    def _drawing(self, points: int) -> NumericFunction:
        """q -> `lines`, transposed."""
        q, still = ca.SX.sym("q", len(self.coordinates)), ca.SX.zeros(len(self.speeds))
        return function("lines", [q], drawn(self._walk(q, still), points), matrices=True)

    @built_once
    def _drawings(self) -> Built[int, NumericFunction]:
        """By how many points a line has."""
        return Built()

    @classmethod
    def from_toml(cls, path: str | Path) -> Self:
        """The tree of a file as `to_toml` writes it, or by hand. ValueError: file, key, value and what it must be."""
        made: Self = FILES.read_tree(cls, path)
        return made

    def to_toml(self, path: str | Path) -> None:
        """Write the fields that are not at their defaults, to the last bit. ValueError where one is an expression."""
        FILES.write_tree(self, path)

    @classmethod
    def from_urdf(
        cls,
        path: str | Path,
        *,
        flexible: Mapping[str, Beam] | None = None,
        joints: Mapping[str, ElasticJoint] | None = None,
        modes: Mapping[str, tuple[int, ...]] | None = None,
        drives: Mapping[str, str] | None = None,
        tip: str = "",
        mimic: str = "refused",
        inertias: str = "refuse",
        **options: Any,
    ) -> Self:
        """A machine from a URDF file, its root link the base: fixed, or where base="free" or "driven" with that link's
        inertia as `platform`.

        `flexible` links become beams from their own origin to their farthest joint, in the place of the file's inertia,
        with `modes` shapes (in x-y, in x-z, twist, stretch; 2, 2, 1, 0 by default); `joints` get motors behind elastic
        gears; `drives` says which have no input or a given motion. `tip` is the link that holds the payload and is
        measured. A joint that mimics another is refused, or moves by itself with mimic="free". Inertias that no body
        has are refused; inertias="repair" takes the nearest that one can have, says what it changed in a warning and
        keeps it in `repairs`. Further keywords as the class has them. ValueError that names the file's element for what
        it cannot be.

        Example
        -------
        >>> import tempfile
        >>> from pliant.plants import Beam, beams
        >>> file = tempfile.mkdtemp() + "/arm.urdf"
        >>> with open(file, "w") as out:
        ...     _ = out.write('''<robot name="arm"> <link name="base"/> <link name="tool"/>
        ...     <link name="link"> <inertial> <mass value="1"/> <origin xyz="0.25 0 0"/>
        ...       <inertia ixx="1e-3" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/> </inertial> </link>
        ...     <joint name="hub" type="revolute"> <parent link="base"/> <child link="link"/> <axis xyz="0 0 1"/>
        ...       <limit lower="-3" upper="3" effort="20" velocity="5"/> </joint>
        ...     <joint name="end" type="fixed"> <parent link="link"/> <child link="tool"/> <origin xyz="0.5 0 0"/>
        ...     </joint> </robot>''')
        >>> tube = Beam.tube(0.5, 0.02, 0.018, beams.ALUMINIUM)
        >>> arm = FlexibleTree.from_urdf(file, flexible={"link": tube}, modes={"link": (1, 1, 0, 0)}, tip="tool")
        >>> [s.name for s in arm.coordinates], arm.joints[0].position
        (['hub', 'link_y1', 'link_z1'], 'hub')
        """
        machine = read(path, mimic, inertias)
        tell_repairs(path, machine.repairs)
        own = platform(machine, options.get("base")) | {"repairs": machine.repairs}
        tip = require_text("from_urdf.tip", tip, empty=True)
        parts = bodies(machine, flexible, joints, modes, drives, tip)
        return cls(bodies=parts, tip=tip, root=machine.root, **(own | options))
