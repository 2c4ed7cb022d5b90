"""The root of a semidefinite matrix in any units and of any size."""

import numpy as np
import pytest

from pliant.plants.core.matrix_roots import semidefinite_root

CORRELATED = np.array([[1.0, 0.5, -0.2], [0.5, 2.0, 0.3], [-0.2, 0.3, 1.5]])
ONE = np.ones((3, 1))


@pytest.mark.parametrize("size", [1.0, 1e9, 1e-9, 1e150, 1e-150])
@pytest.mark.parametrize("unit", [1.0, 1e7, 1e-7])
def test_a_root_gives_its_matrix_back_in_any_units(size, unit):
    units = np.diag([1.0, unit, 1.0])
    weight = size * units @ CORRELATED @ units
    S = semidefinite_root(weight)
    even = np.sqrt(np.outer(np.diag(weight) / size, np.diag(weight) / size)) * size
    assert (np.abs(S @ S.T - weight) / even).max() < 1e-14


@pytest.mark.parametrize("size", [1.0, 1e9, 1e-9, 1e150, 1e-150])
@pytest.mark.parametrize("unit", [1.0, 1e7, 1e-7])
def test_rounding_is_no_direction_of_its_own_in_any_units(size, unit):
    """v v' has rank one: what rounding leaves of the others is cut off, however small or large one unit makes a row."""
    v = np.array([0.1, 0.7 * unit, 0.3])
    S = semidefinite_root(size * np.outer(v, v))
    assert S.any(axis=0).sum() == 1


def test_a_small_direction_is_kept_where_units_alone_make_it_small():
    weight = np.diag([1.0, 1e-20])
    np.testing.assert_allclose(np.sort(np.abs(semidefinite_root(weight)).sum(axis=0)), [1e-10, 1.0], rtol=1e-14)


def test_a_row_of_zeros_and_a_negative_part_count_as_zero():
    """The eigenvalues of [[1, 2], [2, 1]] are 3 and -1: the nearest semidefinite matrix is 1.5 ones."""
    np.testing.assert_array_equal(semidefinite_root(np.zeros((2, 2))), np.zeros((2, 2)))
    S = semidefinite_root(np.array([[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 0.0]]))
    expected = np.zeros((3, 3))
    expected[:2, :2] = 1.5
    np.testing.assert_allclose(S @ S.T, expected, atol=1e-14)


def test_a_stack_is_its_matrices_one_by_one():
    stack = np.stack([CORRELATED, 2.0 * np.eye(3), ONE @ ONE.T])
    for S, weight in zip(semidefinite_root(stack), stack, strict=True):
        np.testing.assert_allclose(S @ S.T, weight, atol=1e-14)
