"""Starts of lanes: the scene's own, drawn, and what is given in place of either."""

import numpy as np

from pliant.envs import scenes
from pliant.envs.simulation.lane_starts import LaneStarts, put_parameters

SLEW = scenes.get("single-link-slew")
LANES = np.arange(3)


def unasked() -> np.random.Generator:
    raise AssertionError("random numbers were asked for")


def test_nothing_drawn_is_one_row_for_all() -> None:
    x, obs, w, p = LaneStarts(SLEW, 3).begin(LANES, False, None, unasked)
    assert np.array_equal(x, SLEW.initial[0][None]) and p.tolist() == [SLEW.varied_plant.nominal_parameters.tolist()]
    assert w.shape == (1, SLEW.plant.nw) and obs[0, 0] == -1.0  # the goal is at 1 rad


def test_given_parameters_are_at_their_own_rest_and_given_states_as_they_are() -> None:
    reach = scenes.get("two-link-reach")
    state = np.linspace(0.0, 0.01, reach.plant.nx)
    given = [{"parameters": {"payload.mass": 0.6}}, {"state": state}, {}]
    x, obs, _, p = LaneStarts(reach, 3).begin(LANES, False, given, unasked)
    heavy, _ = reach.varied_plant.equilibrium(dict(reach.start), p=[0.6])
    np.testing.assert_allclose(x[0], heavy, atol=1e-9)
    assert p[0, 0] == 0.6 and np.array_equal(x[1], state) and np.array_equal(x[2], reach.initial[0])
    np.testing.assert_allclose(obs[1, :2], state[:2] - [-0.9, 0.6], atol=1e-15)


def test_lanes_of_a_seed_begin_alike_whoever_else_does() -> None:
    one, two = LaneStarts(SLEW, 3), LaneStarts(SLEW, 3)
    one.seed(LANES, [4, 5, 6])
    two.seed(LANES, [4, 5, 6])
    want = one.begin(LANES, True, None, unasked)
    assert isinstance(one.generator(2), np.random.Generator)
    for lane in reversed(range(3)):
        for a, b in zip(two.begin(LANES[[lane]], True, None, unasked), want):
            assert np.array_equal(a[0], b[lane])


def test_parameters_are_put_by_name() -> None:
    p = np.ones((2, 2))
    put_parameters(("a", "b"), [{}, {"parameters": {"b": 3.0}}], p)
    assert p.tolist() == [[1.0, 1.0], [1.0, 3.0]]
