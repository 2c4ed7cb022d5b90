"""A linearised horizon where no limit and no bound binds, solved stage by stage from its end: the work grows as N.

min sum |X_k dx_k + r_k + U_k du_k|^2 + |L dx_N + l|^2,  dx_{k+1} = A_k dx_k + c_k + B_k du_k
v_k = [dx_k; 1], v_{k+1} = F_k v_k + G_k du_k: the cost to go is |R_k v_k|^2, with an orthogonal Q
Q [Ruu Ruv; 0 R_k] = [U_k  [X_k r_k];  R_{k+1} G_k  R_{k+1} F_k],   du_k = -Ruu^-1 Ruv v_k

Each R_k comes from an orthogonal factorisation, so that a cost to go never loses its sign to rounding. Source: Morf and
Kailath, "Square-root algorithms for least-squares estimation", 1975, for the dual problem.
"""

from __future__ import annotations

from typing import final

import numpy as np
from scipy.linalg.lapack import dgeqrf, dtrtrs

from .condensing import Condensed

Array = np.ndarray


@final
class StageRecursion:
    """Reads the stages that `horizon` holds. `factor` does what does not wait for a measurement."""

    def __init__(self, horizon: Condensed) -> None:
        self.horizon = horizon
        N, head, nu, nr = horizon.N, horizon.head, horizon.nu, horizon.residual.shape[1]
        self.K, self._loops = np.zeros((N, nu, head)), np.zeros((N, head - 1, head))
        self._paid, self._moved = np.zeros((N, nr, nu + head)), np.zeros((N, head, nu + head))
        self._moved[:, -1, -1] = 1.0
        self._stack = np.zeros((nr + head, nu + head), order="F")
        self._upper, self._v = np.triu(np.ones((head, head))), np.ones((N + 1, head))

    def factor(self) -> bool:
        """False where the stages' numbers are no finite problem."""
        own, stack = self.horizon, self._stack
        head, nx, nu, nr = own.head, own.nx, own.nu, own.residual.shape[1]
        self._paid[:, :, :nu], self._paid[:, :, nu:] = own.residual[:, :, head:], own.residual[:, :, :head]
        self._moved[:, :nx, :nu], self._moved[:, :nx, nu:] = own.dynamics[:, :, head:], own.dynamics[:, :, :head]
        R = np.zeros((head, head))
        if len(own.end):
            left = dgeqrf(own.end)[0][:head]
            R[: len(left)] = self._upper[: len(left)] * left
        for k in range(own.N - 1, -1, -1):
            stack[:nr] = self._paid[k]
            np.matmul(R, self._moved[k], out=stack[nr:])
            stack = dgeqrf(stack, overwrite_a=1)[0]
            self.K[k], singular = dtrtrs(stack[:nu, :nu], stack[:nu, nu:])
            if singular:
                return False
            R = stack[nu : nu + head, nu:] * self._upper
        np.subtract(own.dynamics[:, :, :head], own.dynamics[:, :, head:] @ self.K, out=self._loops)
        return bool(np.isfinite(R).all() and np.isfinite(self._loops.sum()))

    def solve(self, e: Array) -> tuple[Array, Array]:
        """(dx (N+1, nx), d (N nu,)) of least cost from dx_0 = e (nx,)."""
        v, nx = self._v, self.horizon.nx
        v[0, :nx] = e
        for k, loop in enumerate(self._loops):
            np.matmul(loop, v[k], out=v[k + 1, :nx])
        return v[:, :nx], -(self.K @ v[:-1, :, None]).ravel()
