"""Whether plans last: one state by hand, two masses by what is played."""

import numpy as np
import pytest
from two_masses import LIMIT, MODEL, play, tube

from pliant.controllers import DisturbanceSet, TubeMPC
from pliant.plants import LinearModel

ONE = LinearModel.from_matrices([[1.0]], [[1.0]], states=["x"], inputs=["u"], dt=1.0)


@pytest.mark.parametrize("size", [0.05, 0.1, 0.2, 0.3])
def test_of_one_state_it_is_one_inequality_a_limit(size):
    """x+ = x + u + w, N = 1 and two periods more under u = -f x, f = 0.618 (the golden section, Q = R = 1).

    One period past the plan's last |x| <= (1 - f)(1 - t3), which must be <= 1 - t4; likewise |u|, within 1.5.
    """
    law = TubeMPC.design(
        ONE,
        [[1.0]],
        [[1.0]],
        DisturbanceSet.box([size]),
        horizon=1,
        limits=(-1.5, 1.5),
        bounds={"x": (-1, 1)},
        terminal=2,
    )
    f = (np.sqrt(5) - 1) / 2
    k = law.course.K[0, 0, 0]
    assert law.course.Kf[0, 0, 0] == pytest.approx(f)
    errors = size * np.array([1.0, 1 - k, (1 - k) * (1 - f), (1 - k) * (1 - f) ** 2])
    t = np.concatenate([[0.0], np.cumsum(np.abs(errors))])
    by_hand = (1 - f) * (1 - t[3]) <= 1 - t[4]
    u = np.concatenate([[0.0], np.cumsum(np.abs(errors) * [k, f, f, f])])
    by_hand &= f * (1 - t[3]) <= 1.5 - u[3]
    assert law.lasting() == by_hand


def test_no_period_past_the_horizon_shows_nothing():
    assert not tube(horizon=20, terminal=0).lasting()


def test_where_it_is_shown_the_next_plan_always_exists():
    law = tube(horizon=20, terminal=20)
    assert law.lasting()
    for seed in range(6):
        speed, force, first = play(law, [0.4, 0.4, 0.0, 0.0], seed)
        assert first and law.record.violations == 0
        assert speed <= LIMIT and force <= 1.0


def test_the_signals_of_the_model_are_its_states():
    assert tube(horizon=5).reads == MODEL.state_names
