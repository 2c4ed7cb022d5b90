"""What is asked about where nothing is said, and how numbers and energies are said."""

import pytest
from horizon_models import constant, random_ltv

from pliant.plants.core.signals import Signal
from pliant.plants.finite_horizon.asked import asked, asked_of, energy, listed, said, usual, within


def test_numbers_have_their_units():
    assert said(0.00605, "m") == "6.05 mm" and said(1.234, "m") == "1.23 m"
    assert said(2e-4, "rad") == "0.2 mrad" and said(0.5, "1") == "0.5" and said(3.0, "N m") == "3 N m"


def test_energies_and_limits_name_what_they_are_of():
    x, y, turn = Signal("f_x", "N"), Signal("f_y", "N"), Signal("m_z", "N m")
    ones = {"f_x": 1.0, "f_y": 1.0, "m_z": 1.0}
    assert energy([x, y], ones) == "f_x and f_y of unit energy (1 N^2 s)"
    assert energy([turn], {"m_z": 2.0}) == "m_z of the energy (4 (N m)^2 s)"
    assert energy([x, turn], ones) == "disturbances of as much energy as 1 N of f_x, 1 N m of m_z for one second"
    assert within([x, y], ones) == "at most 1 N of each" and within([x], ones) == "at most 1 N"
    assert within([x, turn], ones) == "at most 1 N of f_x, 1 N m of m_z"
    assert listed(["a", "b", "c"]) == "a, b and c" and listed(["a"]) == "a"


def test_what_is_usual():
    """Everything of the unit of the first output, by all that pushes where no force or torque is fitting."""
    model = random_ltv(0)
    assert usual(model, None, None) == (list(model.output_names), list(model.disturbance_names))
    assert usual(model, ["x1"], None)[0] == ["x1"]


def test_other_models_have_no_horizon():
    assert asked_of("assess", object(), None, None, None, None) is None
    with pytest.raises(ValueError, match=r"assess.limits = \{\} of a int, must be None"):
        asked_of("assess", 3, None, None, {}, None)
    with pytest.raises(ValueError, match="one of"):
        asked(constant([[-1.0]], [[1.0]], [[1.0]], 1.0), ["tip"], None, None, None)
