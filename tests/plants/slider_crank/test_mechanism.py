"""Parameters, signals and geometry of the mechanism."""

import dataclasses

import numpy as np
import pytest

from pliant.plants.slider_crank.plant import SliderCrank

PLANT = SliderCrank.textbook()


def changed(**changes):
    return dataclasses.replace(PLANT, **changes)


def test_ladder_shares_outputs_and_every_step_has_its_own_label():
    ladder = PLANT.ladder()
    assert ladder[0].label == "rigid" and len({p.label for p in ladder}) == len(ladder)
    assert all(p.outputs == PLANT.outputs for p in ladder)
    assert [p.nx for p in ladder] == [2, 4, 8, 4, 6, 8, 12]
    elements = changed(basis="frame-elements")
    np.testing.assert_array_equal(elements.ladder()[0].measure([0.4, 3.0]), ladder[0].measure([0.4, 3.0]))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"crank_speed": np.inf}, "crank_speed = inf"),
        ({"crank_speed": "fast"}, "crank_speed = 'fast'"),
        ({"slider_mass": -1.0}, "slider_mass = -1.0"),
        ({"basis": "springs"}, "basis = 'springs'"),
        ({"kinematics": "strain"}, "kinematics = 'strain'"),
        ({"basis": "frame-elements", "axial_modes": 1}, "axial_modes = 1"),
        ({"modes": 41}, "modes = 41"),
    ],
)
def test_bad_parameters_are_named(changes, message):
    with pytest.raises(ValueError, match=message):
        changed(**changes)
