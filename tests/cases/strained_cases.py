"""Beams of strains: every root, every strain, every load, curved at rest, loaded and damped."""

import dataclasses

import numpy as np
from large_beam_cases import LOAD, TENSOR, large

from pliant.plants import Beam

SECTION = Beam(
    length=2.0,
    area=1e-3,
    I_y=2e-7,
    I_z=1e-7,
    J=2.5e-7,
    density=2700.0,
    E=7e8,
    G=2.7e8,
    damping=0.01,
    shear_coefficient=0.8,
)
ALL = {"extensible": True, "theory": "timoshenko", "tip_loads": ("force", "moment", "follower")}


def curved(xi):
    """A curvature at rest that changes its sign [1/m]."""
    return 0.8 * np.cos(3 * xi)


def strained(**changes):
    return large(**({"beam": SECTION, "gravity": (1.0, -9.8, 0.5), "modes": 2, "basis": "auto"} | changes))


STRAINED = {
    "free": strained(root="free", payload=LOAD, rest_curvature=0.5, **ALL),
    "moving": strained(root="moving", extensible=True, payload=LOAD, tip_loads=("moment",)),
    "hinged": strained(root="hinged", theory="timoshenko", rest_curvature=curved),
    "clamped": strained(extensible=True, rotary=3.0),
    "space": strained(
        planar=False, modes=1, payload=TENSOR, root="driven", shears=1, stretches=1, rest_curvature=0.5, **ALL
    ),
    "space moving": strained(planar=False, modes=1, root="moving", rest_curvature=0.5, tip_loads=("force", "moment")),
    "segments": strained(root="free", segments=2, payload=LOAD, rest_curvature=curved, **ALL),
    "space segments": strained(
        planar=False, segments=2, modes=1, extensible=True, payload=TENSOR, tip_loads=("force", "follower")
    ),
    "space clamped": strained(planar=False, rotary=0.5, twists=2),
}


def unit_states(plant, rng, size=0.3):
    """A state whose strains are as small as materials bear."""
    n = plant.nx // 2
    small = np.array([1e-2 if s.unit == "1" else 1.0 for s in plant.coordinates])
    return size * rng.uniform(-1, 1, 2 * n) * np.tile(small, 2)


def replaced(name, **changes):
    return dataclasses.replace(STRAINED[name], **changes)
