"""What bends a beam: the field of its tangents and what its sections add, in the plane or in space.

A rotation field of the whole beam, or a chain of sub-beams; each either planar or, with torsion, spatial.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from pliant.plants.beam_strains import fidelities
from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.dynamics.symbolic_ldl import ldl, ldl_solve
from pliant.plants.exact_rotations.nodal_turns import NodalField
from pliant.plants.exact_rotations.quadrature import Array, Points
from pliant.plants.validity.ranges import Range, largest
from pliant.plants.validity.rotating_sections import MOMENTS, below_one_turn, fibres, sub_beams
from pliant.plants.validity.slender import STATIONS

from .cross_sections import PlanarSections
from .spatial_sub_beam_chain import SpatialChain
from .spatial_tangent_field import SpatialSections
from .sub_beam_chain import Chain
from .tangent_field import Rotations, TangentField, planar_field
from .torsion import TorsionShapes


class Fields(NamedTuple):
    """Of coordinates q (n,): tangents along the axis; rotary inertia, strain energy and the payload's attitude; the
    curvature about z at the root times the length, times q, as a row (n,).
    """

    shapes: Rotations | Chain  # of bending about z
    tangents: TangentField | SpatialChain
    sections: PlanarSections | SpatialSections | SpatialChain
    root_curvature: Array


def of_chain(beam: Beam, payload: Payload, chain: Chain, points: int, twists: int | None) -> Fields:
    """A chain of sub-beams with `points` quadrature points on each; `twists` torsion shapes, None in the plane."""
    bent = chain.shapes(0.0, 2)[0] * chain.segments
    if twists is None:
        turn, inertia = chain.frame_angles[-1], chain.inertia()
        sections = PlanarSections(beam, payload, chain.stiffness, inertia, turn)
        return Fields(chain, chain.field(points), sections, _row(chain.n, chain.columns(0), bent))
    spatial = SpatialChain(beam, payload, chain, twists, points)
    return Fields(chain, spatial, spatial, _row(spatial.n, chain.columns(0), bent))


def of_rotations(
    beam: Beam, payload: Payload, bend: Rotations, flap: Rotations, at: Points, twist: TorsionShapes | None
) -> Fields:
    """One rotation field known at these points; flaps and torsion shapes in space, None in the plane."""
    bent = bend.curvature(np.zeros(1))[0]
    if twist is None:
        sections = PlanarSections(beam, payload, bend.stiffness, bend.inertia(at), bend(np.ones(1))[0])
        return Fields(bend, planar_field(bend, at), sections, bent)
    spatial = SpatialSections(beam, payload, bend, flap, twist, at)
    return Fields(bend, spatial.field(), spatial, _row(spatial.n, slice(bend.n), bent))


def _row(n: int, columns: slice, values: Array) -> Array:
    row = np.zeros(n)
    row[columns] = values
    return row


class NodalBalance(NamedTuple):
    """M z'' = r in the turns z of nodes, and q = back z."""

    M: ca.SX  # (n, n)
    lacking: ca.SX  # (n,) r - M z'' at the accelerations that were given
    back: ca.DM  # (n, n)

    def change(self, z: ca.SX) -> ca.SX:
        """How accelerations of the coordinates change with symbols z, at those held that were given."""
        return self.back @ ldl_solve(*ldl(self.M), ca.jacobian(self.lacking, z))


def nodal_balance(
    beam: Beam, fields: Fields, gravity: ca.SX, q: ca.SX, v: ca.SX, a: ca.SX, force: ca.SX
) -> NodalBalance | None:
    """At coordinates q, rates v and accelerations a (n,) under gravity (2,) [m/s^2] and a force at the tip (2,) [N].

    None for another field, and for one whose rotary inertia is no number: turning it to z takes what z saves.
    """
    shapes, sections, points = fields.shapes, fields.sections, fields.tangents.points
    if not (isinstance(shapes, Rotations) and isinstance(sections, PlanarSections)):
        return None
    inertia = sections.inertia(q, v)[0]
    if not inertia.is_constant():
        return None
    field = NodalField(points, shapes(points.xi))
    at, back = field.at(q, v), field.from_nodes
    turning = ca.DM(inertia).full()
    M = ca.DM(back.T @ turning @ back) + beam.mass * beam.length**2 * at.mass()
    r = ca.DM(back.T) @ (sections.elastic_force(q, v) - ca.DM(turning) @ a)
    r -= beam.mass * beam.length**2 * at.inertia_force(a)
    r += beam.mass * beam.length * (at.sum_jacobian(points.first_moment).T @ gravity)
    r += beam.length * (at.sum_jacobian(points.weight).T @ force)
    return NodalBalance(M, r, ca.DM(back))


def ranges_of_fields(own: Any, q: ca.SX, spin: ca.SX, force: ca.SX) -> tuple[Range, ...]:
    """Of a beam that bends and twists alone, at coordinates q (n,), its root's turning rate squared, under a force at
    its tip (2,) or (3,) [N].
    """
    beam, shapes, at = own.beam, own.fields.shapes, STATIONS
    force = ca.norm_2(force)
    weight, L = ca.norm_2(ca.vertcat(*own.gravity)), beam.length
    pull = force + beam.mass * (weight + spin * L / 2) + own.payload.mass * (weight + spin * L)
    if isinstance(shapes, Chain):
        first, each = shapes.n - shapes.segments * shapes.modes, shapes.segments * shapes.modes
        planes = [
            shapes.turns_within(q[first + k * each : first + (k + 1) * each]) for k in range(1 + (not own.planar))
        ]
        twists = None if own.planar else _largest_twist(q[first + 2 * each :], own.segments, own.twists)
        curved = [(curvature / L, moment) for (_, curvature), moment in zip(planes, MOMENTS)]
        slope = ca.norm_2(ca.vertcat(*[s for s, _ in planes]))
        return (*fibres(beam, curved, pull, holds=fidelities.EXTENSIBLE), *sub_beams(beam, slope, twists))
    m = own.modes + (own.root != "clamped")
    curved = [(largest(shapes.curvature(at), q[:m]) / L, "I_z")]
    if own.planar:
        return tuple(fibres(beam, curved, pull, holds=fidelities.EXTENSIBLE))
    flap, flaps = own.nominal._rotations[1], q[m : m + own.modes]
    curved.append((largest(flap.curvature(at), flaps) / L, "I_y"))
    about_z = shapes(at)[:, m - own.modes :]  # against the root
    return (
        *fibres(beam, curved, pull, holds=fidelities.EXTENSIBLE),
        below_one_turn((about_z, flap(at)), q[m - own.modes : m], flaps),
    )


def _largest_twist(q: ca.SX, segments: int, count: int) -> ca.SX:
    """Of a chain's sub-beams, from end to end [rad]: the first torsion shape of each alone turns its end."""
    return ca.mmax(ca.fabs(ca.reshape(q, count, segments)[0, :])) if count else ca.SX(0)
