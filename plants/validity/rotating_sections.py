"""Ranges of beams whose sections rotate as far as they like, as a field or from sub-beam to sub-beam.

Fibres      Hooke's law and sections that keep their shape: fibres strained by eps change the section's size, and so its
            stiffness, by Poisson's ratio times eps. FIBRE is 1 %, as for the stretch that inextensible beams leave out.
Quadrature  A link of exact rotations knows its tangents at points that are enough at a radian (`strain_link.enough`).
            RESOLVED is three times that: bent so far by its first shape, the inertia of the worst combination of rates
            errs by 3 % (eight polynomials; twenty: 4.1 %), that of the hub's turn and the first shape by 0.5 % at most.
One turn    In space a rotation vector is singular at one turn, phi = 2 pi: with it the strain that it stands for.
Sub-beams   Within its frame a sub-beam bends as `slender` beams do: it stands at sigma across where its section, and so
            its curvature, has turned by sigma, 0.46 sigma^2 too far under a force. The limit is that of a link's slope,
            SLOPE; frames that halve the slopes ("mean-axis", "chord") quarter the error.
Twisted     A sub-beam's bends are stiff about the axes of its frame, not of its twisted sections. A twist tau, of which
            the frame takes a part, leaves at most tau/2 of it: a force along one axis then bends about the other by
            (tau/2) (I_max/I_min - 1) of itself. SKEW = 0.1 keeps that below 5 %; a round beam feels none.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import casadi as ca
import numpy as np

from pliant.plants.beams.section import Beam
from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.exact_rotations.strain_link import StrainLink, curvatures, turns

from .ranges import Range, largest, values
from .slender import NONE_HOLDS, SLOPE, STATIONS

AXIAL, TURN = "axial strain", "turn of sections"
FIBRE = 0.01
MOMENTS = ("I_z", "I_y")  # that bending about z and about y feel
ONE_TURN = 2 * np.pi  # [rad]
SKEW = 0.1  # [rad]
RESOLVED = 3.0  # [rad]
BENT = 1.5  # [1/rad] by which a beam's turn raises what its stretch does
MORE_POINTS = "LargeDeflectionBeam with more points"
FINER = 'more segments, or kinematics="strain"'


def longer(beam: Beam, strain: float, turn: float) -> Beam:
    """For good as much longer as its root is strained at most, of the same mass: an estimate of what stretch does.

    A bent beam that stretches is pulled and moved across as well: the share is raised with the turn of its sections.
    Against extensible beams that were spun this was 1.1 to 3 times what extension did, 0.3 to 6 times where links bend
    by a radian: it serves to see that extension is nothing.
    """
    by = 1 + strain * (1 + BENT * turn)
    return dataclasses.replace(beam, length=beam.length * by, density=beam.density / by)


def largest_reached(plant: PlantLike, motion: Trajectory, what: str) -> list[float]:
    """The largest value of each range that measures this, AXIAL or TURN, on a motion of its plant."""
    reached = values(plant, motion)
    return [float(np.nanmax(reached[:, k])) for k, r in enumerate(plant.validity) if r.measures == what]


def fibres(
    beam: Beam,
    curvatures: Sequence[tuple[ca.SX, str]],
    pull: ca.SX,
    name: str = "the beam",
    holds: str = NONE_HOLDS,
) -> list[Range]:
    """Strain of the outer fibres, sqrt(3 I/A) from the axis as in a rectangle, for the largest |curvature| [1/m] about
    each axis ("I_z", "I_y"), and of the axis under a force `pull` [N]; `holds`: what stretches.
    """
    bent = ca.SX(0)
    for curvature, moment in curvatures:
        bent += ca.sqrt(3 * getattr(beam, moment) / beam.area) * curvature
    keeps = "sections keep their size, and their stiffness, to 1 %"
    found = [Range(f"strain of {name}'s fibres", "1", FIBRE, keeps, NONE_HOLDS, bent)]
    keeps = "an inextensible beam misplaces its points by less than 1 % of the length"
    stretched = ca.fabs(pull) / (beam.E * beam.area)
    return [*found, Range(f"{AXIAL} of {name}", "1", FIBRE, keeps, holds, stretched, AXIAL)]


def strains_of(name: str, link: StrainLink, q: ca.SX, pull: ca.SX) -> list[Range]:
    """Of a link of exact rotations at coordinates q (n,): strain of its fibres, of its axis under a force [N], and the
    turn up to which its quadrature is judged.
    """
    if not link.basis.n:
        return []
    curvature = largest(curvatures(link.basis, STATIONS), q) / link.beam.length**2
    turn = largest(turns(link.basis, STATIONS), q) / link.beam.length
    keeps = "quadrature takes the inertia of no combination of rates wrong by more than 5 %"
    resolved = Range(f"turn of {name}'s sections", "rad", RESOLVED, keeps, MORE_POINTS, turn, TURN)
    return [*fibres(link.beam, [(curvature, "I_z")], pull, name), resolved]


def below_one_turn(shapes: Sequence[np.ndarray], bends: ca.SX, flaps: ca.SX) -> Range:
    """The rotation vector of the sections, from its shapes about z and y (k, n) at the same stations."""
    farthest = ca.SX(0)
    for about_z, about_y in zip(*shapes, strict=True):
        turned = ca.dot(ca.DM(about_z), bends) ** 2 + ca.dot(ca.DM(about_y), flaps) ** 2
        farthest = ca.fmax(farthest, turned)
    keeps = "a rotation vector stands for one strain"
    holds = 'kinematics="substructured" with several segments'
    return Range("rotation of a section against the root", "rad", ONE_TURN, keeps, holds, ca.sqrt(farthest))


def sub_beams(beam: Beam, slopes: ca.SX, twists: ca.SX | None) -> list[Range]:
    """Of a chain: its largest slope within a sub-beam, and in space its largest twist of one [rad]."""
    turns = slopes if twists is None else ca.sqrt(slopes**2 + twists**2)
    keeps = "elastic forces of a sub-beam err by less than 5 %"
    found = [Range("turn within a sub-beam", "rad", SLOPE, keeps, FINER, turns)]
    if twists is not None:
        keeps = "bends of a twisted sub-beam err by less than 5 % of themselves"
        ratio = ca.fmax(beam.I_y, beam.I_z) / ca.fmin(beam.I_y, beam.I_z)
        quantity = "twist of a sub-beam times I_max/I_min - 1"
        found.append(Range(quantity, "rad", SKEW, keeps, FINER, twists * (ratio - 1)))
    return found
