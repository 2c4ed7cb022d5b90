"""Where states and inputs stand, counted by hand."""

from pliant.plants.spacecraft.layout import Layout


def test_places_of_two_appendages():
    """Two hinge axes with one mode, one hinge axis with three modes; only the second is driven."""
    at = Layout.of([2, 1], [1, 3], [0, 1], wheels=2, hub_inputs=4, translation=True)
    assert (at.position, at.quaternion) == (slice(0, 3), slice(3, 7))
    assert at.hinges == (slice(7, 9), slice(9, 10)) and at.modes == (slice(10, 11), slice(11, 14))
    assert (at.velocity, at.omega) == (slice(14, 17), slice(17, 20))
    assert at.hinge_rates == (slice(20, 22), slice(22, 23)) and at.mode_rates == (slice(23, 24), slice(24, 27))
    assert at.wheels == slice(27, 29)
    assert at.hub_inputs == slice(0, 4) and at.hinge_inputs == (slice(4, 4), slice(4, 5))
    assert at.rates == 20
    assert at.unknowns(0) == [6, 7, 9] and at.unknowns(1) == [8, 10, 11, 12]  # after the hub's six


def test_without_translation_the_unknowns_stand_where_they_were():
    at = Layout.of([2, 1], [1, 3], [0, 1], wheels=0, hub_inputs=3, translation=False)
    assert (at.position, at.quaternion, at.velocity, at.omega) == (
        slice(0, 0),
        slice(0, 4),
        slice(11, 11),
        slice(11, 14),
    )
    assert at.unknowns(1) == [8, 10, 11, 12] and at.wheels == slice(21, 21)
