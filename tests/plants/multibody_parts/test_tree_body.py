"""What bodies refuse."""

import pytest

from pliant.plants import Joint, TreeBody

J = Joint(name="j")
TABLE = {
    "nameless": ({"name": ""}, r"TreeBody\.name = '' must be words"),
    "joint": ({"joint": "j"}, r"TreeBody\.joint = 'j' must be a Joint"),
    "mass": ({"mass": -1}, r"TreeBody\.mass = -1 must be >= 0 \[kg\]"),
    "centre": ({"centre": (1,)}, r"TreeBody\.centre = \(1,\) must be three numbers \[m\]"),
    "asymmetric": (
        {"inertia": ((1, 0.1, 0), (0, 1, 0), (0, 0, 1))},
        r"TreeBody\.inertia of body 'b' = .* must be symmetric",
    ),
    "no triangle": (
        {"inertia": ((1, 0, 0), (0, 1, 0), (0, 0, 3))},
        r"TreeBody\.inertia of body 'b' = .* no principal moment above .* 3 > 2",
    ),
    "negative": ({"inertia": -1.0}, r"TreeBody\.inertia of body 'b' = -1\.0 must have principal moments >= 0"),
    "beam": ({"beam": 1.0}, r"TreeBody\.beam = 1\.0 must be a Beam or None"),
    "modes": ({"modes": (1, 1)}, r"TreeBody\.modes = \(1, 1\) must be 4 integers"),
    "too many": ({"modes": (13, 0, 0, 0)}, r"TreeBody\.modes\[0\] = 13 must be an integer from 0 to 12"),
}


@pytest.mark.parametrize("name", TABLE)
def test_refused(name):
    changes, words = TABLE[name]
    with pytest.raises(ValueError, match=words):
        TreeBody(**({"name": "b", "joint": J} | changes))


def test_weightless():
    assert TreeBody(name="b", joint=J).weightless
    assert not TreeBody(name="b", joint=J, inertia=1.0).weightless
