"""Rotations as quaternions (scalar first) and matrices, for NumPy arrays and CasADi expressions.

R(q) takes components in body axes to reference axes; q and -q are the same attitude.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

Array = np.ndarray


def cross(a: ca.SX) -> ca.SX:
    """a~ (3, 3) with a~ b = a x b."""
    return ca.vertcat(
        ca.horzcat(0, -a[2], a[1]),
        ca.horzcat(a[2], 0, -a[0]),
        ca.horzcat(-a[1], a[0], 0),
    )


def skew(a: Any) -> Array:
    """a~ (..., 3, 3) of a (..., 3)."""
    a = np.asarray(a, dtype=float)
    S = np.zeros((*a.shape[:-1], 3, 3))
    S[..., 2, 1], S[..., 0, 2], S[..., 1, 0] = a[..., 0], a[..., 1], a[..., 2]
    return S - np.swapaxes(S, -1, -2)


def matrix(q: ca.SX) -> ca.SX:
    """R (3, 3) of a unit quaternion (4,)."""
    v = cross(q[1:])
    return ca.SX.eye(3) + 2 * q[0] * v + 2 * v @ v


def matrix_of(q: Any) -> Array:
    """R (..., 3, 3) of quaternions (..., 4), which are normalised first."""
    q = np.asarray(q, dtype=float)
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    v = skew(q[..., 1:])
    return np.eye(3) + 2 * q[..., :1, None] * v + 2 * v @ v


def rates(q: Any) -> Any:
    """Xi (4, 3), or (..., 4, 3) of an array: dq/dt = Xi omega / 2, omega in body axes relative to the reference."""
    if isinstance(q, ca.SX):
        return ca.vertcat(-q[1:].T, q[0] * ca.SX.eye(3) + cross(q[1:]))
    q = np.asarray(q, dtype=float)
    lower = q[..., :1, None] * np.eye(3) + skew(q[..., 1:])
    return np.concatenate([-q[..., None, 1:], lower], axis=-2)


def about(axis: Any, angle: Any) -> ca.SX:
    """Rotation (3, 3) by `angle` [rad] about a constant unit vector (3,)."""
    h = ca.sparsify(ca.DM(skew(axis)))
    hh = ca.sparsify(ca.DM(skew(axis) @ skew(axis)))
    return ca.SX.eye(3) + ca.sin(angle) * h + (1 - ca.cos(angle)) * hh


def product(a: Any, b: Any) -> Any:
    """The quaternion (..., 4) of R(a) R(b), or (4,) of expressions."""
    if isinstance(a, ca.SX):
        return ca.vertcat(a[0] * b[0] - ca.dot(a[1:], b[1:]), a[0] * b[1:] + b[0] * a[1:] + ca.cross(a[1:], b[1:]))
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    scalar = a[..., :1] * b[..., :1] - (a[..., 1:] * b[..., 1:]).sum(-1, keepdims=True)
    vector = a[..., :1] * b[..., 1:] + b[..., :1] * a[..., 1:] + np.cross(a[..., 1:], b[..., 1:])
    return np.concatenate([scalar, vector], axis=-1)


def quaternion(vector: Any) -> Array:
    """The quaternion (..., 4) of a rotation vector (..., 3) [rad]."""
    vector = np.asarray(vector, dtype=float)
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle / 2), np.sinc(angle / (2 * np.pi)) * vector / 2], axis=-1)


def of_matrix(R: Any) -> Array:
    """The unit quaternion (4,) of a rotation R (3, 3), its largest component positive (S. W. Shepperd, "Quaternion from
    rotation matrix", 1978).
    """
    R = np.asarray(R, dtype=float)
    squares = np.concatenate([[np.trace(R)], np.diag(R)])
    k = int(np.argmax(squares))
    q = np.empty(4)
    q[k] = np.sqrt(max(1 + 2 * squares[k] - np.trace(R), 0.0)) / 2
    spin, across = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]), R + R.T
    if k == 0:
        q[1:] = spin / (4 * q[0])
    else:
        q[0] = spin[k - 1] / (4 * q[k])
        q[1:] = np.where(np.arange(3) == k - 1, q[k], across[k - 1] / (4 * q[k]))
    return q
