"""MuJoCo's own cable: a flex of one dimension, a discrete elastic rod of points in the plane whose edges keep their
length by constraints.

Its bending is integrated by the discrete integrator alone. Curvature sits at the points, the first of which lies half
an edge outside the root, so that points and hinges of `rigid_segments` stand alike. Sections have no rotary inertia.
"""

from __future__ import annotations

import numpy as np

from .mujoco_chain import HEAVY, rollout_of
from .planar_machine import Machine
from .programs import Motion, Player, Setting


class Cable:
    """mujoco.rollout of the whole motion in one call, nothing that can touch."""

    peer = "MuJoCo, cable (1D flex)"
    package = "mujoco"
    part = "edges"

    def why_not(self, machine: Machine) -> str:
        if len(machine.links) > 1:
            return "its cable has no joint between two links"
        if any(link.damping for link in machine.links):
            return "its cable has no damping of the bending alone"
        return "its points carry no moment of inertia" if machine.payload.inertia_z else ""

    def parts(self, machine: Machine) -> tuple[int, ...]:
        return 3, 4, 6, 8, 12, 16, 24, 32, 48

    def solvers(self) -> tuple[str, ...]:
        return ("discrete",)

    def beside(self, solver: str) -> tuple[str, ...]:
        return ()

    def player(self, machine: Machine, setting: Setting) -> Player:
        return rollout_of(machine, setting, xml(machine, setting), (machine.angles[0],), lambda q: _motion(machine, q))


def _motion(machine: Machine, q: np.ndarray) -> Motion:
    """From the coordinates (nt, n): the root's angle where it turns, then how far the points moved in its axes."""
    angle = q[:, 0] if machine.root != "clamped" else np.full(len(q), machine.angles[0])
    x, y = machine.links[0].length + q[:, -2], q[:, -1]
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * x - s * y, s * x + c * y], axis=1), angle


def xml(machine: Machine, setting: Setting) -> str:
    """Root, points and cable in MuJoCo's format."""
    link, n = machine.links[0], setting.parts
    edge = link.length / (n - 0.5)
    mass, inertia = link.linear_density * edge, " ".join([repr(max(machine.hub_inertia[0], 1e-9))] * 3)
    still = f'pos="{edge / 2!r} 0 0" mass="{mass!r}" diaginertia="{inertia}"'  # the hub, and the first point's share
    root, motor = "", ""
    if machine.root != "clamped":
        heavy = HEAVY * link.mass * link.length**2 if machine.root == "motion" else 0.0
        root = f'<joint name="root" type="hinge" axis="0 0 1" armature="{heavy!r}" damping="{machine.friction[0]!r}"/>'
        motor = f'<motor joint="root" gear="{heavy or 1.0!r}"/>'
    points = f'<body name="p0" pos="{-edge / 2!r} 0 0"/><body name="p1" pos="{edge / 2!r} 0 0"/>'
    for i in range(2, n + 1):
        own = mass if i < n else mass / 2 + machine.payload.mass
        points += f'<body name="p{i}" pos="{edge * (i - 0.5)!r} 0 0">'
        points += f'<inertial pos="0 0 0" mass="{own!r}" diaginertia="1e-9 1e-9 1e-9"/>'
        points += '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/></body>'
    edges, bodies = " ".join(f"{i} {i + 1}" for i in range(n)), " ".join(f"p{i}" for i in range(n + 1))
    radius, step, (gx, gy) = (4 * link.I_z / np.pi) ** 0.25, machine.dt / setting.substeps, machine.gravity
    turned = machine.angles[0] if machine.root == "clamped" else 0.0
    return (
        f'<mujoco><compiler angle="radian"/><option timestep="{step!r}" integrator="{setting.solver}" '
        f'gravity="{gx!r} {gy!r} 0"><flag contact="disable"/></option><worldbody>'
        f'<body euler="0 0 {turned!r}">{root}<inertial {still}/>{points}</body></worldbody>'
        f'<deformable><flex name="cable" dim="1" body="{bodies}" element="{edges}" radius="{float(radius)!r}">'
        f'<elasticity young="{link.E!r}" poisson="0.3" section="circle"/>'
        '<contact contype="0" conaffinity="0" selfcollide="none"/></flex></deformable><equality>'
        f'<flex flex="cable" solref="{2 * step!r} 1" solimp="0.9999 0.9999 0.001"/></equality>'
        f"<actuator>{motor}</actuator></mujoco>"
    )
