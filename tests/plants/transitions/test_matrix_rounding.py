"""Rounding of entries: zeros are meant, units do not matter."""

import numpy as np

from pliant.plants.transitions.matrix_rounding import EPS, cancelled, rounding

A = np.array([[0.0, 1.0], [-1e6, -1e-3]])


def test_zeros_are_taken_as_meant_and_others_are_off_by_a_few_roundings():
    D = rounding(A)
    assert D[0, 0] == 0.0 and (D[A != 0] >= EPS * np.abs(A[A != 0])).all()
    assert D[1, 0] <= 16 * EPS * 1e6


def test_what_is_left_of_larger_entries_of_its_unit_is_off_by_theirs():
    assert cancelled(A, ["m", "m"])[1, 1] == 16 * EPS * 1e6
    assert cancelled(A, ["m", "m/s"])[1, 1] == 16 * EPS * 1e-3
    assert not cancelled(A, ["", ""]).any()


def test_units_of_states_do_not_matter():
    unit = np.array([1.0, 2.0**20])
    np.testing.assert_allclose(
        cancelled(A * unit / unit[:, None], ["m", "m/s"]), cancelled(A, ["m", "m/s"]) * unit / unit[:, None]
    )
