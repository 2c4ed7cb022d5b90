"""Limits of inputs and of their changes, and soft bounds: kept, and as good as the reference program's."""

import numpy as np
import pytest
from elastic_hub import DT, HELD, LINK, POINT, STATES, Q, R, moved, plan, roll
from predictive_programs import reference

from pliant.controllers import MPC
from pliant.envs import scenes


def test_input_limits_hold_exactly_and_the_plan_is_the_references():
    controller = MPC.design(LINK, Q, R, dt=DT, horizon=12, limits={"torque": (-0.8, 0.5), "piezo": (-0.3, 0.3)})
    low, high = np.array([-0.8, -0.3]), np.array([0.5, 0.3])
    bound = 0
    for x in STATES:
        u = controller.act(0.0, x)
        assert (low <= u).all() and (u <= high).all()
        bound += (u == low).any() or (u == high).any()
        expected = reference(x, 12, low=low, high=high)
        np.testing.assert_allclose(plan(controller), expected, atol=2e-6)
        np.testing.assert_allclose(u, expected[0], atol=2e-6)
    assert bound > 20 and controller.record.limited >= bound and not controller.record.failures


def test_rate_limits():
    controller = MPC.design(LINK, Q, R, dt=DT, horizon=10, limits=(-1.0, 1.0), rates=4.0)
    xs, us = roll(controller, [0.6, 0.0, 0.0, 0.0], 400)
    steps = np.diff(np.vstack([np.zeros(2), us]), axis=0)
    assert np.abs(steps).max() <= 4.0 * DT + 1e-15 and np.abs(steps).max() > 4.0 * DT - 1e-9
    assert np.abs(xs[-1]).max() < 1e-3
    controller.reset()
    for x, u in zip(xs[:15], us):
        before = controller._knowledge.last.copy()
        np.testing.assert_allclose(controller.act(0.0, x), u, atol=1e-8)
        expected = reference(x, 10, low=-1.0, high=1.0, change=0.2, last=before)
        np.testing.assert_allclose(plan(controller), expected, atol=2e-6)


def test_soft_bounds_are_as_good_as_hard_ones_where_those_can_be_kept():
    controller = MPC.design(LINK, Q, R, dt=DT, horizon=12, limits=(-3.0, 3.0), bounds={"bend": (-0.012, 0.012)})
    kept = beyond = 0
    for x in STATES * [1.0, 0.3, 0.5, 0.6]:
        controller.reset()
        u = controller.act(0.0, x)
        np.testing.assert_allclose(u, plan(controller)[0], atol=1e-9)
        hard = reference(x, 12, low=-3.0, high=3.0, bound=0.012)
        if hard is None:
            beyond += 1
            assert controller.record.violations == 1 and controller.record.worst[0] > 0
            price = controller._steps[0].solver.penalty
            soft = reference(x, 12, low=-3.0, high=3.0, bound=0.012, soft=price)
            np.testing.assert_allclose(plan(controller), soft, atol=1e-4)
        elif controller.record.limited:
            kept += 1
            assert controller.record.violations == 0
            np.testing.assert_allclose(plan(controller), hard, atol=5e-6)
    assert kept >= 10 and beyond >= 5


def test_a_low_penalty_is_not_exact():
    """The naive price, of the order of the other weights, exceeds bounds that could be kept."""
    x = [0.6, 0.0, 0.0, 0.0]
    options = {"dt": DT, "horizon": 12, "limits": (-3.0, 3.0), "bounds": {"bend": (-0.004, 0.004)}}
    cheap, dear = MPC.design(LINK, Q, R, penalty=1e-2, **options), MPC.design(LINK, Q, R, **options)
    cheap.act(0.0, np.array(x)), dear.act(0.0, np.array(x))
    assert reference(x, 12, low=-3.0, high=3.0, bound=0.004) is not None
    assert cheap.record.violations == 1 and dear.record.violations == 0 and dear.record.limited == 1


def test_steps_past_the_horizon_see_a_limit_that_a_short_one_does_not():
    options = {"dt": DT, "horizon": 2, "limits": (-3.0, 3.0), "bounds": {"theta": (-0.6, 0.05)}}
    x = [-0.5, 0.0, 1.0, 0.0]
    worst = [roll(MPC.design(LINK, Q, R, terminal=n, **options), x, 80)[0][:, 0].max() for n in (0, 25)]
    assert worst[0] > 0.05 + 1e-3 and worst[1] < 0.05 + 1e-6


def test_rate_limits_about_a_point_that_is_not_zero():
    """Deviations from the point do as they do about zero: the first change is counted from the input that holds."""
    options = {"dt": DT, "horizon": 10, "rates": 4.0}
    here = MPC.design(LINK, Q, R, limits=(-1.0, 1.0), **options)
    there = MPC.design(moved(LINK), Q, R, limits=(HELD - 1.0, HELD + 1.0), **options)
    x, sampled = np.array([0.6, 0.0, 0.0, 0.0]), LINK.discretize(DT)
    for k in range(30):
        u = here.act(k * DT, x)
        np.testing.assert_allclose(there.act(k * DT, POINT + x), HELD + u, atol=1e-9)
        x = sampled.A @ x + sampled.B @ u
    here.reset(), there.reset()
    far = np.array([-0.6, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(there.act(0.0, POINT + far), HELD + here.act(0.0, far), atol=1e-9)
    tight = MPC.design(moved(LINK), Q, R, limits=(0.5, 1.0), **options)  # u0 is below: 0.5 counts as the last input
    assert tight.act(0.0, POINT + far) == pytest.approx([0.7, 0.7], abs=1e-9)


@pytest.mark.parametrize("one", [(-0.004, 0.05), (-0.004, np.inf)])
def test_lower_ends_hold_as_upper_ones_do(one):
    """The model is linear: what is limited from below acts as the mirror image of what is limited from above."""
    options = {"dt": DT, "horizon": 12, "limits": (-3.0, 3.0)}
    below = MPC.design(LINK, Q, R, bounds={"bend": one}, **options)
    above = MPC.design(LINK, Q, R, bounds={"bend": (-one[1], -one[0])}, **options)
    free, changed = MPC.design(LINK, Q, R, **options), 0
    for x in STATES * [1.0, 0.05, 0.5, 0.1]:
        for law in (below, above, free):
            law.reset()
        u = below.act(0.0, x)
        np.testing.assert_allclose(above.act(0.0, -x), -u, atol=1e-8)
        changed += np.abs(u - free.act(0.0, x)).max() > 1e-3
    assert changed > 5


def test_bounds_and_limits_of_a_scene_are_on_both_sides():
    scene = scenes.get("single-link-slew")
    found = MPC.for_scene(scene).limits
    bounds = dict(scene.bounds)
    assert dict(zip(found.bounded, found.floor)) == {name: -value for name, value in bounds.items()}
    assert dict(zip(found.bounded, found.ceiling)) == bounds
    np.testing.assert_array_equal(found.low, [-value for value in scene.limits])
    np.testing.assert_array_equal(found.high, scene.limits)
