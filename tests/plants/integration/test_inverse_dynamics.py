"""Inputs by inverse dynamics: what they do to the plant they were made for, one time and many at once."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import LargeDeflectionBeam, TwoLinkArm
from pliant.plants.integration.inverse_dynamics import InverseDynamics
from pliant.plants.integration.minimum_jerk import minimum_jerk

RIGID = TwoLinkArm.textbook().ladder()[0]
BEGIN, END = np.array([-1.2, 0.4, 0.0, 0.0]), np.array([0.3, 1.1, 0.0, 0.0])


def test_the_rigid_arm_makes_the_minimum_jerk_motion():
    law, times = RIGID.rest_to_rest(BEGIN, END, 0.8), np.linspace(0.0, 1.0, 11)
    assert isinstance(law, InverseDynamics)
    motion = RIGID.simulate(BEGIN, law, times, rtol=1e-10, atol=1e-12)
    s, ds, _ = minimum_jerk(times / 0.8)
    np.testing.assert_allclose(motion.x[:, :2], BEGIN[:2] + np.outer(s, (END - BEGIN)[:2]), atol=1e-9)
    np.testing.assert_allclose(motion.x[:, 2:], np.outer(ds, (END - BEGIN)[:2]) / 0.8, atol=1e-8)


def test_many_times_at_once_are_each_by_itself():
    law, times = InverseDynamics(RIGID, BEGIN, END, 0.8), np.array([0.0, 0.13, 0.79, 0.8, 0.9])
    one_by_one = np.array([law(float(t)) for t in times])
    scale = np.abs(one_by_one).max()
    np.testing.assert_allclose(law.at_times(times), one_by_one, rtol=0, atol=1e-13 * scale)
    np.testing.assert_allclose(law.at_times(times[::-1]), one_by_one[::-1], rtol=0, atol=1e-13 * scale)  # any order
    np.testing.assert_array_equal(law.at_times(np.array([0.8, 2.0])), np.array([law(0.8), law(5.0)]))
    assert law.at_times(times[:0]).shape == (0, 2)


def test_a_simulation_asks_for_all_stages_together():
    class Told(InverseDynamics):
        asked = 0

        def __call__(self, t):
            raise AssertionError("one by one")

        def at_times(self, times):
            self.asked += 1
            return self._inputs(times)

    law, times = Told(RIGID, BEGIN, END, 0.8), np.linspace(0.0, 0.7, 8)
    plain = RIGID.simulate(BEGIN, lambda t: InverseDynamics(RIGID, BEGIN, END, 0.8)(t), times)
    np.testing.assert_allclose(RIGID.simulate(BEGIN, law, times).x, plain.x, atol=1e-12)
    assert law.asked > 1


def test_inputs_that_reach_no_coordinate_are_refused():
    beam = LargeDeflectionBeam.textbook()
    with pytest.raises(ValueError, match=r"one coordinate each: the 2 of LargeDeflectionBeam .* drive none"):
        dataclasses.replace(beam, modes=3).rest_to_rest(np.zeros(6), np.zeros(6), 1.0)
