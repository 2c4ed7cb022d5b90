"""LQG from the tip alone and a wrong frequency: stable where it was designed, by a hair; not with 20 % less stiffness.

A motor at the hub, a camera on the tip, bending modes between them. The filter tells the tip's motion apart by the
mode's phase, which turns by 180 deg at the modelled frequency, not at the true one (11 % lower).
"""

import dataclasses

import numpy as np
import pytest

from pliant.controllers.analysis.loops import loop
from pliant.controllers.analysis.margins import margins
from pliant.controllers.analysis.spillover import growth, spillover
from pliant.controllers.estimation.sensors import Sensor, encoder
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.plants import SingleLinkArm

DT = 0.005
TEXTBOOK = SingleLinkArm.textbook()
PLANT = dataclasses.replace(
    TEXTBOOK, link=dataclasses.replace(TEXTBOOK.link, damping=1e-4), modes=2, kinematics="linear"
)
MODEL = PLANT.linearize(np.zeros(PLANT.nx))
SOFT = dataclasses.replace(PLANT, link=dataclasses.replace(PLANT.link, E=0.8 * PLANT.link.E))
SOFT_MODEL = SOFT.linearize(np.zeros(SOFT.nx))
CAMERA = (Sensor("other", "tip_y", "m", noise=1e-4),)
HUB = (encoder("hub_angle"),)
GUST, MOTOR = {"tip_force_y": 1.0}, {"hub_torque": 1.0}  # [N^2 s], [N^2 m^2 s]


def designed(factor=1.0, sensors=CAMERA, W=GUST):
    weights = {"hub_angle": 10.0, "tip_deflection": 100.0, "tip_deflection_rate": 0.1}
    return LQG.design(MODEL, weights, {"hub_torque": 2e-5 * factor}, sensors, W, dt=DT)


def peak_after(plant, law, seconds=4.0):
    """Largest tip deflection [m] in the last fifth, from 1 mrad off the goal."""
    start = np.zeros(plant.nx)
    start[0] = 1e-3
    motion = plant.simulate(start, law, DT * np.arange(round(seconds / DT) + 1), rtol=1e-7, atol=1e-10)
    return float(np.abs(motion["tip_deflection"][motion.t > 0.8 * seconds]).max())


def test_nominally_stable_and_unstable_with_less_stiffness():
    naive = designed()
    assert growth(MODEL, naive) < 0 < growth(SOFT_MODEL, naive)
    assert peak_after(PLANT, naive, 8.0) < 1e-4
    early, late = peak_after(SOFT, naive, 1.5), peak_after(SOFT, naive, 2.5)
    assert late > 5 * early


def test_the_margins_say_so_beforehand():
    """A change of gain by 4 % or of phase by 2 deg ends stability, at a frequency near the mode's."""
    found = margins(loop(MODEL, designed()))
    [channel] = found.channels
    assert found.disk < 0.03 and channel.disk_gain[1] < 1.03 and channel.disk_phase_deg < 1.5
    assert found.S.value > 30 and channel.gain[1] < 1.04 and channel.phase_deg < 2
    mode = SOFT_MODEL.modes()[2].frequency_hz
    assert MODEL.modes()[2].frequency_hz / mode == pytest.approx(1 / np.sqrt(0.8), rel=1e-3)
    assert 0.5 * mode < found.S.hz < 1.5 * mode


@pytest.mark.parametrize(
    ("sensors", "W", "disk"),
    [(HUB, GUST, 0.7), (CAMERA, MOTOR, 0.4), (HUB + CAMERA, GUST, 0.5)],
    ids=["hub encoder", "noise where the motor acts", "both sensors"],
)
def test_what_holds_instead(sensors, W, disk):
    law = designed(sensors=sensors, W=W)
    assert margins(loop(MODEL, law)).disk > disk
    assert growth(SOFT_MODEL, law) < -0.5
    assert peak_after(SOFT, law) < 1e-4


@pytest.mark.campaign
def test_or_less_bandwidth_by_as_much_as_spillover_says():
    report = spillover(designed(), [MODEL, SOFT_MODEL], redesign=designed)
    assert not report.holds and report.factor > 10
    assert growth(SOFT_MODEL, report.controller) < 0
    assert "holds with effort times" in report.verdict
    assert peak_after(SOFT, report.controller) < peak_after(SOFT, designed()) / 10
