"""Whether plans last: one state by hand, two masses by what is played."""

import numpy as np
import pytest
from two_masses import LIMIT, MODEL, play, tube

from pliant.controllers import DisturbanceSet, TubeMPC
from pliant.plants import LinearModel

ONE = LinearModel.from_matrices([[1.0]], [[1.0]], states=["x"], inputs=["u"], dt=1.0)


@pytest.mark.parametrize(
    ("limit", "size", "last"), [(0.1, 0.07, True), (0.1, 0.1, False), (0.3, 0.1, True), (0.3, 0.2, False)]
)
def test_of_one_state_it_is_two_inequalities(limit, size, last):
    """x+ = x + u + w, N = 1 and two periods more under u = -f x, g = 1 - f; limits of |x| 1 and of |u| `limit`.

    A plan ends its horizon in |xi| <= min((limit - u1)/f, (1 - t2)/g, (limit - u2)/(f g), (1 - t3)/g^2); new are
    f g^2 xi <= limit - u3 and g^3 xi <= 1 - t4, with t and u the sums of what errors are then, of states and inputs.
    """
    given = {"horizon": 1, "terminal": 2, "limits": (-limit, limit), "bounds": {"x": (-1, 1)}}
    law = TubeMPC.design(ONE, [[1.0]], [[100.0]], DisturbanceSet.box([size]), **given)
    f, k = law.course.Kf[0, 0, 0], law.course.K[0, 0, 0]
    assert f == pytest.approx((np.sqrt(401) - 1) / 200)  # the Riccati equation of one state, P^2 - P - 100 = 0
    g, errors = 1 - f, size * np.array([1.0, 1 - k, (1 - k) * (1 - f), (1 - k) * (1 - f) ** 2])
    t = np.concatenate([[0.0], np.cumsum(errors)])
    u = np.concatenate([[0.0], np.cumsum(errors * [k, f, f, f])])
    xi = min((limit - u[1]) / f, (1 - t[2]) / g, (limit - u[2]) / (f * g), (1 - t[3]) / g**2)
    assert (f * g**2 * xi <= limit - u[3] and g**3 * xi <= 1 - t[4]) == last
    assert law.lasting() == last


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
