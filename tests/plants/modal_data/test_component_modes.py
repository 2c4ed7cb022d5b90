"""Clamped modes of finite-element matrices against the boom's closed forms."""

import numpy as np
import pytest

from pliant.plants import Beam
from pliant.plants.core.quaternions import skew
from pliant.plants.modal_data.modal_data import ModalData

BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8, damping=0.01)


def frame_matrices(count=20, lumped=True):
    """Mass and stiffness of a cantilever boom of 6-freedom nodes, bending in x-z and x-y, stretching, twisting."""
    h, n = 5.0 / count, count + 1
    K, M = np.zeros((6 * n, 6 * n)), np.zeros((6 * n, 6 * n))
    for e in range(count):
        for t, r, sign, EI in ((2, 4, -1.0, 100.0), (1, 5, 1.0, 400.0)):
            k = (
                EI
                / h**3
                * np.array(
                    [
                        [12, 6 * h, -12, 6 * h],
                        [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                        [-12, -6 * h, 12, -6 * h],
                        [6 * h, 2 * h * h, -6 * h, 4 * h * h],
                    ]
                )
            )
            s = np.diag([1, sign, 1, sign])
            at = [6 * e + t, 6 * e + r, 6 * e + 6 + t, 6 * e + 6 + r]
            K[np.ix_(at, at)] += s @ k @ s
        for t, stiff in ((0, 1e6), (3, 160.0)):
            at = [6 * e + t, 6 * e + 6 + t]
            K[np.ix_(at, at)] += stiff / h * np.array([[1, -1], [-1, 1]])
        for node in (e, e + 1):
            M[6 * node : 6 * node + 3, 6 * node : 6 * node + 3] += h * np.eye(3)
    positions = np.column_stack([np.linspace(0, 5, n), np.zeros(n), np.zeros(n)])
    return M, K, positions


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
