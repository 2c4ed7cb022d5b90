"""Small deviations of states that hold unit quaternions: three turns in the place of each.

    dx = T xi,  xi = L dx  to first order,  L T = 1

A turn is the small rotation from the nominal attitude, in the axes that turn with it, so that no root belongs to a
quaternion's norm; its rate is the turn's own, dq/dt = d omega - omega x q. About a nominal x(t) then

    A_xi = L (A T - dT/dt),  B_xi = L B,  C_xi = C T.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pliant.plants.core.quaternions import rates, skew

Array = np.ndarray
ROUNDING = 256 * float(np.finfo(float).eps)  # of sums of four products of three factors, relative


@dataclass(frozen=True)
class Attitude:
    """A unit quaternion among the states, scalar first, and its angular velocity in the axes that turn with it."""

    name: str  # "": of the plant itself
    q: int  # where it begins in x
    omega: int

    @property
    def quaternion(self) -> slice:
        return slice(self.q, self.q + 4)

    @property
    def rate(self) -> slice:
        return slice(self.omega, self.omega + 3)

    @property
    def of(self) -> str:
        """Whose it is, in words that follow "the quaternion" or "the attitude"."""
        return f" of {self.name!r}" if self.name else ""


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

    @cached_property
    def kept(self) -> Array:
        """States other than quaternions."""
        return np.array([k for k in range(self.nx) if not any(a.q <= k < a.q + 4 for a in self.attitudes)], dtype=int)

    @cached_property
    def own(self) -> Array:
        """Where these stand in xi."""
        return np.array([self.at(k) for k in self.kept], dtype=int)

    def turn(self, a: Attitude) -> slice:
        """An attitude's turns in xi."""
        return slice(self.at(a.q), self.at(a.q) + 3)

    def spin(self, a: Attitude) -> slice:
        """The rates of its turns in xi."""
        return slice(self.at(a.omega), self.at(a.omega) + 3)

    def columns(self, x: Array, M: Array) -> Array:
        """M T (..., m, n) at states x (..., nx), of M (..., m, nx)."""
        found = np.empty((*M.shape[:-1], self.n))
        found[..., self.own] = M[..., self.kept]
        for a in self.attitudes:
            turned = M[..., a.quaternion] @ (rates(x[..., a.quaternion]) / 2)
            found[..., self.turn(a)] = turned + M[..., a.rate] @ skew(x[..., a.rate])
        return found

    def rows(self, x: Array, M: Array) -> Array:
        """L M (..., n, m), of M (..., nx, m)."""
        found = np.empty((*M.shape[:-2], self.n, M.shape[-1]))
        found[..., self.own, :] = M[..., self.kept, :]
        for a in self.attitudes:
            q = x[..., a.quaternion]
            back = 2 * np.swapaxes(rates(q), -1, -2) / (q**2).sum(-1)[..., None, None]
            turned = back @ M[..., a.quaternion, :]
            found[..., self.turn(a), :] = turned
            found[..., self.spin(a), :] -= skew(x[..., a.rate]) @ turned
        return found

    def forward(self, x: Array) -> Array:
        """T (..., nx, n) at states x (..., nx)."""
        return self.columns(x, np.broadcast_to(np.eye(self.nx), (*x.shape[:-1], self.nx, self.nx)))

    def back(self, x: Array) -> Array:
        """L (..., n, nx)."""
        return self.rows(x, np.broadcast_to(np.eye(self.nx), (*x.shape[:-1], self.nx, self.nx)))

    def model(self, x: Array, dx: Array, jacobians: Sequence[Array]) -> list[Array]:
        """[A, B, E, C, D, F] of the deviations from a nominal x (..., nx) that moves at dx (..., nx)."""
        A, B, E, C, D, F = jacobians
        moved = self.columns(x, A)
        for a in self.attitudes:  # less dT/dt
            moved[..., a.quaternion, self.turn(a)] -= rates(dx[..., a.quaternion]) / 2
            moved[..., a.rate, self.turn(a)] -= skew(dx[..., a.rate])
        found = self.rows(x, moved)
        for a in self.attitudes:
            self._rid(a, x, A, found)
        return [found, self.rows(x, B), self.rows(x, E), self.columns(x, C), D, F]

    def _rid(self, a: Attitude, x: Array, A: Array, found: Array) -> None:
        """The rows of dq/dt, which is a deviation itself, without the rounding of the maps: three zero eigenvalues of
        what is at rest would be told as a growth of 1e-18 1/s.

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
        found[..., self.own] = x[..., self.kept]
        return found
