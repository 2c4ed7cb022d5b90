"""A notch on the wrong frequency: behind a roll-off the loop shakes the first mode up, and Pliant says so beforehand.

The craft and its law are those of tests/cases/data_sheet_craft.py; the roll-off turns the phase of its first mode, free
at 0.8305 rad/s, and a notch above it adds to that.
"""

import numpy as np
import pytest
from data_sheet_craft import pointing, scene, shifted

from pliant.controllers import Filtered, loop, margins, notch, roll_off
from pliant.plants import PliantError
from pliant.studies import monte_carlo
from pliant.studies.closed_loop.rollout import rollout

SCENE = scene(duration=200.0)


def law(at: float) -> Filtered:
    """A notch at a frequency [rad/s] behind a roll-off."""
    return Filtered(pointing(0.1, 0.25), (roll_off(0.6), notch(at, depth=0.05, width=0.8)))


def loop_of(plant, at: float):
    return loop(plant.feedback_model(plant.state()), law(at))


def test_at_the_mode_it_holds_elsewhere_it_does_not() -> None:
    assert margins(loop_of(SCENE.plant, 0.8305)).disk > 0.5
    for wrong in (1.2, 1.6):  # below the mode it would lead, and hold too
        with pytest.raises(PliantError, match="the closed loop is not stable"):
            margins(loop_of(SCENE.plant, wrong))


def test_the_motion_grows_as_the_loop_says() -> None:
    """Played without the warning: what swings at the end has grown by the pole's own rate."""
    bad = Filtered(pointing(0.2, 0.25), (roll_off(0.6), notch(1.6, depth=0.05, width=0.8)))
    played = rollout(SCENE, bad)
    poles = np.linalg.eigvals(loop(SCENE.plant.feedback_model(SCENE.plant.state()), bad).closed())
    rate = np.log(np.abs(poles).max()) / 0.25
    swing = np.abs(played["eta1_1"])
    early, late = swing[200:400].max(), swing[600:800].max()  # 100 s later
    assert rate > 0 and np.log(late / early) / 100 == pytest.approx(rate, rel=0.1)


def test_a_craft_whose_mode_is_elsewhere_is_counted() -> None:
    """The notch is right for the data sheet, wrong for a craft 30 % softer."""
    assert margins(loop_of(shifted(SCENE.plant, 0.9), 0.8305)).disk > 0
    with pytest.raises(PliantError, match="not stable"):
        margins(loop_of(shifted(SCENE.plant, 0.7), 0.8305))
    found = monte_carlo(scene(20.0), law(0.8305), {"appendages.0.stiffness_factor": (0.45, 0.5)}, runs=2)
    assert len(found.unstable) == 2 and not found.failures  # it grows, though it lasts: the count says both
