"""What is searched: sizes, bounds, starts, and points to try."""

import numpy as np
import pytest
from springs import SPRING, VARIED

from pliant.plants import SingleLinkArm
from pliant.plants.identification.parameter_space import NEAREST_ZERO, ParameterSpace, is_plant, varied


def space(bounds=None, start=None, plant=VARIED):
    return ParameterSpace.of("identify", plant, bounds, start)


def test_bounds_are_what_a_parameter_may_be_unless_given():
    found = space({"stiffness": (10.0, 90.0)}, {"mass": 3.0})
    assert found.start.tolist() == [3.0, 0.8, 50.0] and found.scale.tolist() == [3.0, 0.8, 50.0]
    assert found.lower.tolist() == [3.0 * NEAREST_ZERO, 0.0, 10.0]
    assert found.upper.tolist() == [np.inf, np.inf, 90.0]
    assert found.units == ("kg", "N s/m", "N/m")
    assert found.at_bound(np.array([3.0, 0.0, 90.0])) == ["damping", "stiffness"]


def test_the_range_of_a_nested_parameter_is_its_own():
    arm = SingleLinkArm.textbook().vary("link.E", "payload.mass", "payload.offset.0")
    found = space(plant=arm, bounds={"payload.offset.0": (-0.1, 0.1)})
    assert found.lower[0] > 0 and found.lower[1] in (0.0, 1e-4) and found.scale[2] == pytest.approx(0.2)


def test_tries_are_a_latin_hypercube_within_the_bounds():
    found = space({"mass": (0.1, 10.0), "damping": (0.0, 2.0), "stiffness": (1.0, 100.0)})
    points = found.tried("identify", 9, 0)
    assert (points[0] == found.start).all() and len(points) == 9
    for column, low, high, rule in zip(points[1:].T, found.lower, found.upper, (np.log, lambda v: v, np.log)):
        cells = np.floor(8 * (rule(column) - rule(low)) / (rule(high) - rule(low)))
        assert sorted(cells) == list(range(8))
    assert found.tried("identify", 1, 0).tolist() == [found.start.tolist()]


@pytest.mark.parametrize(
    ("bounds", "start", "words"),
    [
        ({"masss": (1.0, 2.0)}, None, "parameter 'masss' must be one of mass, damping, stiffness"),
        ({"mass": (3.0, 1.0)}, None, r"bounds\['mass'\] = \(3\.0, 1\.0\) must be a lower and a higher number"),
        ({"mass": (3.0, 4.0)}, None, r"must hold the start 2"),
        ({"mass": (-1.0, 4.0)}, None, r"bounds\['mass'\]\[0\] = -1\.0 must be > 0"),
        ({"mass": 3.0}, None, r"bounds\['mass'\] has shape"),
        (None, {"mass": -1.0}, r"start\['mass'\] = -1\.0 must be > 0"),
        (None, {"damping": 0.0}, r"start\['damping'\] = 0 must have a size"),
    ],
)
def test_refused(bounds, start, words):
    with pytest.raises(ValueError, match=words):
        space(bounds, start)


def test_what_varies_nothing_or_has_no_bounds_is_refused():
    with pytest.raises(ValueError, match=r"plant\.varied = \(\) must name parameters: plant\.vary\(\.\.\) of mass"):
        varied("identify", SPRING)
    with pytest.raises(ValueError, match="plant = 3 must be a Plant"):
        is_plant("identify", 3)
    with pytest.raises(ValueError, match="tries = 4 needs bounds of mass, damping, stiffness"):
        space().tried("identify", 4, 0)
