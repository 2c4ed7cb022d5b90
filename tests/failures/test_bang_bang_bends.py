"""Bang-bang: the least torque for a turn in a given time, and the most vibration, unless its spectrum has a zero there.

The energy that is left is that of closed form. A rigid turn asks the torque J a(t), which drives the free craft's modes
by their participation: q_k'' + 2 d_k q_k' + w_k^2 q_k = -v_k' delta a(t), where diag(omega^2) v_k = w_k^2 (I - delta
J^-1 delta') v_k. In the end their energy is |v_k' delta int a(t) exp((d_k - j w_k) t) dt|^2 exp(-2 d_k T)/2, and decays
by 2 d_k. The turn is so small that the modes do not feel the spin.
"""

import dataclasses

import numpy as np
import pytest
import scipy.linalg as sla
from data_sheet_craft import DAMPING, DELTA, FREQUENCIES, J, scene

from pliant.plants.integration.minimum_jerk import PROFILES
from pliant.studies.slews import compare_slews

ANGLE, AFTER = np.deg2rad(6.0), 20.0  # [rad], [s] in which what is left is looked at
TURN = (("quaternion_0", float(np.cos(ANGLE / 2))), ("quaternion_1", float(-np.sin(ANGLE / 2))))


def slews(time: float):
    """By profile, a turn of 6 degrees about x in `time` [s]."""
    found = compare_slews(dataclasses.replace(scene(time + AFTER), start=TURN, move_time=time), points=300)
    return {slew.profile: slew for slew in found}


def closed_form(profile: str, time: float) -> float:
    """[J] in the mean of the time after the turn, all four modes; the integral by the midpoint rule."""
    squares, V = sla.eigh(np.diag(np.square(FREQUENCIES)), np.eye(4) - DELTA @ np.linalg.solve(J, DELTA.T))
    d, w = np.einsum("ik,i,ik->k", V, np.multiply(DAMPING, FREQUENCIES), V), np.sqrt(squares)
    s = (np.arange(20_000) + 0.5) / 20_000
    turned = ANGLE / time * (PROFILES[profile](s)[2] @ np.exp(np.outer(s, time * (d - 1j * w)))) / len(s)
    energies = np.abs(DELTA[:, 0] @ V * turned) ** 2 / 2 * np.exp(-2 * d * time)
    return float(energies @ ((1 - np.exp(-2 * d * AFTER)) / (2 * d * AFTER)))


@pytest.fixture(scope="module")
def quick():
    return slews(12.0)


@pytest.fixture(scope="module")
def slow():
    return slews(20.0)


def test_what_is_left_is_what_the_spectrum_says(quick, slow) -> None:
    for time, found in ((12.0, quick), (20.0, slow)):
        for profile, slew in found.items():
            assert slew.left == pytest.approx(closed_form(profile, time), rel=3e-3)


def test_at_a_zero_of_its_spectrum_it_leaves_least(quick) -> None:
    """In 12 s, 1.6 periods of the first mode."""
    assert min(quick["minimum-jerk"].left, quick["jerk-limited"].left) > 1.9 * quick["bang-bang"].left


def test_in_more_time_it_leaves_most(slow) -> None:
    assert slow["bang-bang"].left > 4 * slow["minimum-jerk"].left > 4 * slow["jerk-limited"].left


def test_least_torque_of_all(slow) -> None:
    largest = [slow[name].largest for name in ("bang-bang", "jerk-limited", "minimum-jerk")]
    assert largest == sorted(largest)
    assert largest[1] / largest[0] == pytest.approx(4 / 3, rel=5e-3)  # 4 / (1 - 2/8) over 4
    assert largest[2] / largest[0] == pytest.approx(10 / np.sqrt(3) / 4, rel=5e-3)  # the quintic's largest
