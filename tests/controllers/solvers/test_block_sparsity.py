"""A banded matrix filled block by block is the dense one put together by hand."""

import numpy as np

from pliant.controllers.solvers.block_sparsity import Pattern, places


def test_blocks_on_and_beside_the_diagonal():
    rng = np.random.default_rng(0)
    own, before = rng.normal(size=(3, 2, 2)), rng.normal(size=(3, 2, 2))
    k, i, j = places(3, 2, 2)
    pattern = Pattern(6, 6, [2 * k + i, 2 * k + i], [2 * k + j, 2 * (k - 1) + j])
    wanted = np.zeros((6, 6))
    for n in range(3):
        wanted[2 * n : 2 * n + 2, 2 * n : 2 * n + 2] = own[n]
        if n:
            wanted[2 * n : 2 * n + 2, 2 * n - 2 : 2 * n] = before[n]
    np.testing.assert_array_equal(np.array(pattern.fill([own, before])), wanted)  # what is left of column 0 is dropped
    upper = Pattern(6, 6, [2 * k + i], [2 * k + j], upper=True)
    np.testing.assert_array_equal(np.array(upper.fill([own])), np.triu(wanted * (np.kron(np.eye(3), np.ones((2, 2))))))
