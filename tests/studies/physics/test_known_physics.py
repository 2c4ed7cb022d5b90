"""What is known of physics' motion."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants.validity.rotating_sections import NONE_HOLDS
from pliant.studies.physics.known_physics import PhysicsMotion, largest


def test_its_uncertainty_is_the_sum_of_what_each_refinement_left_and_of_what_it_leaves_out():
    physics = scenes.get("spin-up").plant.physics()
    told = PhysicsMotion(np.zeros((3, 1)), physics, 1e-6, 2e-6, 4e-6, "told", estimated={"extension": 8e-6})
    assert told.uncertainty == pytest.approx(15e-6) and told.outside == "" and told.beyond == ()


def test_ranges_are_told_apart_by_whether_other_kinematics_hold():
    physics = scenes.get("spin-up").plant.physics()
    entry = {"quantity": "slope", "unit": "1", "range": (0.0, 0.3), "largest": 0.5, "time": 0.1, "since": 0.05}
    entry |= {"keeps": "tip within 1 %", "holds": "strain"}
    other = entry | {"holds": NONE_HOLDS}
    told = PhysicsMotion(np.zeros((3, 1)), physics, 0.0, 0.0, 0.0, "told", left=(entry, other))
    assert told.outside.startswith("slope 0.5 at t = 0.1 s, 1.67 times the 0.3") and len(told.beyond) == 1
    assert largest(np.array([[1.0, -3.0]])) == 3.0
