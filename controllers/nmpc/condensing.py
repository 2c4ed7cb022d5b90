"""Condensing: the stages of a linearised horizon become one quadratic program in the inputs.

dx_{k+1} = A_k dx_k + c_k + B_k du_k, dx_0 = e           ->  [dx_k; 1] = G_k v,  v = [e; 1; du_0 .. du_{N-1}]
cost sum |X_k dx_k + r_k + U_k du_k|^2 + |L dx_N + l|^2  ->  |W v|^2 = v'S v,  S = W'W
bounded signals V_k dx_k + z_k + Y_k du_k                ->  Z v

With the 1 as one more state, c_k, r_k and z_k are one more column of A_k, X_k and V_k. G_k is zero right of du_{k-1}:
only what is not is computed. All but e is known before a measurement, and then F e + f0 is what is left to do. Source:
Bock and Plitt, "A multiple shooting algorithm for direct solution of optimal control problems", 1984, Section 4.
"""

from __future__ import annotations

from typing import final

import numpy as np
from numpy.lib.stride_tricks import as_strided

Array = np.ndarray
LONG = 150  # inputs of a horizon beyond which work that grows as N, or as N^2 where a limit binds, is less than as N^3


@final
class Condensed:
    """Work arrays of a horizon of N steps, nx states, nu inputs, nr residuals a step, nb bounded signals a node.

    The caller fills the stages `dynamics` (N, nx, nx+1+nu) = [A, c, B], `residual` (N, nr, nx+1+nu) = [X, r, U] and
    `bounded` (N, nb, nx+1+nu) = [V, z, Y], whose first is not used, for what happens at x_0 is past, and `finish` with
    x_N - goal. Then `form` fills H, F, f0: the cost is d'H d + 2 (F e + f0)'d + constant for d = (du_0 .. du_{N-1})
    (N nu,), and Zd, Ze, z0: the bounded signals of nodes 1 .. N-1 are Zd d + Ze e + z0 ((N-1) nb,), node by node.
    """

    def __init__(self, N: int, nx: int, nu: int, nr: int, nb: int, L: Array) -> None:
        """L (nl, nx): |L (x_N - goal)|^2 is the terminal cost; no rows for none."""
        self.N, self.nx, self.nu, self.L = N, nx, nu, L
        self.head, self.long = nx + 1, N * nu > LONG
        head = self.head
        width, rows = head + N * nu, (N - 1) * nb
        self.dynamics, self.residual, self.bounded = (np.zeros((N, n, head + nu)) for n in (nx, nr, nb))
        self.G = np.zeros((N + 1, head, width))
        self.G[0, :nx, :nx] = np.eye(nx)
        self.G[:, nx, nx] = 1.0
        self.end = np.hstack([L, np.zeros((len(L), 1))])  # [L l]
        self._W = np.zeros((N * nr + len(L), width))
        stages = self._W[: N * nr].reshape(N, nr, width)
        self._Z = np.zeros((N - 1, nb, width))
        self.S, self.H = np.zeros((width, width)), np.zeros((N * nu, N * nu))
        self.F, self.f0 = self.S[head:, :nx], self.S[head:, nx]
        flat = self._Z.reshape(rows, width)
        self.Ze, self.z0, self.Zd = flat[:, :nx], flat[:, nx], np.zeros((rows, N * nu))
        self._stages, self._last = stages, self._W[N * nr :]
        self._B = _diagonal(self.G[1:, :nx, head:], N, nu)
        self._U = _diagonal(stages[:, :, head:], N, nu)
        self._Y = _diagonal(self._Z[:, :, head + nu :], N - 1, nu)
        self._steps = [
            (self.dynamics[k, :, :head], self.G[k, :, : head + k * nu], self.G[k + 1, :nx, : head + k * nu])
            for k in range(N)
        ]
        self._v = np.zeros(width)

    def finish(self, end: Array) -> None:
        """end (nx,) = x_N - goal."""
        np.matmul(self.L, end, out=self.end[:, -1])

    def form(self) -> None:
        """From the stages as they are."""
        head = self.head
        self._B[:] = self.dynamics[:, :, head:]
        for now, G, ahead in self._steps:
            np.matmul(now, G, out=ahead)
        if self.long:
            self._backward()
        else:
            np.matmul(self.residual[:, :, :head], self.G[:-1], out=self._stages)
            self._U[:] = self.residual[:, :, head:]
            np.matmul(self.end, self.G[-1], out=self._last)
            np.matmul(self._W.T, self._W, out=self.S)
        self.H[:] = self.S[head:, head:]
        if self.Zd.size:
            np.matmul(self.bounded[1:, :, :head], self.G[1:-1], out=self._Z)
            self._Y += self.bounded[1:, :, head:]
            self.Zd[:] = self._Z.reshape(len(self.Zd), -1)[:, head:]

    def _backward(self) -> None:
        """S by half the cost's slopes by [dx_k; 1], Lambda_k v, from the end backwards: the work grows as N^2, not N^3.

        Lambda_k = Q_k G_k + A_k' Lambda_{k+1} left of du_k; row k of S is N_k G_k + B_k' Lambda_{k+1}, with
        [Q N'; N R] = [X r U]'[X r U]. S is symmetric, so that only what is left of its diagonal is computed.
        """
        head, nx, nu = self.head, self.nx, self.nu
        whole = np.matmul(self.residual.transpose(0, 2, 1), self.residual)
        slope = self.end.T @ (self.end @ self.G[-1])
        self.S[:] = 0.0
        for k in range(self.N - 1, -1, -1):
            width = head + k * nu
            row = self.dynamics[k].T @ slope[:nx, : width + nu]
            row[nx] += slope[nx, : width + nu]  # the 1 stays
            row[:, :width] += whole[k][:, :head] @ self.G[k, :, :width]
            row[head:, width:] += whole[k][head:, head:]
            self.S[width : width + nu, : width + nu] = row[head:]
            slope = row[:head]
        self.S[:head, :head] = slope[:, :head]
        left = np.tril(self.S)
        np.add(left, np.tril(left, -1).T, out=self.S)

    def signals(self, dx: Array, d: Array) -> Array:
        """The bounded signals ((N-1) nb,) as Zd d + Ze e + z0, stage by stage from the states dx (N+1, nx)."""
        v = np.ones((self.N - 1, self.head + self.nu))
        v[:, : self.nx], v[:, self.head :] = dx[1:-1], d.reshape(self.N, -1)[1:]
        return (self.bounded[1:] @ v[:, :, None]).ravel()

    def unchanged(self) -> float:
        """The cost of dx_0 = 0 and d = 0: of the plan, its gaps closed."""
        dx = self.states(np.zeros(self.nx), np.zeros(self.N * self.nu))
        r = (self.residual[:, :, : self.nx] @ dx[:-1, :, None])[:, :, 0] + self.residual[:, :, self.nx]
        end = self.L @ dx[-1] + self.end[:, -1]
        return float(np.vdot(r, r) + end @ end)

    def states(self, e: Array, d: Array) -> Array:
        """dx (N+1, nx) of an initial deviation e (nx,) and changes d (N nu,) of the inputs."""
        if self.long:
            dx, nx, head = np.empty((self.N + 1, self.nx)), self.nx, self.head
            dx[0] = e
            known = (self.dynamics[:, :, head:] @ d.reshape(self.N, -1, 1))[:, :, 0] + self.dynamics[:, :, nx]
            for k, A in enumerate(self.dynamics[:, :, :nx]):
                np.add(A.dot(dx[k]), known[k], out=dx[k + 1])
            return dx
        self._v[: self.nx], self._v[self.nx], self._v[self.head :] = e, 1.0, d
        return (self.G @ self._v)[:, : self.nx]


def _diagonal(blocks: Array, n: int, width: int) -> Array:
    """View (n, rows, width) of blocks[k][:, k width : (k+1) width]."""
    a, b, c = blocks.strides
    return as_strided(blocks, (n, blocks.shape[1], width), (a + width * c, b, c))
