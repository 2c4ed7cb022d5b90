"""Coordinates, speeds and inputs of joints by kind."""

import pytest

from pliant.plants import Joint
from pliant.plants.multibody_joints.freedoms import coordinates, ends, freedoms, slots


@pytest.mark.parametrize(
    ("kind", "q", "v"),
    [("revolute", 1, 1), ("prismatic", 1, 1), ("fixed", 0, 0), ("spherical", 4, 3), ("planar", 3, 3), ("free", 7, 6)],
)
def test_counts(kind, q, v):
    joint = Joint(name="j", kind=kind)
    assert (len(coordinates(joint)), len(freedoms(joint))) == (q, v)


def test_names_and_units():
    first, *_, last = freedoms(Joint(name="j", kind="free"))
    assert (first.place.name, first.rate.name, first.force.name, first.force.unit) == (
        "j_x",
        "j_x_rate",
        "j_force_x",
        "N",
    )
    assert (last.place.name, last.rate.name, last.force.name, last.force.unit) == (
        "j_attitude_z",
        "j_rate_z",
        "j_torque_z",
        "N m",
    )
    assert (first.acceleration.name, first.acceleration.unit) == ("j_acceleration_x", "m/s^2")
    (turn,) = freedoms(Joint(name="hub"))
    assert (turn.place.unit, turn.acceleration.name, turn.acceleration.unit) == ("rad", "hub_acceleration", "rad/s^2")


def test_slots():
    found = slots([Joint(name="a", kind="free"), Joint(name="b"), Joint(name="c", kind="spherical")])
    assert [(s.q, s.v, s.turn) for s in found] == [(0, 0, (3, 3)), (7, 6, None), (8, 7, (8, 7))]
    assert ends(found) == (12, 10)
    assert ends(()) == (0, 0)
