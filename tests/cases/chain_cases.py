"""The 10 m beam as a chain of sub-beams, bare and loaded."""

import dataclasses

from pliant.plants import LargeDeflectionBeam, Payload

BEAM = LargeDeflectionBeam.textbook()


LOADED = dataclasses.replace(
    BEAM,
    beam=dataclasses.replace(BEAM.beam, damping=0.01),
    payload=Payload(mass=0.3, inertia=0.02, offset=(0.1, 0.2, 0.0)),
    gravity=(1.0, -9.8, 0.0),
)


def chain(segments, modes=2, frame="mean-axis", of=BEAM, **changes):
    return dataclasses.replace(of, kinematics="substructured", segments=segments, modes=modes, frame=frame, **changes)
