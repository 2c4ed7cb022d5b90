"""What bends a beam: the field of its tangents and what its sections add, in the plane or in space.

A rotation field of the whole beam, or a chain of sub-beams; each either planar or, with torsion, spatial.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import Beam
from pliant.plants.exact_rotations.quadrature import Array, Points

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
