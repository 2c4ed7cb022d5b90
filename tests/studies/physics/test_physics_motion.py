"""What physics gives, and how well that is known."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import LargeDeflectionBeam
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics.physics_motion import physics_motion
from pliant.studies.physics.quasi_linear import CorrectedMotion, NotSettled

SLEW = scenes.get("single-link-slew", duration=0.5, move_time=0.3)


@pytest.mark.parametrize("tolerance", [1e-3, pytest.param(1e-5, marks=pytest.mark.campaign)])
def test_it_is_as_near_to_the_simulated_motion_as_it_says(tolerance):
    """With natural modes in place of polynomials, one more of them, by another integrator."""
    found = physics_motion(Motions(SLEW), tolerance)
    other = dataclasses.replace(found.physics, basis="payload", modes=found.physics.modes + 1)
    exact = Motions(SLEW).outputs(other, 1e-10)
    assert np.abs(found.outputs - exact).max() <= found.uncertainty
    assert found.uncertainty - sum(found.estimated.values()) <= 0.1 * tolerance  # but for what physics leaves out
    assert found.motion is not None and "from the motion of rigid" in found.how and not found.outside


def test_a_spin_of_large_bends_is_that_of_the_large_beam():
    """Lagging by two metres of eight. LargeDeflectionBeam is other code; it has no shear, which is told apart."""
    spin = scenes.get("spin-up", speed=4.0, time=1.0, duration=1.0)
    motions = Motions(spin)
    found = physics_motion(motions, 2e-3)
    beam = LargeDeflectionBeam(beam=spin.plant.link, root="driven", gravity=(0.0, 0.0, 0.0), modes=6)
    motion = beam.simulate(np.zeros(beam.nx), motions.held, spin.times, rtol=1e-9, atol=1e-11)
    shear = 3 * spin.plant.link.section_ratios["shear"] * np.abs(motion["tip_deflection"]).max()
    assert np.abs(motion["tip_deflection"]).max() > 0.3
    assert np.abs(found.outputs[:, 0] - motion["tip_deflection"]).max() <= found.uncertainty + 3 * shear


@pytest.mark.campaign
def test_where_the_correction_does_not_settle_physics_is_simulated_and_it_says_so():
    own = SLEW.plant
    soft = dataclasses.replace(own, link=dataclasses.replace(own.link, E=1.0e10, length=1.4), hub_inertia=0.02)
    scene = scenes.get("single-link-slew", duration=0.6, move_time=0.4).with_plant(soft)
    motions = Motions(scene)
    found = physics_motion(motions, 5e-3)
    assert found.motion is None and ", simulated: " in found.how
    finer = dataclasses.replace(found.physics, modes=found.physics.modes + 1)
    assert np.abs(found.outputs - Motions(scene).outputs(finer, 1e-9)).max() <= found.uncertainty
    assert physics_motion(motions, 5e-3) is found  # kept


@pytest.mark.campaign
def test_a_finer_tolerance_is_asked_for_anew():
    motions = Motions(SLEW)
    assert physics_motion(motions, 1e-6).uncertainty < physics_motion(motions, 1e-2).uncertainty


def test_physics_is_simulated_where_nothing_settles(monkeypatch):
    """Here as it is told not to."""

    def never(self, within):
        raise NotSettled("as it was told")

    exact = physics_motion(Motions(SLEW), 1e-3)
    monkeypatch.setattr(CorrectedMotion, "settle", never)
    found = physics_motion(Motions(SLEW), 1e-3)
    assert found.motion is None and found.how.endswith("simulated: as it was told")
    tight = Motions(SLEW).outputs(found.physics, 1e-10)
    assert np.abs(found.outputs - tight).max() <= found.time < 1e-5  # measured, not a share of the tolerance
    assert np.abs(found.outputs - exact.outputs).max() <= found.uncertainty + exact.uncertainty
