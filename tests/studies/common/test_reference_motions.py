"""Motions computed once, with inputs held."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR, PD
from pliant.envs import scenes
from pliant.studies.common.reference_motions import ClosedMotions, Motions, Sampled, share

SLEW = scenes.get("single-link-slew", duration=0.4, move_time=0.2)


def test_inputs_are_held_and_motions_are_kept():
    motions = Motions(SLEW)
    np.testing.assert_array_equal(motions.held[3], SLEW.nominal_input(3 * SLEW.dt))
    plant = motions.ladder[1]
    assert motions.converged(plant) is motions.converged(plant) and motions.difference(plant, plant) == 0.0
    other = motions.converged(motions.ladder[2])
    assert motions.difference(plant, other) == motions.difference(plant, motions.ladder[2]) > 0.0


def test_other_inputs_may_be_held():
    still = Motions(SLEW, np.zeros((len(SLEW.times), 1)))
    assert np.ptp(still.outputs(SLEW.plant, 1e-6), axis=0).max() == 0.0
    with pytest.raises(ValueError, match=r"Motions.inputs has shape \(3, 1\), must be"):
        Motions(SLEW, np.zeros((3, 1)))


def test_a_part_takes_its_share_of_the_bar():
    seen = []
    part = share(lambda fraction, task: seen.append((fraction, task)), 0.2, 0.6)
    for fraction in (-1.0, 0.5, 2.0):
        part(fraction, "x")
    assert [f for f, _ in seen] == pytest.approx([0.2, 0.4, 0.6])


def test_a_law_is_played_on_every_variant_at_the_control_times_alone():
    law = PD.for_scene(SLEW)
    closed = ClosedMotions(SLEW, law, "law")
    own = closed.run(SLEW.plant, rtol=1e-8, atol=1e-10)
    direct = SLEW.plant.simulate(SLEW.initial[0], law, SLEW.times, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(own.x, direct.x, atol=1e-9)
    fine = np.linspace(0.0, SLEW.times[-1], 4 * (len(SLEW.times) - 1) + 1)
    np.testing.assert_allclose(closed.at_nodes(SLEW.plant, closed.held, fine).x[::4], own.x, atol=1e-6)
    assert closed.simple == SLEW.plant and Motions(SLEW).simple == closed.ladder[0]
    assert not np.allclose(closed.run(closed.ladder[0]).u, closed.held)
    assert isinstance(closed.law, Sampled) and closed.law.dt == SLEW.dt


def test_a_law_of_shapes_or_of_another_period_is_refused():
    with pytest.raises(ValueError, match=r"law reads eta1, eta2.*give a law that reads outputs"):
        ClosedMotions(SLEW, LQR.for_scene(SLEW), "law")
    with pytest.raises(ValueError, match=r"law\.dt = 0\.005 s must be the control period of the scene, 0\.02 s"):
        ClosedMotions(SLEW, dataclasses.replace(PD.for_scene(SLEW), dt=0.005), "law")
