"""Uniform beams, rigid payloads, and the shape functions by which a beam bends.

section                    Beam, Material: length, cross-section, elasticity
payload                    Payload: a rigid body at the tip
frequencies                natural frequencies, bare, loaded, coupled
euler_bernoulli_modes      closed-form modes of the six boundary conditions, loaded tips
shape_functions            a basis of a link: modes, loaded modes, polynomials
legendre_ritz              Ritz functions on Legendre polynomials, Timoshenko's theory
rotating_beam              a beam on a spinning hub
offset_payload_roots       frequencies of bending and torsion coupled by an offset payload
offset_payload_modes       their shapes
elastic_link               energies of one elastic link of an arm
pinned_rod                 energies of one elastic rod between two pins
"""

from .euler_bernoulli_modes import BOUNDARIES, ModeShapes, count_loaded, loaded_roots, roots, shapes
from .frequencies import coupled_frequencies, frequencies
from .offset_payload_modes import PayloadModes
from .offset_payload_roots import OffsetPayload, clamped_payload_roots
from .payload import Payload
from .rotating_beam import rotating_frequencies
from .section import ALUMINIUM, STEEL, Beam, Material
from .shape_functions import BASES, Basis, Polynomials, basis

__all__ = [
    "ALUMINIUM",
    "BASES",
    "BOUNDARIES",
    "STEEL",
    "Basis",
    "Beam",
    "Material",
    "ModeShapes",
    "OffsetPayload",
    "Payload",
    "PayloadModes",
    "Polynomials",
    "basis",
    "clamped_payload_roots",
    "count_loaded",
    "coupled_frequencies",
    "frequencies",
    "loaded_roots",
    "roots",
    "rotating_frequencies",
    "shapes",
]
