"""Large-deflection beams in the plane and in space, loaded, damped, with unequal sections."""

import dataclasses

from pliant.plants import LargeDeflectionBeam, Payload

BEAM = LargeDeflectionBeam.textbook()


LOAD = Payload(mass=0.3, inertia=0.02, offset=(0.1, 0.2, 0.0))


TENSOR = Payload(
    mass=0.3,
    inertia=((0.02, 0.003, 0.001), (0.003, 0.03, 0.002), (0.001, 0.002, 0.04)),
    offset=(0.1, 0.2, 0.15),
)


def large(**changes):
    return dataclasses.replace(BEAM, **changes)


def bent_section(**changes):
    """A damped beam whose section is twice as stiff one way as the other."""
    beam = dataclasses.replace(BEAM.beam, damping=0.01, I_y=2 * BEAM.beam.I_z)
    return large(beam=beam, gravity=(1.0, -9.8, 0.5), **changes)


VARIANTS = {
    "clamped": large(),
    "hinged": large(root="hinged"),
    "driven": large(root="driven", modes=2),
    "loaded": bent_section(payload=LOAD),
    "polynomial": bent_section(root="driven", payload=LOAD, basis="polynomial"),
    "space": large(planar=False, modes=2),
    "space round": large(planar=False, modes=2, root="hinged", payload=TENSOR),
    "space loaded": bent_section(planar=False, modes=2, payload=TENSOR, root="driven", twists=2),
    "space rigid in torsion": bent_section(planar=False, modes=2, twists=0),
}
