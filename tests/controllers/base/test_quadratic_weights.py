"""Weights as arrays or by name; by hand: 4 (x + 2 v + u/2)^2 has N = [2, 4] and adds 1 to R."""

import numpy as np
import pytest

from pliant.controllers.base.quadratic_weights import weight_matrices
from pliant.plants import LinearModel

MODEL = LinearModel.from_matrices(
    np.zeros((2, 2)), [[0.0], [1.0]], [[1.0, 2.0]], [[0.5]], states=["x", "v"], inputs=["u"], outputs=["y"]
)


def test_by_name():
    Q, R, N = weight_matrices("LQR", MODEL, {"y": 4.0, "v": 3.0}, {"u": 7.0})
    np.testing.assert_array_equal(Q, [[4.0, 8.0], [8.0, 19.0]])
    np.testing.assert_array_equal(R, [[8.0]])
    np.testing.assert_array_equal(N, [[2.0], [4.0]])


def test_arrays_are_taken_as_they_are():
    Q, R, N = weight_matrices("LQR", MODEL, np.diag([1.0, 2.0]), [[3.0]])
    assert Q.tolist() == [[1.0, 0.0], [0.0, 2.0]] and R.tolist() == [[3.0]] and not N.any()


@pytest.mark.parametrize(
    ("Q", "R", "message"),
    [
        ({"y": -1.0}, {"u": 1.0}, r"LQR.Q\['y'\] = -1.0 must be >= 0"),
        ({"z": 1.0}, {"u": 1.0}, r"LQR.Q: state or output 'z'"),
        ({"y": 1.0}, {}, r"LQR.R\['u'\] = 0 must be > 0"),
        ({"y": 1.0}, {"w": 1.0}, r"LQR.R: input 'w'"),
        (np.eye(3), {"u": 1.0}, r"LQR.Q has shape \(3, 3\)"),
    ],
)
def test_refusals(Q, R, message):
    with pytest.raises(ValueError, match=message):
        weight_matrices("LQR", MODEL, Q, R)
