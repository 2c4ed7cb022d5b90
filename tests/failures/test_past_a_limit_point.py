"""A buckled column that is pushed back snaps to its other side: past the limit point the next equilibrium is another.

Newton's method from the last rest finds one all the same, a jump that it does not tell from a step. Pliant follows the
branch and says where it ends.
"""

import numpy as np
import pytest

from pliant.plants import Beam, EquilibriumError, LargeDeflectionBeam, Plant
from pliant.plants.beams import STEEL

ROD = Beam.circular(1.0, 0.005, STEEL)
PLANT = LargeDeflectionBeam(
    beam=ROD, gravity=(0.0, 0.0, 0.0), modes=4, basis="polynomial", points=14, extensible=True, stretches=1
)
NAMES = [s.name for s in PLANT.coordinates]
CRITICAL = np.pi**2 / 4 * ROD.EI / ROD.length**2
UNIT = ROD.EI / ROD.length**2


def rest(push, guess):
    loads = {"tip_force_x": -1.1 * CRITICAL, "tip_force_y": push * UNIT}
    return PLANT.equilibrium(**loads, guess=guess)


def newton(push, guess):
    """Newton's method alone, as for plants that follow no load."""
    loads = {"tip_force_x": -1.1 * CRITICAL, "tip_force_y": push * UNIT}
    return Plant.equilibrium(PLANT, **loads, guess=guess)


def across(x):
    return dict(zip([s.name for s in PLANT.outputs], PLANT.measure(x)))["tip_y"]


def test_a_step_past_the_limit_point_is_an_error_not_the_other_side():
    x, _ = rest(0.0, {"bend1": 0.9})
    assert across(x) > 0.3
    for push in np.linspace(-0.01, -0.06, 6):
        x, _ = rest(push, dict(zip(NAMES, x)))
        assert across(x) > 0.1
    beyond = -0.2
    assert across(newton(beyond, dict(zip(NAMES, x)))[0]) < -0.2  # the naive way: on the other side, and not a word
    with pytest.raises(EquilibriumError, match=r"on the branch of the guess: it is lost at 0\.\d+ of the way"):
        rest(beyond, dict(zip(NAMES, x)))


def test_the_side_that_is_meant_is_reached_by_a_guess_on_it():
    x, _ = rest(-0.2, {"bend1": -0.9})
    assert across(x) < -0.2
