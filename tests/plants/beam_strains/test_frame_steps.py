"""One step of a frame along a curvature that changes on the way, against integration."""

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from pliant.plants.beam_strains.frame_steps import NODES, combined, left_rates, step
from pliant.plants.core.quaternions import matrix_of


def curvature(xi):
    return np.array([np.sin(2 * xi) + 0.5, 2 - xi**2, 1.5 * np.cos(3 * xi)])


def turned(h):
    def slope(xi, y):
        k = curvature(xi)
        K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
        return (y.reshape(3, 3) @ K).ravel()

    return solve_ivp(slope, (0, h), np.eye(3).ravel(), method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1].reshape(3, 3)


def error(h):
    k = np.stack([curvature(h * c) for c in NODES])[:, :, None]
    e = np.asarray(step()(combined(k, h)[:, 0])[0]).ravel()
    assert np.linalg.norm(e) == pytest.approx(1, abs=1e-14)
    return np.abs(matrix_of(e) - turned(h)).max()


def test_error_of_a_step_falls_with_its_seventh_power():
    sizes = np.array([1.0, 0.5, 0.25])
    errors = [error(h) for h in sizes]
    assert errors[1] < 2e-4
    order = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert 6.5 < order < 8.5


def test_a_constant_curvature_is_exact():
    k = np.array([0.3, -1.2, 0.8])
    e = np.asarray(step()(combined(np.tile(k, (3, 1))[:, :, None], 1.0)[:, 0])[0]).ravel()
    np.testing.assert_allclose(matrix_of(e), Rotation.from_rotvec(k).as_matrix(), atol=1e-14)


def test_spins_are_those_of_the_frames():
    """T y' against the difference of frames, R' R^T = spin~."""
    y, rate = np.random.default_rng(1).uniform(-0.5, 0.5, (2, 9))
    R, T = matrix_of(np.asarray(step()(y)[0]).ravel()), np.asarray(step()(y)[1])
    h = 1e-5
    ends = [matrix_of(np.asarray(step()(y + s * h * rate)[0]).ravel()) for s in (-1, 1)]
    S = (ends[1] - ends[0]) / (2 * h) @ R.T
    np.testing.assert_allclose(T @ rate, [S[2, 1], S[0, 2], S[1, 0]], atol=1e-9)


def test_left_rates_turn_about_reference_axes():
    p = np.asarray(step()(np.linspace(-0.5, 0.5, 9))[0]).ravel()
    w = np.array([0.2, -0.4, 0.3])
    rate = np.concatenate([[-p[1:] @ w], p[0] * w + np.cross(w, p[1:])]) / 2  # (0, w) p/2
    np.testing.assert_allclose(2 * np.asarray(ca.DM(left_rates(ca.SX(p)))) @ rate, w, atol=1e-15)
