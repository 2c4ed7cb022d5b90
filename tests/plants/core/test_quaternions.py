"""Quaternions against rotations known by hand and SciPy's."""

import casadi as ca
import numpy as np
from scipy.spatial.transform import Rotation

from pliant.plants.core.quaternions import about, cross, matrix, matrix_of, of_matrix, product, quaternion, rates, skew

RNG = np.random.default_rng(0)
Q = RNG.normal(size=(5, 4))
Q /= np.linalg.norm(Q, axis=1, keepdims=True)


def test_a_quarter_turn_about_z_takes_x_to_y():
    q = [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]
    np.testing.assert_allclose(matrix_of(q) @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(quaternion([0.0, 0.0, np.pi / 2]), q, atol=1e-15)
    turned = np.array(ca.DM(about([0.0, 0.0, 1.0], ca.SX(np.pi / 2))))
    np.testing.assert_allclose(turned @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-15)


def test_matrices_products_and_rotation_vectors_are_scipys():
    scipys = Rotation.from_quat(Q[:, [1, 2, 3, 0]])  # SciPy's scalar comes last
    np.testing.assert_allclose(matrix_of(Q), scipys.as_matrix(), atol=1e-15)
    np.testing.assert_allclose(np.array(ca.DM(matrix(ca.SX(ca.DM(Q[0]))))), scipys[0].as_matrix(), atol=1e-15)
    both = (scipys[:-1] * scipys[1:]).as_matrix()
    np.testing.assert_allclose(matrix_of(product(Q[:-1], Q[1:])), both, atol=1e-15)
    expression = product(ca.SX(ca.DM(Q[0])), ca.SX(ca.DM(Q[1])))
    np.testing.assert_allclose(np.array(ca.DM(expression)).ravel(), product(Q[0], Q[1]), atol=1e-15)
    vectors = scipys.as_rotvec()
    np.testing.assert_allclose(matrix_of(quaternion(vectors)), scipys.as_matrix(), atol=1e-15)


def test_no_turn_is_the_unit_quaternion():
    assert quaternion([0.0, 0.0, 0.0]).tolist() == [1.0, 0.0, 0.0, 0.0]


def test_rate_of_a_steady_turn_is_the_derivative_of_its_quaternion():
    """A body that turns at a steady omega: q(t) = q0 exp(omega t), so dq/dt = (q(h) - q(-h)) / 2 h."""
    omega, h = np.array([0.3, -0.7, 0.2]), 1e-5
    ahead, back = (product(Q[0], quaternion(s * h * omega)) for s in (1, -1))
    np.testing.assert_allclose(rates(Q[0]) @ omega / 2, (ahead - back) / (2 * h), atol=1e-10)
    np.testing.assert_array_equal(np.array(ca.DM(rates(ca.SX(ca.DM(Q[0]))))), rates(Q[0]))


def test_cross_products():
    a, b = RNG.normal(size=(2, 3))
    np.testing.assert_allclose(skew(a) @ b, np.cross(a, b), atol=1e-15)
    np.testing.assert_allclose(np.array(ca.DM(cross(ca.SX(ca.DM(a))))) @ b, np.cross(a, b), atol=1e-15)


def test_of_a_matrix_and_back():
    """Every branch: whichever component is largest."""
    for q in np.vstack([np.eye(4), np.random.default_rng(0).normal(size=(20, 4))]):
        q = q / np.linalg.norm(q)
        found = of_matrix(matrix_of(q))
        np.testing.assert_allclose(found, q * np.sign(q[np.argmax(np.abs(q))]), atol=1e-14)
