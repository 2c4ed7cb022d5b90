"""The elimination of the bodies against dense solves with NumPy."""

import numpy as np


def test_the_block_arrow_solves_the_whole(anywhere, ring):
    craft = ring(5)
    x = anywhere(craft, size=0.01)
    M, found = craft.mass_matrix(x), craft.dynamics(x)
    order = [
        *(craft.turn(x).T @ found[craft.layout.velocity]),
        *found[craft.layout.omega],
        *found[craft.layout.rates :],
    ]
    rest = craft.residual(x, np.zeros(len(M)))
    np.testing.assert_allclose(M @ order, -rest, atol=1e-9 * np.abs(rest).max())
