"""Offset payloads: those of the reference file, and random ones by seed."""

import numpy as np

from pliant.plants.beams.offset_payload_roots import OffsetPayload

CASES = (
    "i_plain",
    "ii_Mt1",
    "iii_Ixx0.005_Izz0.05",
    "iii_Ixx0.05_Izz0.05",
    "iii_Ixx0.5_Izz0.005",
    "iii_Ixx0.5_Izz0.5",
)


COUPLED = {
    "Mt": 1.0,
    "ax": 0.1,
    "ay": 0.05,
    "az": 0.3,
    "Ixx": 0.4,
    "Izz": 0.1,
    "Ixz": 0.1,
    "chi": 1.5,
    "mu": 0.05,
}


def system(p):
    return OffsetPayload(
        mass=p["Mt"],
        offset=(p["ax"], p["ay"], p["az"]),
        inertia=(p["Ixx"], p["Izz"], p["Ixz"]),
        chi=p["chi"],
        mu=p["mu"],
    )


def random_system(rng):
    """Light and heavy, centred and offset, thin and thick: moments of a rigid body, sometimes none."""
    A = rng.normal(size=(3, 3))
    spread = A @ A.T
    inertia = (np.trace(spread) * np.eye(3) - spread) * 10 ** rng.uniform(-4, 1) * rng.integers(0, 2)
    return OffsetPayload(
        mass=10 ** rng.uniform(-3, 2) * rng.integers(0, 4) / 2,
        offset=tuple(rng.uniform(-0.4, 0.4, 3) * rng.integers(0, 2, 3)),
        inertia=inertia,
        chi=10 ** rng.uniform(-0.3, 0.5),
        mu=10 ** rng.uniform(-2, -0.7),
    )
