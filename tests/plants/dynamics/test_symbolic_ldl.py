"""L diag(d) L' of expressions by hand."""

import casadi as ca
import numpy as np

from pliant.plants.dynamics.symbolic_ldl import ldl, ldl_solve


def test_factors_of_a_matrix_by_hand():
    """[[4, 2], [2, 5]] = [[1, 0], [1/2, 1]] diag(4, 4) [[1, 1/2], [0, 1]]; its solution of (8, 8) is (1.5, 1)."""
    L, d = ldl(ca.SX([[4.0, 2.0], [2.0, 5.0]]))
    np.testing.assert_array_equal(np.array(ca.DM(L)), [[1.0, 0.0], [0.5, 1.0]])
    assert [float(v) for v in d] == [4.0, 4.0]
    np.testing.assert_array_equal(np.array(ca.DM(ldl_solve(L, d, ca.SX([8.0, 8.0])))).ravel(), [1.5, 1.0])
