"""Too much bandwidth: an LQR with effort almost free drives the first mode beyond its model; `spillover` foretells it.

A lightly damped steel link, modelled with its rigid body (two modes at 0 Hz) and two bending modes: modes 1 to 4. The
loop on that model decays; mode 5, 127 Hz, is in reach of the sampling at 500 Hz and of the loop's 111 Hz.
"""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR
from pliant.controllers.analysis.loops import closed_loop
from pliant.controllers.analysis.spillover import spillover
from pliant.plants import SingleLinkArm

DT = 0.002
TEXTBOOK = SingleLinkArm.textbook()
LINK = dataclasses.replace(TEXTBOOK.link, damping=2e-6)
DESIGN = dataclasses.replace(TEXTBOOK, link=LINK, basis="clamped-free", modes=2)
FINER = [dataclasses.replace(DESIGN, modes=n) for n in (3, 4, 6)]
MODEL = DESIGN.linearize(np.zeros(DESIGN.nx))
WEIGHTS = {"hub_angle": 10.0, "tip_deflection": 100.0, "tip_deflection_rate": 0.1}
CHEAP = 2e-9


def designed(factor=1.0):
    return LQR.design(MODEL, WEIGHTS, {"hub_torque": CHEAP * factor}, dt=DT)


def swings(plant, law, seconds=1.0):
    """How far the tip's deflection rate [m/s] still swings in the last tenth, from 0.1 mrad off the goal."""
    start = np.zeros(plant.nx)
    start[0] = 1e-4
    motion = plant.simulate(start, law, DT * np.arange(round(seconds / DT) + 1), rtol=1e-7, atol=1e-10)
    return float(np.ptp(motion["tip_deflection_rate"][motion.t > 0.9 * seconds]))


@pytest.fixture(scope="module")
def report():
    return spillover(designed(), [DESIGN, *FINER], {"hub_angle": 0.0}, redesign=designed)


def test_it_is_said_before_any_simulation(report):
    assert len(MODEL.modes()) == 4 and report.cases[0].stable
    first = report.first
    assert first.plant == FINER[0].label and first.number == 5 and first.lacking and first.dominant_state == "eta3"
    known = FINER[0].natural_frequencies()[-1] / (2 * np.pi)  # from M and K
    assert first.frequency_hz == pytest.approx(known, rel=1e-3) and not report.holds
    assert "mode 5 of the plant, 127 Hz (eta3), grows" in report.verdict
    assert "the design model has only 4" in report.verdict


def test_simulation_confirms(report):
    """The tip's deflection rate grows at the rate foretold, by a factor of 10 in 0.4 s; the design model is at rest."""
    law = designed()
    assert swings(DESIGN, law, 1.2) < 1e-5
    early, late = (swings(FINER[0], law, seconds) for seconds in (0.8, 1.2))
    assert np.log(late / early) / 0.4 == pytest.approx(report.cases[1].growth, rel=0.05)
    assert late > 5 * early and late > 1e-2


def test_the_bandwidth_it_recommends_holds(report):
    assert report.by == "effort" and report.factor > 100 and report.allowed_hz < 0.5 * report.bandwidth_hz
    law = designed(report.factor)
    np.testing.assert_array_equal(law.K, report.controller.K)
    assert swings(FINER[0], law) < swings(FINER[0], designed()) / 100
    for plant in FINER:
        model = plant.linearize(np.zeros(plant.nx))
        for gain in (1.0, 1.25):
            assert np.abs(np.linalg.eigvals(closed_loop(model, law, gain))).max() < 1
    near = spillover(designed(report.factor / 1.1), [DESIGN, *FINER], {"hub_angle": 0.0}, reserve=1.0)
    assert near.bandwidth_hz > report.allowed_hz  # a little less effort gives more bandwidth, and less than the reserve


def test_without_a_redesign_the_gain_is_turned_down():
    """To the factor at which a gain margin of 1.25 is left, found to 1 %."""
    law = designed(1e3)
    report = spillover(law, [DESIGN, FINER[0]], {"hub_angle": 0.0})
    assert report.by == "gain" and 0 < report.factor < 1 and report.controller is None
    model = FINER[0].linearize(np.zeros(FINER[0].nx))
    at = {g: np.abs(np.linalg.eigvals(closed_loop(model, law, g * report.factor))).max() for g in (1.0, 1.25, 1.27)}
    assert at[1.0] < 1 and at[1.25] < 1 < at[1.27]
