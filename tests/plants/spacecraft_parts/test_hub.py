"""Hub, wheels and thrusters."""

import pytest

from pliant.plants.spacecraft_parts.hub import Hub, Wheel

BAD_HUB = {
    "no body": (
        lambda: Hub(mass=1.0, inertia=(1.0, 1.0, 5.0)),
        r"the largest principal moment 5 kg m\^2 must be <= 2, the sum of the others",
    ),
    "not symmetric": (
        lambda: Hub(mass=1.0, inertia=((1.0, 0.2, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))),
        r"Hub\.inertia = .* must be symmetric and positive",
    ),
    "hub mass": (lambda: Hub(mass=0.0, inertia=(1, 1, 1)), r"Hub\.mass = 0\.0 must be > 0 \[kg\]"),
    "hub inertia": (lambda: Hub(mass=1.0, inertia=(1, -1, 1)), r"Hub\.inertia = .* must be symmetric and positive"),
    "wheel axis": (
        lambda: Wheel(axis=(1.0, 1.0, 0.0), inertia=1.0),
        r"Wheel\.axis = \(1\.0, 1\.0, 0\.0\) must be a unit vector",
    ),
}


@pytest.mark.parametrize("name", BAD_HUB)
def test_bad_input(name):
    make, words = BAD_HUB[name]
    with pytest.raises(ValueError, match=words):
        make()
