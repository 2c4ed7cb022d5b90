"""Motions computed once, with inputs held."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies.common.reference_motions import Motions, share

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
