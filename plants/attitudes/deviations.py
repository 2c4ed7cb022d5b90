"""Small deviations of states that hold unit quaternions: three turns in the place of each.

    dx = T xi,  xi = L dx  to first order,  L T = 1

A turn is the small rotation from the nominal attitude, in the axes that turn with it, so that no root belongs to a
quaternion's norm; its rate is the turn's own, dq/dt = d omega - omega x q. About a nominal x(t) then

    A_xi = L (A T - dT/dt),  B_xi = L B,  C_xi = C T.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pliant.plants.core.quaternions import rates, skew

Array = np.ndarray
ROUNDING = 256 * float(np.finfo(float).eps)  # of sums of four products of three factors, relative


@dataclass(frozen=True)
class Attitude:
    """A unit quaternion among the states, scalar first, and its angular velocity in the axes that turn with it."""

    name: str
    q: int  # where it begins in x
    omega: int

    @property
    def quaternion(self) -> slice:
        return slice(self.q, self.q + 4)

    @property
    def rate(self) -> slice:
        return slice(self.omega, self.omega + 3)


@dataclass(frozen=True)
class Deviations:
    """Where deviations stand, for plants with these attitudes, in the order of the states."""

    attitudes: tuple[Attitude, ...]
    nx: int

    def at(self, k: int) -> int:
        """Where state k, no part of a quaternion, stands in xi; of a quaternion's first the first turn."""
        return k - sum(k >= a.q + 4 for a in self.attitudes)

    @property
    def n(self) -> int:
        return self.nx - len(self.attitudes)

    @property
    def kept(self) -> list[int]:
        """States other than quaternions."""
        return [k for k in range(self.nx) if not any(a.q <= k < a.q + 4 for a in self.attitudes)]

    def turn(self, a: Attitude) -> slice:
        """An attitude's turns in xi."""
        return slice(self.at(a.q), self.at(a.q) + 3)

    def spin(self, a: Attitude) -> slice:
        """The rates of its turns in xi."""
        return slice(self.at(a.omega), self.at(a.omega) + 3)

    def _ones(self, shape: tuple[int, ...]) -> Array:
        T = np.zeros((*shape, self.nx, self.n))
        for k in self.kept:
            T[..., k, self.at(k)] = 1.0
        return T

    def forward(self, x: Array) -> Array:
        """T (..., nx, n) at states x (..., nx)."""
        T = self._ones(x.shape[:-1])
        for a in self.attitudes:
            T[..., a.quaternion, self.turn(a)] = rates(x[..., a.quaternion]) / 2
            T[..., a.rate, self.turn(a)] = skew(x[..., a.rate])
        return T

    def back(self, x: Array) -> Array:
        """L (..., n, nx)."""
        L = np.swapaxes(self._ones(x.shape[:-1]), -1, -2).copy()
        for a in self.attitudes:
            q = x[..., a.quaternion]
            own = 2 * np.swapaxes(rates(q), -1, -2) / (q**2).sum(-1)[..., None, None]
            L[..., self.turn(a), a.quaternion] = own
            L[..., self.spin(a), a.quaternion] = -skew(x[..., a.rate]) @ own
        return L

    def turning(self, dx: Array) -> Array:
        """dT/dt where x moves at dx (..., nx)."""
        T = np.zeros((*dx.shape[:-1], self.nx, self.n))
        for a in self.attitudes:
            T[..., a.quaternion, self.turn(a)] = rates(dx[..., a.quaternion]) / 2
            T[..., a.rate, self.turn(a)] = skew(dx[..., a.rate])
        return T

    def model(self, x: Array, dx: Array, jacobians: Sequence[Array]) -> list[Array]:
        """[A, B, E, C, D, F] of the deviations from a nominal x (..., nx) that moves at dx (..., nx)."""
        A, B, E, C, D, F = jacobians
        T, L = self.forward(x), self.back(x)
        found = L @ (A @ T - self.turning(dx))
        for a in self.attitudes:
            self._rid(a, x, A, found)
        return [found, L @ B, L @ E, C @ T, D, F]

    def _rid(self, a: Attitude, x: Array, A: Array, found: Array) -> None:
        """The rows of dq/dt, which is a deviation itself, without the rounding of the maps: it would be told as growth.

        A nominal whose attitude does not move as its angular velocity says keeps what it has.
        """
        q, rate = self.turn(a), self.spin(a)
        size = np.abs(A[..., a.quaternion, a.quaternion]).max((-2, -1)) + np.abs(x[..., a.rate]).max(-1)  # [1/s]
        off = found[..., q, :].copy()
        off[..., rate] -= np.eye(3)
        off[..., q] /= np.where(size > 0, size, 1.0)[..., None, None]
        exact = np.zeros_like(off)
        exact[..., rate] = np.eye(3)
        rounding = np.abs(off).max((-2, -1)) <= ROUNDING
        found[..., q, :] = np.where(rounding[..., None, None], exact, found[..., q, :])

    def cut(self, x: Array) -> Array:
        """x (..., nx) in the places of the deviations, turns as zero: they are measured from the nominal."""
        found = np.zeros((*x.shape[:-1], self.n))
        found[..., [self.at(k) for k in self.kept]] = x[..., self.kept]
        return found
