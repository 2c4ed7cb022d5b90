"""Clamped modes of finite-element matrices against the boom's closed forms."""

import numpy as np
import pytest
from boom_matrices import BOOM, frame_matrices

from pliant.plants.core.quaternions import skew
from pliant.plants.modal_data.modal_data import ModalData


def test_structural_matrices_give_the_boom():
    M, K, positions = frame_matrices()
    data, exact = ModalData.from_matrices(M, K, positions, root=[0], modes=3), ModalData.boom(BOOM, (1, 2))
    np.testing.assert_allclose(data.frequencies, np.sort(exact.frequencies), rtol=5e-3)
    assert data.mass == pytest.approx(10.0, rel=1e-12)
    for k, l in ((0, 0), (1, 1), (2, 2)):
        scale = np.sqrt(exact.modal_mass[l, l] / data.modal_mass[k, k])
        order = np.argsort(np.sqrt(np.diag(exact.stiffness)))[l]
        assert np.abs(data.R[k] * scale).max() == pytest.approx(np.abs(exact.R[order]).max(), rel=1e-2)


def test_lumping_that_changes_the_body_is_refused():
    """A mass on an arm across the boom: its offset couples translations and turns, which lumping would drop."""
    M, K, positions = frame_matrices(8)
    M[:48, :48] *= 0.1
    mass, arm = 5.0, np.array([0.0, 3.0, 0.0])
    last = slice(48, 54)
    M[last, last] += mass * np.block([[np.eye(3), -skew(arm)], [skew(arm), -skew(arm) @ skew(arm)]])
    with pytest.raises(ValueError, match=r"lumping at the nodes changes the first moment by 0\.\d+ of itself"):
        ModalData.from_matrices(M, K, positions, root=[0], modes=2)
    M, K, positions = frame_matrices(8)
    M[51:54, 51:54] += 100.0 * np.eye(3)
    with pytest.raises(ValueError, match=r"changes the inertia by 0\.\d+ of itself"):
        ModalData.from_matrices(M, K, positions, root=[0], modes=2)
