"""Booms and panels against closed forms (Young and Felgar 1949; Blevins 1979) and the beams' own integrals."""

import numpy as np
import pytest

from pliant.plants import Beam
from pliant.plants.beams.shape_functions import basis
from pliant.plants.modal_data.integrals import axial
from pliant.plants.modal_data.modal_data import ModalData

BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8, damping=0.01)
ROOTS = np.array([1.8751040687119611664, 4.6940911329741745764, 7.8547574382376125648])  # cos x cosh x = -1
SIGMA = (np.cosh(ROOTS) + np.cos(ROOTS)) / (np.sinh(ROOTS) + np.sin(ROOTS))


def test_uniform_boom_equals_its_closed_forms():
    data = ModalData.boom(BOOM, (1, 3))
    out = [k for k in range(data.n) if abs(data.R[k, 2]) > 0]
    m, L = 10.0, 5.0
    assert data.mass == pytest.approx(m, rel=1e-14)
    np.testing.assert_allclose(data.first, [m * L / 2, 0, 0], atol=1e-12)
    np.testing.assert_allclose(data.inertia, np.diag([0, m * L**2 / 3, m * L**2 / 3]), atol=1e-12)
    np.testing.assert_allclose(data.R[out, 2], 2 * m * SIGMA / ROOTS, rtol=1e-12)
    np.testing.assert_allclose(data.moments[out, 0, 2], 2 * m * L / ROOTS**2, rtol=1e-12)
    np.testing.assert_allclose(data.modal_mass, m * np.eye(4), atol=1e-12)
    omega = ROOTS**2 * np.sqrt(100.0 / (2.0 * L**4))
    np.testing.assert_allclose(np.sqrt(np.diag(data.stiffness)[out] / m), omega, rtol=1e-12)
    np.testing.assert_allclose(np.abs(data.tip_shapes[out, 2]), 2.0, rtol=1e-12)
    np.testing.assert_allclose(data.damping, 0.01 * data.stiffness)


def test_boom_as_nodes_converges():
    """Point masses along the boom with the modes sampled: the midpoint rule, error of order two."""
    exact, errors = ModalData.boom(BOOM, (0, 2)), []
    for count in (20, 40, 80):
        x = (np.arange(count) + 0.5) / count
        shapes = np.zeros((2, count, 3))
        shapes[:, :, 2] = basis("clamped-free", 2).phi(x).T
        nodes = np.column_stack([5 * x, 0 * x, 0 * x])
        data = ModalData.from_nodes(nodes, np.full(count, 10 / count), shapes, frequencies=exact.frequencies)
        errors.append(np.abs(data.R - exact.R).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.1)


def test_panel_is_a_pair_of_beams():
    data, boom = ModalData.panel(BOOM, 2.0, (2, 1)), ModalData.boom(BOOM, (0, 2))
    assert data.mass == pytest.approx(20.0)
    np.testing.assert_allclose(np.diag(data.inertia), [20.0, 500 / 3, 500 / 3 + 20.0], rtol=1e-12)
    np.testing.assert_allclose(data.R[:2], 2 * boom.R, atol=1e-12)
    np.testing.assert_allclose(data.R[2], 0, atol=1e-12)  # twisting moves no mass centre
    assert axial(data.moments)[2, 0] == pytest.approx(2 * boom.R[0, 2], rel=1e-12)  # but turns about x
    np.testing.assert_allclose(data.modal_mass, 20 * np.eye(3), atol=1e-12)


def test_panel_shortens_line_by_line():
    """Bending and twisting together: one beam bends twice as much, the other not at all; only the first shortens."""
    data, boom = ModalData.panel(BOOM, 2.0, (1, 1)), ModalData.boom(BOOM, (0, 1))
    eta = np.array([1.0, 1.0])
    first = np.einsum("kli,k,l->i", data.shortening, eta, eta)
    moment = np.einsum("klij,k,l->ij", data.shortening_moments, eta, eta)
    assert first[0] == pytest.approx(4 * boom.shortening[0, 0, 0], rel=1e-12)
    assert moment[1, 0] == pytest.approx(first[0] * 1.0, rel=1e-12)  # all of it at y = +1 m


def test_shortening_integrals_of_a_boom():
    """Against the beams' own integrals, which the rotating-beam references hold."""
    data, own = ModalData.boom(BOOM, (0, 3)), basis("clamped-free", 3)
    np.testing.assert_allclose(data.shortening[:, :, 0], 10.0 / 5.0 * own.shortening_mean, rtol=1e-11)
    np.testing.assert_allclose(data.shortening_moments[:, :, 0, 0], 10.0 * own.shortening_moment, rtol=1e-11)
