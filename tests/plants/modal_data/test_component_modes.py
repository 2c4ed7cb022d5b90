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


def spring(along, across, axis=0):
    """A node on springs from a clamped one, a metre away along x: 3 freedoms a node."""
    k = np.diag(np.roll([along, across, across], axis))
    return np.block([[k, -k], [-k, k]])


@pytest.mark.parametrize("across", [1.0, 1e-3, 2e9])
def test_a_thin_boom_is_held_however_stiff_it_is_along_itself(across):
    found = ModalData.from_matrices(
        np.diag([0.0] * 3 + [1.0] * 3), spring(2e9, across), [[0.0] * 3, [1.0, 0.0, 0.0]], root=[0], modes=2
    )
    # Rounding of the largest entry, 6 eps 2e9, over the square that is found.
    np.testing.assert_allclose(np.asarray(found.frequencies) ** 2, across, rtol=6 * 2.2e-16 * 2e9 / across + 1e-12)


def test_rigid_motions_that_meet_no_force_are_found_by_moving_the_body():
    """A rod whose two ends are tied by an axial spring alone: it turns about its clamped end."""
    with pytest.raises(ValueError, match=r"from_matrices\.root clamps 3 freedoms, which leaves a rigid motion free"):
        ModalData.from_matrices(
            np.diag([0.0] * 3 + [1.0] * 3), spring(1.0, 0.0), [[0.0] * 3, [1.0, 0.0, 0.0]], root=[0], modes=1
        )


def test_a_plate_hinged_along_an_edge_is_free_whatever_its_stiffness():
    """Four nodes of a square joined by six springs along their lines; with two clamped it turns about their edge."""
    places = np.array([[0.0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]])
    for scale in (1e-6, 1.0, 1e12):
        K = np.zeros((12, 12))
        for i in range(4):
            for j in range(i):
                line = np.zeros(12)
                line[3 * i : 3 * i + 3] = places[i] - places[j]
                line[3 * j : 3 * j + 3] = places[j] - places[i]
                K += scale * np.outer(line, line)
        with pytest.raises(ValueError, match="clamps 6 freedoms, which leaves a rigid motion free"):
            ModalData.from_matrices(np.eye(12), K, places, root=[0, 1], modes=2)


def test_a_mechanism_within_is_told_from_a_rigid_motion():
    """Two masses in a row, the second held along the row alone: it moves across, the root's springs or not."""
    K = np.zeros((9, 9))
    K[:6, :6] = spring(1e6, 1e6)
    ahead = np.zeros(9)
    ahead[[3, 6]] = [1.0, -1.0]
    K += 1e6 * np.outer(ahead, ahead)
    with pytest.raises(ValueError, match=r"lets a mechanism move, or nearly|leaves a rigid motion free"):
        ModalData.from_matrices(np.eye(9), K, [[0.0] * 3, [1.0, 0, 0], [2.0, 0, 0]], root=[0], modes=1)
