"""Coordinates, speeds and inputs of joints by kind."""

import pytest

from pliant.plants import Joint
from pliant.plants.multibody_joints.freedoms import coordinates, ends, freedoms, motor_of, slots


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


def test_inputs_are_called_by_the_joints_own_name():
    """Also where that holds the word of another input."""
    (turn,) = freedoms(Joint(name="my_torque_tube"))
    assert (turn.force.name, turn.acceleration.name) == ("my_torque_tube_torque", "my_torque_tube_acceleration")
    x, *_ = freedoms(Joint(name="a_force_b", kind="planar"))
    assert (x.force.name, x.acceleration.name) == ("a_force_b_force_x", "a_force_b_acceleration_x")
    motor = motor_of(Joint(name="hub"))
    words = [s.name for s in motor]
    assert words == ["hub_motor", "hub_motor_rate", "hub_motor_torque", "hub_motor_acceleration"]


def test_slots():
    found = slots([Joint(name="a", kind="free"), Joint(name="b"), Joint(name="c", kind="spherical")])
    assert [(s.q, s.v, s.turn) for s in found] == [(0, 0, (3, 3)), (7, 6, None), (8, 7, (8, 7))]
    assert ends(found) == (12, 10)
    assert ends(()) == (0, 0)
