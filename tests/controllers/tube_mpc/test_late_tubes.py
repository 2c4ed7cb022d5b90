"""Inputs on their way as states of a tube: what disturbs them, what is known of them, what is refused."""

import numpy as np
import pytest
from two_masses import GIVEN, HELD, MODEL, PUSH, Q, R, tube

from pliant.controllers import MPC, TubeMPC
from pliant.controllers.linear_quadratic.delay import delayed
from pliant.controllers.tube_mpc.late_tubes import (
    asked_instead,
    on_their_way,
    put_on_their_way,
    whole_periods,
    widened,
)
from pliant.envs import scenes


def test_nothing_disturbs_inputs_on_their_way():
    wide = widened(PUSH, 6)
    rows = np.random.default_rng(0).normal(size=(5, 6))
    np.testing.assert_array_equal(wide.support(0, rows), PUSH.support(0, rows[:, :4]))
    np.testing.assert_array_equal(wide.noise, [*PUSH.noise, 0.0, 0.0])
    assert widened(PUSH, 4) is PUSH


def test_the_newest_input_on_its_way_can_be_another_than_was_given():
    law = MPC.design(MODEL, Q, R, horizon=5, delay=3, before=[0.1], **GIVEN)
    np.testing.assert_array_equal(on_their_way(law), [0.1, 0.1, 0.1])
    given = law.act(0.0, np.array([0.5, 0.5, 0.0, 0.0]))
    np.testing.assert_array_equal(on_their_way(law), [0.1, 0.1, *given])
    asked_instead(law, np.array([0.3]))
    np.testing.assert_array_equal(on_their_way(law), [0.1, 0.1, 0.3])
    put_on_their_way(law, np.array([0.1, 0.2, 0.3]))
    other = MPC.design(MODEL, Q, R, horizon=5, delay=3, **GIVEN)
    x = np.array([0.05, 0.05, 0.0, 0.0])
    put_on_their_way(other, np.array([0.1, 0.2, 0.3]))
    np.testing.assert_array_equal(law.act(0.0, x), other.act(0.0, x))


def test_of_a_law_without_a_delay_none_are_on_their_way():
    law = MPC.design(MODEL, Q, R, horizon=5, **GIVEN)
    assert len(on_their_way(law)) == 0
    asked_instead(law, np.array([0.3]))


def test_the_course_is_of_the_plant_with_its_inputs_on_their_way():
    law, held = tube(horizon=5, delay=2), delayed(HELD, 2)
    np.testing.assert_allclose(law.course.A[0], held.A, atol=1e-12)
    np.testing.assert_allclose(law.course.B[0], held.B, atol=1e-12)
    still = tube(horizon=5)
    for late, first in ((law.course.Kf[0], still.course.Kf[0]),):  # the regulator reads the state it will meet
        ahead = np.linalg.matrix_power(held.A, 2)[:4]
        np.testing.assert_allclose(late, first @ ahead, atol=1e-9)
    assert law.reads == MODEL.state_names and law.share[0] > still.share[0]


def test_bad_input():
    for wrong in (-1, 0.5, "1", None, (0, 1), 101):
        with pytest.raises(ValueError, match=r"TubeMPC\.delay"):
            whole_periods(wrong)
    with pytest.raises(ValueError, match=r"TubeMPC\.delay = 1 must be 0 with a sampled model"):
        TubeMPC.design(HELD, Q, R, PUSH, delay=1)
    scene = scenes.get("single-link-slew")
    nominal = scene.plant.simulate(scene.initial[0], None, scene.times[:4])
    with pytest.raises(ValueError, match=r"TubeMPC\.delay = 2 must be 0 along a nominal"):
        TubeMPC.for_scene(scene, nominal=nominal, delay=2)
