"""Inputs from a table, held against closed forms and against the law that was tabulated."""

import numpy as np

from pliant.plants import TwoLinkArm
from pliant.plants.motions.tabulated_inputs import CLOSE, TabulatedInputs, tabulated


class Law:
    time = 2.0

    def __init__(self, of):
        self.of = of

    def __call__(self, t):
        return self.at_times(np.array([t]))[0]

    def at_times(self, times):
        return np.column_stack([self.of(np.minimum(times, self.time)), 3.0 * np.cos(5 * np.minimum(times, self.time))])


def test_a_smooth_law_is_its_table():
    law = Law(lambda t: np.exp(-t) * np.sin(9 * t))
    table = tabulated(law)
    assert isinstance(table, TabulatedInputs)
    t = np.random.default_rng(0).uniform(0.0, 2.5, 400)
    assert np.abs(table.at_times(t) - law.at_times(t)).max() <= 10 * CLOSE * 3.0
    assert (table(0.3) == table.at_times(np.array([0.3]))[0]).all()
    assert (table(2.4) == law(2.4)).all()  # held: the law itself


def test_a_law_with_a_kink_serves_itself():
    law = Law(lambda t: np.abs(t - 0.7123))
    assert tabulated(law) is law


def test_what_has_no_at_times_is_left_alone():
    def hold(t):
        return np.zeros(1)

    assert tabulated(hold) is hold


def test_it_moves_an_arm_as_the_law_does():
    arm = TwoLinkArm.textbook().ladder()[0]
    u = arm.rest_to_rest(np.zeros(arm.nx), np.r_[1.0, 0.5, np.zeros(arm.nx - 2)], time=1.0)
    t = np.linspace(0.0, 1.2, 13)
    assert np.abs(tabulated(u).at_times(t) - u.at_times(t)).max() < 1e-9 * np.abs(u.at_times(t)).max()
