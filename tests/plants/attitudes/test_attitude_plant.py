"""What plants with attitudes answer alike: a tree with two, a spacecraft with one, each in its own words."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import FlexibleSpacecraft
from pliant.plants.core.quaternions import product, quaternion

CRAFT = FlexibleSpacecraft.textbook()
WORDS = {"tree": "FlexibleTree.x: the quaternion of 'base'", "craft": "FlexibleSpacecraft.x: the quaternion"}


@pytest.fixture(params=WORDS)
def named(request, craft):
    return request.param, CRAFT if request.param == "craft" else craft


def test_states_have_unit_quaternions(named):
    name, plant = named
    x = plant.state()
    np.testing.assert_array_equal(plant.consistent(np.zeros((2, plant.nx))), [x, x])
    x[plant.attitudes[0].quaternion] *= 1.5
    for call in (plant.linearize, lambda x: plant.linearize(x, attitude="quaternion"), plant.check_state):
        with pytest.raises(ValueError, match=WORDS[name] + r" has norm 1\.5, must be 1; see `state`"):
            call(x)
    assert plant.attitude_states[:4] == tuple(s.name for s in plant.states[plant.attitudes[0].quaternion])


def test_no_batch_is_linearised(named):
    _, plant = named
    for attitude in ("rotation", "quaternion"):
        with pytest.raises(ValueError, match=r"must be|has shape"):
            plant.linearize(np.tile(plant.state(), (2, 1)), attitude=attitude)


def test_signs_and_jumps_are_told_in_words(named):
    _, plant = named
    x, a = plant.state(), plant.attitudes[0]
    motion = plant.simulate(x, None, np.linspace(0, 0.4, 5))
    flipped = motion.x.copy()
    flipped[2:, a.quaternion] *= -1
    with pytest.raises(ValueError, match=f"nominal: the quaternion{a.of} changes its sign at t = 0.2 s"):
        plant.linearize_along(dataclasses.replace(motion, x=flipped, dx=None))
    after = x.copy()
    after[a.quaternion] = product(x[a.quaternion], quaternion([0.0, 0.2, 0.0]))
    with pytest.raises(ValueError, match=f"linearize_pieces: the attitude{a.of} jumps by 0.2 rad at t = 1 s"):
        plant.jump_map(x, np.zeros(plant.nu), after=after, t=1.0)
