"""What a model lacks, estimated as a constant disturbance, and the steady state that is best with it.

    x+ = A x + B u + B_d d,  d+ = d,  y = C x + C_d d

"states"   B_d = I, C_d = 0, all states read: d+ = d + (1 - e^(-dt/time)) (x - what was predicted)
"inputs"   B_d = B, C_d = 0, as many outputs read as there are inputs: steady Kalman filter
"outputs"  B_d = 0, C_d = I, any outputs read, but no mode of the plant stays: steady Kalman filter

As many disturbances as readings leave no steady error: "Disturbance Models for Offset-Free Model-Predictive
Control" (Pannocchia and Rawlings 2003); "Linear Offset-Free Model Predictive Control" (Maeder, Borrelli, Morari 2009).
"""

from __future__ import annotations

from typing import Any, final

import numpy as np
import scipy.linalg as sla

from pliant.controllers import riccati
from pliant.controllers.solvers.least_distance_qp import LeastDistance
from pliant.plants.core.errors import InfeasibleError
from pliant.plants.core.matrix_roots import semidefinite_root

KINDS = ("states", "inputs", "outputs")
INFLUENCE = 1e-9  # least singular value of the observability or target equations, against the largest
TRACKING = 1e6  # weight of a tracked signal's error against the cost of the steady state that the limits allow


@final
class Estimator:
    """Filter of s = [x; d], deviations from the model's point. `correct` takes a reading, `go_on` the input."""

    def __init__(
        self, kind: str, A: np.ndarray, B: np.ndarray, C: np.ndarray, dt: float, time: float, noise: float
    ) -> None:
        """C (ny, nx) of the readings. time [s]: how fast "states" adapts; else the time over which d drifts by one unit
        (standard deviation), where the inputs have a noise of one unit at each step and the readings of `noise`.
        """
        self._made = kind, A, B, C, dt, time, noise
        nx, nu = B.shape
        ny = len(C)
        self.kind, self.known = kind, False
        Bd = {"states": np.eye(nx), "inputs": B, "outputs": np.zeros((nx, ny))}[kind]
        Cd = np.eye(ny) if kind == "outputs" else np.zeros((ny, Bd.shape[1]))
        nd = Bd.shape[1]
        self.seen = Cd
        self.Bd = Bd
        F = np.block([[A, Bd], [np.zeros((nd, nx)), np.eye(nd)]])
        H = np.hstack([C, Cd])
        if kind == "states":
            gain = np.vstack([np.eye(nx), (1 - np.exp(-dt / time)) * np.eye(nx)])
        else:
            self._require_seen(kind, A, Bd, C, Cd)
            W = sla.block_diag(B @ B.T, dt / time * np.eye(nd))
            V = noise**2 * np.eye(ny)
            P = riccati.dlqr(F.T, H.T, W + 1e-12 * np.trace(W) * np.eye(nx + nd), V).P
            gain = np.linalg.solve(H @ P @ H.T + V, H @ P).T
        self._first = np.linalg.pinv(C)
        self.s, self._gain, self._H, self._F = np.zeros(nx + nd), gain, H, F
        self._G = np.vstack([B, np.zeros((nd, nu))])
        self._e, self._step = np.empty(ny), np.empty(nx + nd)
        self._next, self._push = np.empty(nx + nd), np.empty(nx + nd)
        self.x, self.d = self.s[:nx], self.s[nx:]

    def __reduce__(self) -> tuple[Any, ...]:
        return Estimator, self._made

    @staticmethod
    def _require_seen(kind: str, A: np.ndarray, Bd: np.ndarray, C: np.ndarray, Cd: np.ndarray) -> None:
        if kind == "inputs" and len(C) != Bd.shape[1]:
            raise ValueError(
                f"MPC.reads: {len(C)} signals, must be {Bd.shape[1]}, one for each input, to estimate disturbances of "
                "the inputs"
            )
        E = np.block([[A - np.eye(len(A)), Bd], [C, Cd]])
        sigma = np.linalg.svd(E, compute_uv=False)
        if len(sigma) < E.shape[1] or sigma[-1] <= INFLUENCE * sigma[0]:
            raise ValueError(
                f"MPC.disturbance = {kind!r}: the readings do not tell such a disturbance from a state; read other "
                "signals, or estimate another kind"
            )

    def reset(self) -> None:
        """Know nothing: at the model's point, no disturbance."""
        self.s[:] = 0.0
        self.known = False

    def correct(self, dy: np.ndarray) -> None:
        """Take the reading dy (ny,). The first one gives the smallest state that explains it, and no disturbance."""
        if not self.known:
            self.x[:] = self._first @ dy
            self.known = True
            return
        np.dot(self._H, self.s, out=self._e)
        np.subtract(dy, self._e, out=self._e)
        np.dot(self._gain, self._e, out=self._step)
        self.s += self._step

    def go_on(self, du: np.ndarray) -> None:
        """Predict the next state under the input du (nu,)."""
        np.dot(self._F, self.s, out=self._next)
        np.dot(self._G, du, out=self._push)
        np.add(self._next, self._push, out=self.s)


@final
class Target:
    """Steady (x, u), deviations from the model's point, with tracked signals H x + D u + Hd d at r, at least cost.

    Where the limits of the inputs do not allow that, as near as they do.
    """

    def __init__(
        self,
        A: np.ndarray,
        B: np.ndarray,
        Bd: np.ndarray,
        tracked: tuple[np.ndarray, np.ndarray, np.ndarray],
        weight: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
    ) -> None:
        """weight (nx + nu, nx + nu) of [x; u]; low, high (nu,) of du; tracked = (H, D, Hd)."""
        nx, nu = B.shape
        H, D, Hd = tracked
        rest, wanted = np.hstack([A - np.eye(nx), B]), np.hstack([H, D])
        E = np.vstack([rest, wanted])
        sigma = np.linalg.svd(E, compute_uv=False)
        if len(E) > nx + nu or sigma[-1] <= INFLUENCE * sigma[0]:
            raise InfeasibleError(
                f"no steady inputs bring {len(H)} tracked signals to any values: track at most as many signals as "
                "there are inputs, and only such as can be held"
            )
        # minimise s'Ws over E s = e: s = (s of least norm) + Z y
        Z = sla.null_space(E)
        base = np.linalg.pinv(E)
        if Z.shape[1]:
            base = base - Z @ np.linalg.solve(Z.T @ weight @ Z, Z.T @ weight @ base)
        onto = np.block([[-Bd, np.zeros((nx, len(H)))], [-Hd, np.eye(len(H))]])
        self._map = np.ascontiguousarray(base @ onto)  # of [d; r]
        self._low, self._high, self._nx = low, high, nx
        # within limits: s = pinv(rest) (-Bd d) + Z y, least |L s|^2 + TRACKING |wanted s + Hd d - r|^2
        Z = sla.null_space(rest)
        scale = max(float(np.abs(weight).max()), 1e-12)
        L = np.vstack([semidefinite_root(weight).T, np.sqrt(TRACKING * scale) * wanted])
        Y, T = np.linalg.qr(L @ Z)
        start = np.hstack([-np.linalg.pinv(rest) @ Bd, np.zeros((nx + nu, len(H)))])
        missed = np.hstack([Hd, -np.eye(len(H))])
        error = L @ start + np.vstack([np.zeros((nx + nu, missed.shape[1])), np.sqrt(TRACKING * scale) * missed])
        self._reach = Z @ np.linalg.inv(T)
        self._start = start - self._reach @ Y.T @ error
        self._solver = LeastDistance(self._reach[nx:], np.zeros(nu, dtype=bool), 0.0)
        self._known, self._s = np.empty(onto.shape[1]), np.empty(nx + nu)
        self.limited = False

    def __call__(self, d: np.ndarray, r: np.ndarray) -> np.ndarray:
        """[x; u] (nx + nu,), overwritten by the next call."""
        self._known[: len(d)], self._known[len(d) :] = d, r
        s = np.dot(self._map, self._known, out=self._s)
        u = s[self._nx :]
        self.limited = bool((u < self._low).any() or (u > self._high).any())
        if self.limited:
            start = self._start @ self._known
            free = start[self._nx :]
            z = self._solver.solve(np.maximum(self._low - free, -1e30), np.minimum(self._high - free, 1e30))
            if z is not None:  # else the least-cost target stays, and the inputs saturate
                s[:] = start + self._reach @ z
        return s
