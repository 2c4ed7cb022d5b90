"""Natural frequencies of a uniform beam, bare or with a payload, in bending and in bending coupled with torsion."""

from __future__ import annotations

import math

import numpy as np

from pliant.plants.core.argument_gates import require_instance
from pliant.plants.core.parameters import require_choice

from .euler_bernoulli_modes import BOUNDARIES, loaded_roots, roots
from .offset_payload_roots import OffsetPayload
from .payload import Payload
from .section import Beam


def frequencies(beam: Beam, n: int, boundary: str = "clamped-free", payload: Payload | None = None) -> np.ndarray:
    """The lowest n natural frequencies [rad/s] (n,) of bending in the x-y plane.

    omega = beta^2 sqrt(EI/(rho A L^4)). A payload needs boundary "clamped-free"; its offset must lie in the
    x-y plane, else bending and torsion couple. ValueError for an offset out of the plane.

    Example
    -------
    >>> from pliant.plants import Beam, beams
    >>> frequencies(Beam.tube(2.0, 0.03, 0.026, beams.ALUMINIUM), 2).round(2)
    array([ 44.42, 278.37])
    """
    require_instance("frequencies.beam", beam, Beam)
    require_choice("frequencies", "boundary", boundary, BOUNDARIES)
    scale = math.sqrt(beam.EI / beam.linear_density) / beam.length**2
    if payload is None:
        return scale * roots(boundary, n) ** 2
    require_choice("frequencies", "boundary", boundary, ("clamped-free",))
    z = require_instance("frequencies.payload", payload, Payload).offset[2]
    if z != 0:
        raise ValueError(f"Payload.offset[2] = {z!r} must be 0 [m]: it couples bending with torsion")
    return scale * loaded_roots(n, *payload.ratios(beam.mass, beam.length).values()) ** 2


def coupled_frequencies(beam: Beam, n: int, payload: Payload) -> np.ndarray:
    """The lowest n frequencies [rad/s] (n,) of the clamped beam in bending about z and torsion, none missed.

    Example
    -------
    >>> from pliant.plants import Beam, beams
    >>> tube = Beam.tube(2.0, 0.03, 0.026, beams.ALUMINIUM)
    >>> coupled_frequencies(tube, 2, Payload(mass=0.5, inertia=0.002, offset=(0.0, 0.05, 0.0))).round(2)
    array([ 25.  , 208.57])
    """
    require_instance("coupled_frequencies.beam", beam, Beam)
    scale = math.sqrt(beam.EI / beam.linear_density) / beam.length**2
    return scale * OffsetPayload.of(beam, payload).roots(n) ** 2
