"""The plants that every shared test must pass: a new plant joins by adding its variants to PLANTS."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from pliant.plants import Payload, SingleLinkArm, TwoLinkArm

ARM = TwoLinkArm.textbook()
LINK = SingleLinkArm.textbook()


def two(**changes):
    return dataclasses.replace(ARM, **changes)


def one(**changes):
    return dataclasses.replace(LINK, **changes)


def damped(beam):
    return dataclasses.replace(beam, damping=3e-4)


HUBS = {"hub_inertia": (0.1, 0.02)}
OFFSET = Payload(mass=0.5, inertia=0.002, offset=(0.03, 0.04, 0.0))

PLANTS = {
    "two": ARM,
    "two no slope": two(tip_slope=False),
    "two hubs": two(**HUBS),
    "two polynomial": two(basis="polynomial"),
    "two stiffened": two(basis="polynomial", kinematics="stiffened", modes=(1, 2)),
    "two payload": two(basis="payload", modes=(2, 1)),
    "two offset": two(payload=OFFSET, kinematics="stiffened", basis="polynomial", modes=(1, 1)),
    "two one-sided": two(modes=(0, 2)),
    "two rigid-inertia": two(reduction="rigid-inertia", **HUBS),
    "two rigid-coupling": two(reduction="rigid-coupling"),
    "two rigid": two(reduction="rigid"),
    "two damped": two(
        link1=damped(ARM.link1), link2=damped(ARM.link2), joint_friction=(0.2, 0.1), modes=(2, 1), **HUBS
    ),
    "one": LINK,
    "one rigid": one(kinematics="rigid"),
    "one linear": one(kinematics="linear", basis="clamped-free", modes=3),
    "one gravity": one(basis="polynomial", gravity=9.81),
    "one offset": one(payload=OFFSET, modes=1),
    "one driven": one(drive="motion"),
    "one timoshenko": one(theory="timoshenko", modes=2),
    "one pinned": one(frame="pinned", payload=OFFSET, hub_radius=0.1),
    "one damped": one(link=damped(LINK.link), hub_friction=0.1),
}
DAMPED = ("two damped", "one damped")
UNDAMPED = tuple(name for name in PLANTS if name not in DAMPED)


@pytest.fixture(params=list(PLANTS))
def plant(request):
    return PLANTS[request.param]


@pytest.fixture(params=UNDAMPED)
def undamped(request):
    return PLANTS[request.param]


@pytest.fixture
def reference():
    """A file of tests/reference by name."""
    folder = Path(__file__).parent / "reference"
    return lambda name: json.loads((folder / f"{name}.json").read_text())


@pytest.fixture
def random_state():
    """A state of an arm: angles of any size, deflections of some per cent of a metre, moderate rates."""

    def draw(plant, seed, size=1.0):
        rng = np.random.default_rng(seed)
        n = plant.nx // 2
        bent = [s.unit == "m" for s in plant.states[:n]]
        # Small enough for the stage that loses definiteness at about a millimetre.
        deflection = 2e-4 if getattr(plant, "reduction", "") == "rigid-inertia" else 0.02
        scale = np.concatenate([np.where(bent, deflection, 2.0), np.where(bent, 0.1, 2.0)])
        return size * scale * rng.uniform(-1, 1, plant.nx)

    return draw
