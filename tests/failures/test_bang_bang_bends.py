"""Bang-bang: the least torque for a turn in a given time, and the most vibration, unless its spectrum has a zero there.

The energy that a turn leaves in undamped modes is that of closed form: a mode of the free craft, driven by the torque u
of a rigid turn, has in the end the energy that |int u(t) exp(j w t) dt|^2 says.
"""

import dataclasses

import numpy as np
import pytest
from data_sheet_craft import scene

from pliant.plants.integration.minimum_jerk import PROFILES
from pliant.studies.slews import compare_slews

HALF = np.deg2rad(60.0) / 2
TURN = (("quaternion_0", float(np.cos(HALF))), ("quaternion_1", float(-np.sin(HALF))))


def slews(time: float):
    """By profile, a turn of 60 degrees about x in `time` [s]."""
    found = compare_slews(dataclasses.replace(scene(time + 20.0), start=TURN, move_time=time), points=300)
    return {slew.profile: slew for slew in found}


def spectrum(profile: str, time: float, omega: float) -> float:
    """|int dds exp(j omega t) dt|^2 of the profile in `time`, by the trapezium rule."""
    s = np.linspace(0.0, 1.0, 20_001)[:-1] + 2.5e-5
    return float(np.abs((PROFILES[profile](s)[2] * np.exp(1j * omega * time * s)).mean() / time) ** 2)


@pytest.fixture(scope="module")
def quick():
    return slews(12.0)


@pytest.fixture(scope="module")
def slow():
    return slews(20.0)


def test_what_is_left_is_what_the_spectrum_of_the_first_mode_says(quick) -> None:
    """Relative to the bang-bang: in 12 s, 1.6 periods of the mode, it is the bang-bang that leaves least."""
    for profile in ("minimum-jerk", "jerk-limited"):
        said = spectrum(profile, 12.0, 0.83051738) / spectrum("bang-bang", 12.0, 0.83051738)
        assert said > 1.5
        assert quick[profile].left / quick["bang-bang"].left == pytest.approx(said, rel=0.3)


def test_in_more_time_it_leaves_most(slow) -> None:
    assert slow["bang-bang"].left > 4 * slow["minimum-jerk"].left > 4 * slow["jerk-limited"].left


def test_least_torque_of_all(slow) -> None:
    largest = [slow[name].largest for name in ("bang-bang", "jerk-limited", "minimum-jerk")]
    assert largest == sorted(largest)
    assert largest[1] / largest[0] == pytest.approx(4 / 3, rel=5e-3)  # 4 / (1 - 2/8) over 4
    assert largest[2] / largest[0] == pytest.approx(10 / np.sqrt(3) / 4, rel=5e-3)  # the quintic's largest
