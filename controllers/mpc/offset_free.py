"""What a model lacks, estimated as a constant disturbance.

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

KINDS = ("states", "inputs", "outputs")
INFLUENCE = 1e-9  # least singular value of the observability equations, against the largest


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
