"""Without the shortening of a bent link an arm in fast spin diverges falsely: "all nonlinearities" were not all."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import SingleLinkArm, TwoLinkArm

LOCKED = ("theta1", "theta2")
LINEAR = dataclasses.replace(TwoLinkArm.textbook(), gravity=0.0, tip_slope=False)
STIFFENED = dataclasses.replace(LINEAR, kinematics="stiffened")


def spinning(arm, rate):
    x = np.zeros(arm.nx)
    x[arm.nx // 2] = rate
    return x


def lowest(arm, rate):
    """Lowest frequency [rad/s] of the straight arm with both joints locked, turning at `rate` [rad/s]."""
    return arm.natural_frequencies(spinning(arm, rate), locked=LOCKED)[0]


def test_linear_kinematics_loses_its_lowest_frequency_at_the_reference_rate(reference):
    limit = reference("two_link")["spurious_spin_limit_without_foreshortening_rad_s"]
    below, above = lowest(LINEAR, limit * (1 - 1e-9)), lowest(LINEAR, limit * (1 + 1e-9))
    assert below > 0 > above  # a negative number stands for a growing motion
    assert max(below, -above) < 1e-3
    assert lowest(LINEAR, 0.5 * limit) < lowest(LINEAR, 0.0)


def test_stiffened_kinematics_gains_stiffness_instead(reference):
    limit = reference("two_link")["spurious_spin_limit_without_foreshortening_rad_s"]
    for arm in (STIFFENED, dataclasses.replace(STIFFENED, tip_slope=True)):
        rates = [0.0, 0.5 * limit, limit, 2 * limit]
        found = [lowest(arm, rate) for rate in rates]
        assert np.all(np.diff(found) > 0)


@pytest.mark.parametrize(("kinematics", "grows"), [("linear", True), ("stiffened", False)])
def test_a_nudge_grows_without_bound_only_without_shortening(kinematics, grows):
    arm = dataclasses.replace(SingleLinkArm.textbook(), kinematics=kinematics, drive="motion")
    first = arm.natural_frequencies(locked=())[0]
    x = spinning(arm, 1.3 * first)
    x[1] = 1e-6
    motion = arm.simulate(x, None, np.linspace(0, 1, 201))
    assert (np.abs(motion["tip_deflection"]).max() > 1e-2) == grows
