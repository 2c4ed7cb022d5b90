"""What a loop makes of a nominal, by hand in one dimension, and progress along a straight path."""

import numpy as np
import pytest

from pliant.controllers import riccati
from pliant.controllers.linear_quadratic.nominal_loop import PathProgress, own_nominal

ONE = np.ones((2, 1, 1))


def test_a_defect_is_met_as_the_regulator_says():
    """x+ = x + u + c, c = (1, 0), J = sum x^2 + u^2 + x_2^2: from e_0 = 0, k_0 from the Riccati recursion by hand.

    P_2 = 1; step 1: K = 1/2, P_1 = 1 + 1 - 1/2 = 3/2; step 0: u = -(3/2)/(5/2) (e + 1) = -0.6, e_1 = 0.4, u_1 = -0.2.
    """
    found = riccati.dtvlqr(ONE, ONE, [[1.0]], [[1.0]], c=[[1.0], [0.0]], end=[[1.0]])
    x, u = np.array([[5.0], [6.0], [7.0]]), np.array([[2.0], [3.0]])
    own, fed = own_nominal(found, ONE, ONE, np.array([[1.0], [0.0]]), x, u)
    np.testing.assert_allclose(own, [[5.0], [6.4], [7.2]], rtol=1e-12)
    np.testing.assert_allclose(fed, [[1.4], [2.8], [3.0]], rtol=1e-12)


def test_progress_between_slowest_and_fastest():
    path = PathProgress(np.arange(10.0)[:, None], np.ones(1), 0.25, 2.0)
    assert path.node(np.array([0.2])) == 0 and path.phase == 0.25  # it lags: a quarter of a node
    assert path.node(np.array([7.0])) == 2 and path.phase == 2.0  # it is ahead: two nodes at most
    assert path.node(np.array([3.1])) == 3
    for _ in range(10):
        last = path.node(np.array([99.0]))
    assert last == 9
    path.reset()
    assert path.phase == 0.0
    with pytest.raises(ValueError, match="slowest <= 1 <= fastest"):
        PathProgress(np.zeros((2, 1)), np.ones(1), 1.5, 2.0)
