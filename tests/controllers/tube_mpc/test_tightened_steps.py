"""Limits moved in: as far as the error takes them, and refused where nothing is left."""

import numpy as np
import pytest
from two_masses import GIVEN, LIMIT, MODEL, PUSH, Q, R, tube

from pliant.controllers import MPC, TubeMPC
from pliant.controllers.tube_mpc.error_bounds import Tightening
from pliant.controllers.tube_mpc.tightened_steps import crowding, largest_share
from pliant.plants import InfeasibleError


def test_each_row_is_moved_by_what_its_signal_may_be_off():
    law, plain = tube(horizon=5), MPC.design(MODEL, Q, R, horizon=5, **GIVEN)
    new, old = law.mpc._steps[0], plain._steps[0]
    moved = ((old.high - new.high) * new.scale).reshape(5, 2)  # the force in periods 0 .. 4, the speed in 1 .. 5
    np.testing.assert_allclose(moved[:, 0], law.taken.u_high[0, :5, 0], atol=1e-12)
    np.testing.assert_allclose(moved[:, 1], law.taken.z_high[0, 1:6, 0], atol=1e-12)
    np.testing.assert_allclose(((new.low - old.low) * new.scale).reshape(5, 2)[:, 0], moved[:, 0], atol=1e-12)
    assert moved[0, 0] == 0.0  # of the input that is given at once


def test_the_share_names_the_worst():
    law = tube(horizon=5)
    share, name = law.share
    found = {"F": law.taken.u_high[0].max(), "v2": law.taken.z_high[0].max() / LIMIT}
    assert name == max(found, key=lambda key: found[key])
    assert share == pytest.approx(found[name])


def test_a_goal_near_a_limit_is_crowded():
    """Of an input held at 0.8 of limits of +-1 an error of 0.1 takes half of the room, of one at zero a tenth."""
    taken = Tightening(*(np.full((1, 1, 1), 0.1) for _ in range(2)), *(np.zeros((1, 1, 1)) for _ in range(2)))
    limits, none = tube(horizon=5).mpc.limits, np.zeros((1, 1))
    assert crowding(taken, limits, (none, np.array([[0.8]]), none)) == pytest.approx(0.5)
    assert crowding(taken, limits, (none, np.array([[0.0]]), none)) == pytest.approx(0.1)
    assert largest_share(taken, limits) == (pytest.approx(0.1), "F")


def test_where_the_error_takes_a_whole_range_it_is_refused_by_name():
    with pytest.raises(InfeasibleError, match=r"TubeMPC: what is uncertain may take .* times the range of (F|v2)"):
        TubeMPC.design(MODEL, Q, R, PUSH.scaled(20.0), **GIVEN)
