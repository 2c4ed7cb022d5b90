"""The paper's letters against sums over points and against each other, as Eqs (10)-(13) and (24) have them."""

import numpy as np
import pytest

from pliant.plants import Beam
from pliant.plants.core.quaternions import matrix_of, quaternion
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft_perturbation import paper_integrals as paper

BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8)
ROOTS = np.array([1.8751040687119611664, 4.6940911329741745764, 7.8547574382376125648])  # cos x cosh x = -1


def test_letters_follow_their_definitions():
    rng = np.random.default_rng(5)
    r, dm = rng.normal(size=(8, 3)), rng.uniform(0.5, 2, 8)
    phi = rng.normal(size=(3, 8, 3))
    data = ModalData.from_nodes(r, dm, phi, frequencies=np.ones(3))
    N, Y, C, E, Z = paper.N(data), paper.Y(data), paper.C(data), paper.E(data.overlaps), paper.Z(data.overlaps)
    for k in range(3):
        wanted = sum(m * (a @ b * np.eye(3) - np.outer(a, b)) for m, a, b in zip(dm, r, phi[k]))
        np.testing.assert_allclose(N[k], wanted, atol=1e-12)
        np.testing.assert_allclose(Y[k], sum(m * np.cross(a, b) for m, a, b in zip(dm, r, phi[k])), atol=1e-12)
        assert C[k] == pytest.approx(sum(m * (a @ b) for m, a, b in zip(dm, r, phi[k])))
        printed = np.array([N[k][2, 1] - N[k][1, 2], N[k][0, 2] - N[k][2, 0], N[k][1, 0] - N[k][0, 1]])
        np.testing.assert_allclose(Y[k], printed, atol=1e-12)  # Eq (11) as printed
        for l in range(3):
            pairs = zip(dm, phi[k], phi[l])
            wanted = sum(m * (a @ b * np.eye(3) - np.outer(a, b)) for m, a, b in pairs)
            np.testing.assert_allclose(E[k, l], wanted, atol=1e-12)
            e = E[k, l]
            printed = np.array([e[1, 2] - e[2, 1], e[2, 0] - e[0, 2], e[0, 1] - e[1, 0]])
            np.testing.assert_allclose(Z[k, l], printed, atol=1e-12)  # Eq (13) as printed
            np.testing.assert_allclose(
                Z[k, l], sum(m * np.cross(b, a) for m, a, b in zip(dm, phi[k], phi[l])), atol=1e-12
            )
            np.testing.assert_allclose(e, E[l, k].T, atol=1e-12)  # what the lower triangle of (12) must satisfy
    turn = matrix_of(quaternion([0.3, -0.2, 0.9]))
    turned = ModalData.from_nodes(r @ turn.T, dm, phi @ turn.T, frequencies=np.ones(3))
    np.testing.assert_allclose(paper.Z(turned.overlaps), Z @ turn.T, atol=1e-12)


def test_letters_of_a_uniform_boom():
    """int x phi dm = 2 m L/lambda^2 (Young and Felgar 1949)."""
    data = ModalData.boom(BOOM, (0, 3))
    np.testing.assert_allclose(paper.Y(data)[:, 1], -2 * 10.0 * 5.0 / ROOTS**2, rtol=1e-12)  # x e_x cross phi e_z
    np.testing.assert_allclose(paper.C(data), 0.0, atol=1e-12)  # shapes across the boom
