"""Functions called with NumPy arrays: one point, batches, shapes, threads, pickles."""

import pickle
from concurrent.futures import ThreadPoolExecutor

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import MAPS_KEPT, function

a, b = ca.SX.sym("a", 2), ca.SX.sym("b")
MADE = function("made", [a, b], [ca.vertcat(a[0] * b, a[1] + b, 1.0), a @ a.T])


def test_one_point_and_a_batch():
    vector, square = MADE(np.array([2.0, 3.0]), 10.0)
    assert vector.tolist() == [20.0, 13.0, 1.0]
    assert square.tolist() == [[4.0, 6.0], [6.0, 9.0]]
    vectors, squares = MADE(np.array([[2.0, 3.0], [1.0, 0.0]]), np.array([[10.0], [5.0]]), batch=2)
    assert vectors.tolist() == [[20.0, 13.0, 1.0], [5.0, 5.0, 1.0]]
    assert squares[1].tolist() == [[1.0, 0.0], [0.0, 0.0]]


def test_rows_and_columns_are_not_exchanged():
    matrix = function("matrix", [a], [ca.SX(ca.vertcat(a.T, 2 * a.T, 3 * a.T))], matrices=True)
    assert matrix(np.array([1.0, 5.0]))[0].tolist() == [[1.0, 5.0], [2.0, 10.0], [3.0, 15.0]]
    column = function("column", [a], [a], matrices=True)
    assert column(np.array([1.0, 5.0]))[0].shape == (2, 1)


def test_results_are_the_callers_own():
    first = MADE(np.array([1.0, 1.0]), 1.0)[0]
    MADE(np.array([7.0, 7.0]), 7.0)
    assert first.tolist() == [1.0, 2.0, 1.0]


def test_threads_and_pickles_give_the_same():
    again = pickle.loads(pickle.dumps(MADE))
    points = np.random.default_rng(0).normal(size=(200, 2))
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda x: again(x, 2.0)[0], points))
    np.testing.assert_array_equal(found, np.column_stack([2 * points[:, 0], points[:, 1] + 2, np.ones(200)]))


def test_many_batch_sizes_do_not_pile_up():
    for size in range(2, 3 * MAPS_KEPT):
        MADE(np.ones((size, 2)), np.ones((size, 1)), batch=size)
    assert len(MADE._local.buffers) <= MAPS_KEPT
