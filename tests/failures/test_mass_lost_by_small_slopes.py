"""A soft link on a light, fast hub, bent by half its length: second-order shortening takes away its mass.

Naive       a stiffened arm: its mass matrix is definite for small slopes only, and lost on the way
Noticed     simulate raises MassMatrixError and says at which deflection; where mass stays, slopes leave their range
Holds       kinematics="strain", whose mass is that of tangents of length one: two numbers of modes agree
"""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import MassMatrixError

SCENE = scenes.get("single-link-slew", duration=0.8)
SOFT = dataclasses.replace(
    SCENE.plant, link=dataclasses.replace(SCENE.plant.link, E=1.5e10, length=1.2), hub_inertia=0.04
)
SCENE = dataclasses.replace(SCENE, plant=SOFT, move_time=0.5, randomise=())


def moved(method="dop853", **changes):
    """The tip (nt, 2) and the largest |deflection| [m] in the scene's own motion."""
    plant = dataclasses.replace(SOFT, **changes)
    u = np.array([SCENE.nominal_input(t) for t in SCENE.times])
    motion = plant.simulate(np.zeros(plant.nx), u, SCENE.times, method=method, rtol=1e-7, atol=1e-9)
    return np.column_stack([motion["tip_x"], motion["tip_y"]]), np.abs(motion["tip_deflection"]).max()


@pytest.mark.filterwarnings("ignore::pliant.plants.ValidityWarning")
@pytest.mark.parametrize("method", ["dop853", "rodas5p"])
def test_stiffened_arm_loses_its_mass_and_says_where(method):
    with pytest.raises(MassMatrixError, match=r"not positive definite .* at tip_deflection = -0\.\d+ m"):
        moved(method, kinematics="stiffened", modes=2)


@pytest.mark.filterwarnings("error::pliant.plants.ValidityWarning")
def test_exact_rotations_hold():
    (three, bent), (four, _) = moved(kinematics="strain", modes=3), moved(kinematics="strain", modes=4)
    assert bent > 0.4 * SOFT.link.length
    assert np.abs(three - four).max() < 1e-3 * SOFT.link.length


def test_mass_stays_definite_however_far_a_link_bends(random_state):
    strain = dataclasses.replace(SOFT, kinematics="strain", modes=3)
    for seed in range(5):
        x = 20.0 * random_state(strain, seed)
        assert np.linalg.eigvalsh(strain.mass_matrix(x))[0] > 0
