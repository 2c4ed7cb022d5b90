"""Inertial forces on a body given by its modes, at accelerations that are given: sums over fields, no mass matrix.

A point is at s = s_0 + sum_a c_a phi_a, the fields phi_a the modes and the shortening fields of `Deformed`, the
latter's amplitudes c functions of the coordinates eta. With W = int s phi^T dm and V = int (ds/dt) phi^T dm of every
field, each a sum over pairs of fields, all else is a sum over fields: d'Alembert's forces of

    a(s) = a_0 + alpha x s + omega x (omega x s) + 2 omega x ds/dt + d^2s/dt^2

on the origin, about it, and on eta: those on the fields times dc/deta.

Source   "Equations of Motion of Flexible Spacecraft", Eqs (2)-(13), by points in place of energies
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from pliant.plants.core.quaternions import cross

from .deformed_body import Fields, columns, constant
from .modal_fields import ModalFields


def inertial_forces(
    data: ModalFields,
    eta: ca.SX,
    rate: ca.SX,
    acceleration: ca.SX,
    omega: ca.SX,
    origin: ca.SX,
    alpha: ca.SX,
    stiffened: bool,
) -> ca.SX:
    """Force [N], torque about the origin [N m] and modal forces (6 + n,), in the body's axes: int a dm, int s x a dm
    and int (ds/deta) . a dm.

    eta, rate, acceleration (n,); omega [rad/s], the acceleration of the origin [m/s^2] and alpha [rad/s^2], (3,) each.
    """
    n, first = eta.shape[0], constant(data.first)
    if not n:
        return _of_points(
            float(data.mass), first, ca.SX(3, 1), ca.SX(3, 1), constant(data.second), omega, origin, alpha
        )
    fields = Fields.of(data, n, stiffened)
    c, dc, ddc = _amplitudes(fields, eta, rate, acceleration)
    count, R = len(fields.R), constant(fields.R.T)
    pairs, moments = constant(columns(fields.overlaps)), constant(fields.moments.reshape(-1))
    W = ca.reshape(moments + pairs @ c, 9, count)  # row 3 i + j: int s_i phi_j dm
    V = ca.reshape(pairs @ dc, 9, count)
    turned = cross(omega)
    whole = _of_points(
        float(data.mass), first + R @ c, R @ dc, R @ ddc, _second(data, fields, W, c), omega, origin, alpha
    )
    Q, H = _square(W @ dc), _square(W @ ddc)  # int s (ds/dt)^T dm, int s (d^2s/dt^2)^T dm
    whole[3:] += 2 * (ca.trace(Q) * omega - Q.T @ omega) + _axial(H)
    centripetal = omega @ omega.T - ca.dot(omega, omega) * ca.SX.eye(3) - cross(alpha)
    on_fields = R.T @ origin + W.T @ _row(centripetal) - 2 * V.T @ _row(turned)
    on_fields += constant(np.einsum("abii->ab", fields.overlaps)) @ ddc
    modal = on_fields[:n]
    for force, (k, l) in zip(ca.vertsplit(on_fields[n:]) if fields.pairs else (), fields.pairs, strict=True):
        modal[k] -= eta[l] * force
        if k != l:
            modal[l] -= eta[k] * force
    return ca.vertcat(whole, modal)


def _amplitudes(fields: Fields, eta: ca.SX, rate: ca.SX, acceleration: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """c (count,), dc/dt and d^2c/dt^2: eta, then -eta_k eta_l of the pairs, half of it where k = l."""
    c, dc, ddc = [eta], [rate], [acceleration]
    for k, l in fields.pairs:
        half = 0.5 if k == l else 1.0
        c.append(-half * eta[k] * eta[l])
        dc.append(-half * (rate[k] * eta[l] + eta[k] * rate[l]))
        second = acceleration[k] * eta[l] + 2 * rate[k] * rate[l] + eta[k] * acceleration[l]
        ddc.append(-half * second)
    return ca.vertcat(*c), ca.vertcat(*dc), ca.vertcat(*ddc)


def _second(data: ModalFields, fields: Fields, W: ca.SX, c: ca.SX) -> ca.SX:
    """int s s^T dm (3, 3) from W and int s s_0^T dm."""
    at_rest = _square(constant(columns(fields.moments)) @ c)  # int s_0 (s - s_0)^T dm
    return constant(data.second) + at_rest.T + _square(W @ c)


def _of_points(
    mass: float, S: ca.SX, dS: ca.SX, ddS: ca.SX, P: ca.SX, omega: ca.SX, origin: ca.SX, alpha: ca.SX
) -> ca.SX:
    """Force and torque (6,), without what points that move in the body's axes add to the torque: of S = int s dm, its
    rates and P = int s s^T dm.
    """
    tensor, turned = ca.trace(P) * ca.SX.eye(3) - P, cross(omega)
    force = mass * origin + cross(alpha) @ S + turned @ (turned @ S + 2 * dS) + ddS
    torque = cross(S) @ origin + tensor @ alpha + turned @ (tensor @ omega)
    return ca.densify(ca.vertcat(force, torque))


def _square(rows: ca.SX) -> ca.SX:
    """(3, 3) from its rows one after the other, (9,)."""
    return ca.reshape(rows, 3, 3).T


def _row(matrix: ca.SX) -> ca.SX:
    """The rows of (3, 3) one after the other, (9,)."""
    return ca.reshape(matrix.T, 9, 1)


def _axial(P: ca.SX) -> ca.SX:
    """int a x b dm (3,) from P = int a b^T dm."""
    return ca.vertcat(P[1, 2] - P[2, 1], P[2, 0] - P[0, 2], P[0, 1] - P[1, 0])
