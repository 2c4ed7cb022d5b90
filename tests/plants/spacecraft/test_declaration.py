"""Variants, labels, and bad input of a spacecraft."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import Beam
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.appendage import Appendage
from pliant.plants.spacecraft_parts.environment import Orbit

BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8)
CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")


def test_ladder_and_labels(busy):
    steps = busy().ladder()
    assert [s.label.split(",")[0] for s in steps] == ["rigid", "linear", "linear", "stiffened", "stiffened"]
    assert all(s.outputs == busy().outputs for s in steps)
    assert all(np.isfinite(s.dynamics(s.state())).all() for s in steps)


def boom(**changes):
    return Appendage(**{"position": (1.0, 0.0, 0.0), "body": BOOM, **changes})


BAD_PLANT = {
    "hub": (lambda: FlexibleSpacecraft(hub=3.0), r"FlexibleSpacecraft\.hub = 3\.0 must be a Hub"),
    "appendages": (
        lambda: FlexibleSpacecraft(hub=CRAFT.hub, appendages=(BOOM,)),
        r"FlexibleSpacecraft\.appendages.* must be an? (tuple|Appendage), not",
    ),
    "one appendage": (
        lambda: FlexibleSpacecraft(hub=CRAFT.hub, appendages=boom()),
        r"FlexibleSpacecraft\.appendages.* must be an? (tuple|Appendage), not",
    ),
    "environment": (
        lambda: FlexibleSpacecraft(hub=CRAFT.hub, environment=Orbit(rate=1e-3)),
        r"FlexibleSpacecraft\.environment = .* must be an Environment",
    ),
    "translation": (
        lambda: FlexibleSpacecraft(hub=CRAFT.hub, translation="yes"),
        r"FlexibleSpacecraft\.translation = 'yes' must be True or False",
    ),
    "zero quaternion": (lambda: CRAFT.simulate(np.zeros(CRAFT.nx), None, [0, 1]), "the quaternion has norm 0, must be"),
    "long quaternion": (
        lambda: CRAFT.linearize(3 * CRAFT.state()),
        "the quaternion has norm 3, must be 1; see `state`",
    ),
    "kinematics": (
        lambda: FlexibleSpacecraft(hub=CRAFT.hub, kinematics="strain"),
        r"kinematics = 'strain' must be one of",
    ),
    "attitude": (
        lambda: CRAFT.linearize(CRAFT.state(), attitude="euler"),
        r"linearize\.attitude = 'euler' must be one of",
    ),
    "state": (lambda: CRAFT.state(rate=1.0), r"state 'rate' must be one of position_x"),
}


@pytest.mark.parametrize("name", BAD_PLANT)
def test_bad_input(name):
    make, words = BAD_PLANT[name]
    with pytest.raises(ValueError, match=words):
        make()
