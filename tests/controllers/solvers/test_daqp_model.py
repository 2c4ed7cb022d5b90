"""DAQP's wrapper: a program solved by hand, marks and flags, another try from no active set."""

import numpy as np
import pytest

from pliant.controllers.solvers.daqp_model import SOFT, WORDS, DaqpModel


def model(sense, A, far=1e30):
    marks = np.array(sense, dtype=np.intc)
    n = A.shape[1]
    return DaqpModel(np.eye(n), np.zeros(n), A, marks, far=far, tolerance=1e-9, iteration_limit=100)


def test_by_hand():
    """min |d|^2/2 - 3 d1, d1 + d2 <= 1: d = (2, -1), multiplier 1."""
    made = model([0], np.array([[1.0, 1.0]]))
    assert made.update(f=np.array([-3.0, 0.0]), bupper=np.array([1.0]), blower=np.array([-1e30]))
    assert made.solve() == pytest.approx([2.0, -1.0]) and made.multipliers == pytest.approx([1.0])
    assert made.iterations >= 1 and not made.violated
    made.forget()
    assert made.solve() == pytest.approx([2.0, -1.0])


def test_no_solution_is_said():
    made = model([0, 0], np.array([[1.0], [1.0]]))
    made.update(bupper=np.array([1e30, -1.0]), blower=np.array([1.0, -1e30]))
    assert made.solve() is None and WORDS[made.flag] == "infeasible"


def test_what_is_refused_is_said_and_costs_no_iterations():
    made = model([0], np.array([[1.0]]))
    made.solve()
    assert not made.update(bupper=np.array([-1.0]), blower=np.array([1.0])) or made.solve() is None
    assert made.flag < 0


def test_a_soft_row_is_violated_where_it_is_cheap():
    """min d^2/2 + w s, d >= 1 - s: d = w below 1."""
    made = model([SOFT], np.array([[1.0]]))
    made.price(0.25)
    made.update(bupper=np.array([1e30]), blower=np.array([1.0]))
    assert made.solve() == pytest.approx([0.25], rel=2e-3) and made.violated
