"""Information, covariances and directions that cannot be told: matrices whose answers are known."""

import numpy as np
import pytest

from pliant.plants.identification.fisher_information import Untold, condensed, covariance, sparse, untold

NAMES = ("a", "b", "c")


def test_a_condensed_jacobian_keeps_its_normal_equations():
    rng = np.random.default_rng(0)
    J, r = rng.normal(size=(40, 3)), rng.normal(size=40)
    T = condensed(J, r)
    assert np.abs(T.T @ T - np.column_stack([J, r]).T @ np.column_stack([J, r])).max() < 1e-12
    few = condensed(J[:2], r[:2])
    assert few.shape == (4, 4) and np.abs(few[:2, :3].T @ few[:2, :3] - J[:2].T @ J[:2]).max() < 1e-12


def test_nuisances_first_leave_the_schur_complement():
    rng = np.random.default_rng(1)
    J = rng.normal(size=(50, 5))
    left = condensed(J, np.zeros(50))[2:5, 2:5]
    whole = np.linalg.inv(J.T @ J)[2:, 2:]
    assert np.abs(np.linalg.inv(left.T @ left) - whole).max() < 1e-12


def test_covariance_of_any_scaling():
    rng = np.random.default_rng(2)
    J = rng.normal(size=(30, 3)) * [1e-9, 1.0, 1e9]
    C = covariance(np.linalg.qr(J, mode="r"))
    right = np.linalg.inv((J / [1e-9, 1, 1e9]).T @ (J / [1e-9, 1, 1e9])) / np.outer([1e-9, 1, 1e9], [1e-9, 1, 1e9])
    assert np.abs(C / right - 1).max() < 1e-9


def test_what_the_data_do_not_hold_has_infinite_variance():
    rng = np.random.default_rng(3)
    J = rng.normal(size=(30, 3))
    J[:, 1] = 2.0 * J[:, 0]
    C = covariance(np.linalg.qr(J, mode="r"))
    a, c = J[:, 0], J[:, 2]
    assert np.isinf(np.diag(C)[:2]).all() and C[2, 2] == pytest.approx(1 / (c @ c - (a @ c) ** 2 / (a @ a)))
    J[:, 2] = 0.0
    assert np.isinf(np.diag(covariance(J))[2])


def test_dependent_columns_are_named_together_and_silent_ones_alone():
    rng = np.random.default_rng(4)
    J = 1e3 * rng.normal(size=(30, 3))
    J[:, 1] = -2.0 * J[:, 0]
    (pair,) = untold(np.linalg.qr(J, mode="r"), NAMES)
    assert pair.names == ("a", "b") and pair.standard_deviation == np.inf
    assert pair.direction == pytest.approx((1.0, 0.5)) and "a and b cannot be told apart" in pair.words
    J[:, 2] *= 1e-6
    pair, alone = sorted(untold(np.linalg.qr(J, mode="r"), NAMES), key=lambda g: len(g.names), reverse=True)
    assert alone.names == ("c",) and alone.words == "c cannot be told from these data"
    assert alone.standard_deviation == pytest.approx(1 / np.linalg.norm(J[:, 2]))


def test_dependence_shows_however_loud_the_data_are():
    rng = np.random.default_rng(5)
    J = 1e12 * rng.normal(size=(30, 3))
    J[:, 1] = J[:, 0] * (1 + 1e-12)
    assert [g.names for g in untold(np.linalg.qr(J, mode="r"), NAMES)] == [("a", "b")]
    J[:, 1] = J[:, 0] + 1e-3 * J[:, 2] + 1e6 * rng.normal(size=30)
    assert untold(np.linalg.qr(J, mode="r"), NAMES) == ()


def test_a_weak_direction_is_untold_where_its_whole_size_stays_in_the_noise():
    R = np.diag([100.0, 100.0, 100.0])
    assert untold(R, NAMES) == ()
    along = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
    weak = R - 99.0 * np.outer(along, along)  # sensitivity 1 along (1, 1, 0)
    (pair,) = untold(weak, NAMES)
    assert pair.names == ("a", "b") and pair.standard_deviation == pytest.approx(1.0)
    assert untold(R - 97.0 * np.outer(along, along), NAMES) == ()  # 3 standard deviations


def test_two_pairs_are_two_groups():
    basis = np.array([[1.0, 1.0, 0.5, 0.5], [1.0, 1.0, -0.5, -0.5]])
    found = sparse(basis)
    assert sorted(tuple(np.flatnonzero(np.abs(row) > 1e-12)) for row in found) == [(0, 1), (2, 3)]
    assert np.abs(found).max(axis=1).tolist() == [1.0, 1.0] and sparse(np.zeros((0, 3))).shape == (0, 3)
    assert Untold(("a",), (1.0,), np.inf).words == "a cannot be told from these data"
