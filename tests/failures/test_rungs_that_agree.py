"""Models that agree with each other because all of them lack the same physics.

A beam of 8 m is spun up to 2 rad/s within 1.5 s and lags by 3.4 m. Stiffened models, which keep the bend's shortening
to second order, with three to five modes agree to millimetres. Source of the true motion: `LargeDeflectionBeam`, other
code, whose rotations are exact, with shown convergence.
"""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import LargeDeflectionBeam
from pliant.studies import choose
from pliant.studies.common.reference_motions import Motions

SPIN = scenes.get("spin-up", speed=2.0, time=1.5, duration=1.5)
TOLERANCE = 0.01  # [m]


@pytest.fixture(scope="module")
def motions():
    return Motions(SPIN)


@pytest.fixture(scope="module")
def true(motions):
    """(tip deflection (nt,) [m], its own error)."""
    found = []
    for modes in (7, 8):
        beam = LargeDeflectionBeam(beam=SPIN.plant.link, root="driven", gravity=(0.0, 0.0, 0.0), modes=modes)
        motion = beam.simulate(np.zeros(beam.nx), motions.held, SPIN.times, rtol=1e-9, atol=1e-11)
        found.append(motion["tip_deflection"])
    return found[1], np.abs(found[1] - found[0]).max()


def test_the_naive_comparison_of_neighbours_is_wrong_by_hundreds_of_its_bounds(motions, true):
    stiffened = [motions.outputs(dataclasses.replace(SPIN.plant, basis="payload", modes=n), 1e-8)[:, 0] for n in (4, 5)]
    exact, error = true
    assert error < 1e-3 and np.abs(exact).max() > 3.0
    assert np.abs(stiffened[1] - stiffened[0]).max() < 0.1 * TOLERANCE
    assert np.abs(stiffened[1] - exact).max() > 100 * np.abs(stiffened[1] - stiffened[0]).max()


def test_choose_notices_and_what_it_takes_holds(motions, true):
    found = choose(SPIN, TOLERANCE, motions=motions)
    bounds = {r.variant: r.bound for r in found.rungs}
    assert bounds["stiffened, payload 4"] > 10 * TOLERANCE
    assert found.met and found.plant.kinematics == "strain"
    exact, error = true
    assert np.abs(motions.outputs(found.plant, 1e-8)[:, 0] - exact).max() <= TOLERANCE + error
