"""The moments of a body given by its modes as it bends: functions of its coordinates.

Source   "Equations of Motion of Flexible Spacecraft", Eqs (2)-(13): the energy of (8) gives M_A(eta) below
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from pliant.plants.core.quaternions import cross

from .integrals import axial
from .modal_fields import ModalFields


def constant(value: Any) -> ca.SX:
    """A numeric array as an expression without its zeros."""
    return ca.SX(ca.sparsify(ca.DM(np.asarray(value, dtype=float))))


class Fields(NamedTuple):
    """The modes and, behind them, the shortening fields g_kl of the pairs k <= l that are not zero."""

    R: np.ndarray
    moments: np.ndarray
    overlaps: np.ndarray
    pairs: list[tuple[int, int]]

    @classmethod
    def of(cls, data: ModalFields, n: int, stiffened: bool) -> Fields:
        found = [
            (k, l) for k in range(n) for l in range(k, n) if stiffened and data.shortening_squares[k, l, k, l].any()
        ]
        k, l = [p[0] for p in found], [p[1] for p in found]
        mixed = data.shortening_overlaps[:n, k, l]
        squares = data.shortening_squares[k, l][:, k, l]
        overlaps = np.block(
            [[_flat(data.overlaps[:n, :n]), _flat(mixed)], [_flat(mixed.transpose(1, 0, 3, 2)), _flat(squares)]]
        )
        count = n + len(found)
        return cls(
            np.concatenate([data.R[:n], data.shortening[k, l]]),
            np.concatenate([data.moments[:n], data.shortening_moments[k, l]]),
            overlaps.reshape(count, 3, count, 3).transpose(0, 2, 1, 3),
            found,
        )


def columns(blocks: np.ndarray) -> np.ndarray:
    """(k, ..) as columns (size of one, k)."""
    return blocks.reshape(len(blocks), -1).T


def _flat(blocks: np.ndarray) -> np.ndarray:
    """(a, b, 3, 3) as a matrix (3 a, 3 b)."""
    a, b = blocks.shape[:2]
    return blocks.transpose(0, 2, 1, 3).reshape(3 * a, 3 * b)


@dataclass(frozen=True)
class Deformed:
    """The moments of a deformed body in its own axes."""

    mass: float
    S: ca.SX  # int s dm (3,)
    P: ca.SX  # int s s^T dm (3, 3)
    R: ca.SX  # int ds/deta dm (3, n)
    Y: ca.SX  # int s x ds/deta dm (3, n)
    m: ca.SX  # (n, n)

    @classmethod
    def of(cls, data: ModalFields, eta: ca.SX, stiffened: bool) -> Deformed:
        """At eta (n,). Shortening -(1/2) g_kl eta_k eta_l is a field like a mode's, its amplitude a function of eta,
        so that the energy is that of a motion of the points and M_A stays positive definite.
        """
        n = eta.shape[0]
        fields, amplitudes = Fields.of(data, n, stiffened), [eta[k] for k in range(n)]
        amplitudes += [-eta[k] * eta[l] / (2 if k == l else 1) for k, l in fields.pairs]
        S, P, Y = constant(data.first), constant(data.second), ca.SX(3, 0)
        if amplitudes:
            c, count = ca.vertcat(*amplitudes), len(amplitudes)
            a, b = np.triu_indices(count)
            squares = fields.overlaps[a, b] + np.where(a == b, 0.0, 1.0)[:, None, None] * fields.overlaps[b, a]
            linear = fields.moments + fields.moments.transpose(0, 2, 1)
            S = S + constant(fields.R.T) @ c
            P = P + ca.reshape(constant(columns(linear)) @ c, 3, 3)
            P = P + ca.reshape(constant(columns(squares)) @ (c[a.tolist()] * c[b.tolist()]), 3, 3)
            Y = constant(axial(fields.moments).T)
            Y = Y + ca.reshape(constant(columns(axial(fields.overlaps))) @ c, 3, count)
        R = constant(fields.R.T) if amplitudes else ca.SX(3, 0)
        m = constant(np.einsum("abii->ab", fields.overlaps)) if amplitudes else ca.SX(0, 0)
        if fields.pairs:
            bent = ca.SX(len(fields.pairs), n)
            for row, (k, l) in enumerate(fields.pairs):
                bent[row, k], bent[row, l] = -eta[l], -eta[k]
            slopes = ca.vertcat(ca.SX.eye(n), bent)
            R, Y, m = R @ slopes, Y @ slopes, slopes.T @ m @ slopes
        return cls(float(data.mass), S, P, R, Y, m)

    @property
    def tensor(self) -> ca.SX:
        """Inertia about the origin (3, 3)."""
        return ca.trace(self.P) * ca.SX.eye(3) - self.P

    @property
    def matrix(self) -> ca.SX:
        """M_A (6 + n, 6 + n) for (velocity of the origin, omega, deta/dt)."""
        S = cross(self.S)
        return ca.vertcat(
            ca.horzcat(self.mass * ca.SX.eye(3), -S, self.R),
            ca.horzcat(S, self.tensor, self.Y),
            ca.horzcat(self.R.T, self.Y.T, self.m),
        )
