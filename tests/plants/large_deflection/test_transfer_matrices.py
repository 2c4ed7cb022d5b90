"""Transfer matrices against minimal coordinates."""

import numpy as np
import pytest
from chain_cases import BEAM, LOADED, chain

from pliant.plants import PliantError, TransferMatrices


@pytest.mark.every(3)
@pytest.mark.parametrize("root", ["clamped", "hinged", "driven"])
@pytest.mark.parametrize(("segments", "modes", "frame"), [(1, 2, "chord"), (2, 3, "mean-axis"), (3, 2, "tangent")])
def test_transfer_matrices_give_the_accelerations_of_minimal_coordinates(root, segments, modes, frame):
    """By Eq (39) and by the sweep, at random states, with payload, damping, tip force and hub acceleration."""
    plant = chain(segments, modes, frame, of=LOADED, root=root)
    solver = TransferMatrices(plant)
    rng = np.random.default_rng(2)
    for _ in range(3):
        x, u, w = (0.4 * rng.uniform(-1, 1, k) for k in (plant.nx, plant.nu, plant.nw))
        expected = plant.dynamics(x, u, w=w)[plant.nx // 2 :]
        for method in ("product", "sweep"):
            got = solver.acceleration(x, u, w=w, method=method)
            np.testing.assert_allclose(got, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_the_sweep_holds_for_many_sub_beams_where_the_product_has_lost_its_digits():
    plant = chain(12, of=LOADED)
    rng = np.random.default_rng(3)
    x, u = 0.1 * rng.uniform(-1, 1, plant.nx), rng.uniform(-1, 1, 2)
    expected = plant.dynamics(x, u)[plant.nx // 2 :]
    solver = TransferMatrices(plant)
    np.testing.assert_allclose(solver.acceleration(x, u), expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    with pytest.raises(PliantError, match=r'product of 12 transfer matrices has lost its digits.*method="sweep"'):
        solver.acceleration(x, u, method="product")


def test_transfer_matrices_refuse_what_they_do_not_fit():
    with pytest.raises(ValueError, match=r"plant\.kinematics = 'strain' must be one of 'substructured'"):
        TransferMatrices(BEAM)
    with pytest.raises(ValueError, match=r"method = 'guess' must be one of 'sweep', 'product'"):
        TransferMatrices(chain(2)).acceleration(np.zeros(8), method="guess")
    with pytest.raises(ValueError, match=r"one state \(8,\), not a batch of 2"):
        TransferMatrices(chain(2)).acceleration(np.zeros((2, 8)))
