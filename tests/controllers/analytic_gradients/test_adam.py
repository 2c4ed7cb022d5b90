"""The method: it comes down a valley, and back where a step was too long."""

import numpy as np

from pliant.controllers.analytic_gradients.adam import Adam

CURVATURE = np.array([1.0, 100.0])


def value(theta: np.ndarray) -> float:
    return 1.0 + 0.5 * float((CURVATURE * theta**2).sum())


def test_down_a_valley() -> None:
    adam = Adam.start(np.array([1.0, -1.0]))
    for k in range(600):
        adam.step(value(adam.theta), CURVATURE * adam.theta, 0.05 * (1 - k / 600))
    assert value(adam.theta) < 1.0 + 1e-4


def test_what_got_worse_is_taken_back() -> None:
    adam = Adam.start(np.array([1.0, -1.0]))
    adam.step(2.0, np.array([1.0, 0.0]), 0.1)
    good = adam.good.copy()
    adam.step(5.0, np.array([1.0, 0.0]), 0.1)
    assert adam.returns == 1 and adam.scale == 0.5 and adam.count == 0
    np.testing.assert_array_equal(adam.theta, good)
    adam.step(np.nan, np.array([np.nan, 0.0]), 0.1)
    assert adam.returns == 2 and np.isfinite(adam.theta).all()


def test_hard_batches_do_not_end_it() -> None:
    """Every eighth batch costs ten times as much whatever theta is, and every ninth is out of the world."""
    adam, stuck = Adam.start(np.array([1.0, -1.0])), Adam.start(np.array([1.0, -1.0]))
    for k in range(600):
        factor = 10.0 if k % 8 == 7 else np.inf if k % 9 == 8 else 1.0
        rate = 0.05 * (1 - k / 600)
        for one, asks in ((adam, True), (stuck, False)):
            before = (lambda one=one, factor=factor: factor * value(one.good)) if asks else None
            one.step(factor * value(one.theta), CURVATURE * one.theta, rate, before)
    assert adam.returns == 0 and value(adam.theta) < 1.0 + 1e-4
    assert stuck.returns > 60 and stuck.scale < 1e-6


def test_what_got_worse_on_the_same_batch_is_taken_back() -> None:
    adam = Adam.start(np.array([1.0, -1.0]))
    adam.step(2.0, np.array([1.0, 0.0]), 0.1)
    good = adam.good.copy()
    adam.step(5.0, np.array([1.0, 0.0]), 0.1, lambda: 3.0)
    assert adam.returns == 1
    np.testing.assert_array_equal(adam.theta, good)
    adam.step(5.0, np.array([1.0, 0.0]), 0.1, lambda: 4.5)
    assert adam.returns == 1 and not np.array_equal(adam.theta, good)


def test_it_goes_on_from_what_it_says_of_itself() -> None:
    adam = Adam.start(np.array([1.0, -1.0]))
    for _ in range(5):
        adam.step(value(adam.theta), CURVATURE * adam.theta, 0.05)
    other = Adam.again({k: v.copy() for k, v in adam.arrays().items()}, adam.words())
    for one in (adam, other):
        one.step(value(one.theta), CURVATURE * one.theta, 0.05)
    np.testing.assert_array_equal(adam.theta, other.theta)
    assert Adam.again(Adam.start(np.zeros(2)).arrays(), Adam.start(np.zeros(2)).words()).smooth == np.inf


def test_an_easy_batch_does_not_hold_it_back_for_good() -> None:
    """Costs of 1 for a while, then of 2 for good: after a few returns it goes on, at full length in the end."""
    adam = Adam.start(np.array([1.0, -1.0]))
    for cost in [1.0] * 30 + [2.0] * 300:
        adam.step(cost, np.array([0.1, 0.0]), 1e-3)
    assert 0 < adam.returns < 10 and adam.scale == 1.0 and adam.count > 200
