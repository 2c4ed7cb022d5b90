"""Links lumped into rigid segments on sprung hinges, for engines of rigid bodies.

A link of n elements has n hinges, one in the middle of each, with the spring n E I/L and the damper of the same
share: curvature by the midpoint rule, of second order in 1/n. Its segments are the two half elements at the ends and
n - 1 whole ones between. Sections keep their rotary inertia; they do not shear, and the axis does not stretch.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .planar_machine import Machine


@dataclass(frozen=True)
class Segment:
    """A rigid body along x on a hinge at its origin."""

    length: float  # [m]
    mass: float  # [kg]
    centre: float  # of mass, along x [m]
    inertia: float  # about the centre of mass, about z [kg m^2]
    stiffness: float  # of its hinge [N m/rad]
    damping: float  # of its hinge [N m s/rad]
    driven: bool  # whether its hinge is a joint of the machine

    def with_body(self, at: float, mass: float, inertia: float) -> Segment:
        """With a rigid body whose mass centre is at `at` [m] along it."""
        total = self.mass + mass
        centre = (self.mass * self.centre + mass * at) / total
        about = self.inertia + self.mass * (self.centre - centre) ** 2 + inertia + mass * (at - centre) ** 2
        return Segment(self.length, total, centre, about, self.stiffness, self.damping, self.driven)


def segments(machine: Machine, parts: int) -> tuple[Segment, ...]:
    """From the root to the tip."""
    found: list[Segment] = []
    last = len(machine.links) - 1
    for i, link in enumerate(machine.links):
        element, spring = link.length / parts, link.EI * parts / link.length
        lengths = [element / 2, *[element] * (parts - 1), element / 2]
        own = []
        for k, length in enumerate(lengths):
            mass = link.linear_density * length
            inertia = mass * length**2 / 12 + link.density * link.I_z * length
            stiffness, damping = (spring, link.damping * spring) if k else (0.0, machine.friction[i])
            own.append(Segment(length, mass, length / 2, inertia, stiffness, damping, k == 0))
        own[0] = own[0].with_body(0.0, 0.0, machine.hub_inertia[i])
        end = (machine.payload.mass, machine.payload.inertia_z) if i == last else (machine.joint_mass, 0.0)
        own[-1] = own[-1].with_body(own[-1].length, *end)
        found += own
    return tuple(found)


def tips(chain: tuple[Segment, ...], angles: np.ndarray) -> np.ndarray:
    """The tip (..., 2) [m] at hinge angles (..., n) [rad]."""
    turned = np.cumsum(angles, axis=-1)
    lengths = np.array([s.length for s in chain])
    return np.stack([np.cos(turned) @ lengths, np.sin(turned) @ lengths], axis=-1)
