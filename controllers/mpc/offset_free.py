"""What a model lacks, estimated as a constant disturbance.

    x+ = A x + B u + B_d d,  d+ = d,  y = C x + C_d d

"states"   B_d = I, C_d = 0, all states read: d+ = d + (1 - e^(-dt/time)) (x - what was predicted)
"inputs"   B_d = B, C_d = 0, as many outputs read as there are inputs: steady Kalman filter
"outputs"  B_d = 0, C_d = I, any outputs read, but no mode of the plant stays: steady Kalman filter

As many disturbances as readings leave no steady error: "Disturbance Models for Offset-Free Model-Predictive
Control" (Pannocchia and Rawlings 2003); "Linear Offset-Free Model Predictive Control" (Maeder, Borrelli, Morari 2009).

Every signal may have a unit of its own: states that nothing drives are given a share of what drives the others, the
first state is the likeliest before all readings, and what can be told apart is told in even units.
"""

from __future__ import annotations

from typing import Any, NamedTuple, final

import numpy as np
import scipy.linalg as sla

from pliant.controllers import riccati
from pliant.plants.core.signals import owned, sealed

from .steady_target import equilibrium_scales

KINDS = ("states", "inputs", "outputs")
INFLUENCE = 1e-9  # least singular value of the equilibrated observability equations, against the largest
UNKNOWN = 1e-12  # variance that every state gains in a step besides, of what the noise moves it by in nx of them


class Sizes(NamedTuple):
    """Standard deviations, each in its signal's unit: what MPC's `noise` says by name, else 1 of an input, 0.01 of a
    reading. By name a reading's own disturbance drifts by 100 of its deviations."""

    inputs: np.ndarray  # (nu,) of the noise on the inputs at each step, and of a drift of theirs over `time`
    readings: np.ndarray  # (ny,) of the noise on the readings
    drift: np.ndarray  # (ny,) of the drift of a reading's own disturbance over `time`


@final
class Estimator:
    """Filter of s = [x; d], deviations from the model's point. `correct` takes a reading, `go_on` the input."""

    def __init__(
        self, kind: str, A: np.ndarray, B: np.ndarray, C: np.ndarray, dt: float, time: float, sizes: Sizes
    ) -> None:
        """C (ny, nx) of the readings. time [s]: how fast "states" adapts; else the time over which d drifts by its
        deviation of `sizes`, as those of the inputs' noise at each step and of the readings."""
        self._made = kind, A, B, C, dt, time, sizes
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
            gain, first = np.vstack([np.eye(nx), (1 - np.exp(-dt / time)) * np.eye(nx)]), np.eye(nx)
        else:
            self._require_seen(kind, A, Bd, C, Cd)
            pushed = B * sizes.inputs
            drift = sizes.inputs if kind == "inputs" else sizes.drift
            W = sla.block_diag(pushed @ pushed.T, dt / time * np.diag(drift**2))
            W += UNKNOWN * np.diag(_moved(F, W, H / sizes.readings[:, None]))
            P = riccati.dlqr(F.T, H.T, W, np.diag(sizes.readings**2)).P
            gain = _gain(P, H, sizes.readings)
            first = _gain(P[:nx, :nx], C, np.zeros(ny))
        self._first = first
        self.s, self._gain, self._H, self._F = np.zeros(nx + nd), gain, H, F
        self._G = np.vstack([B, np.zeros((nd, nu))])
        self._e, self._step = np.empty(ny), np.empty(nx + nd)
        self._next, self._push = np.empty(nx + nd), np.empty(nx + nd)
        self.x, self.d = self.s[:nx], self.s[nx:]

    def __reduce__(self) -> tuple[Any, ...]:
        return _made_again, sealed(self._made)

    @staticmethod
    def _require_seen(kind: str, A: np.ndarray, Bd: np.ndarray, C: np.ndarray, Cd: np.ndarray) -> None:
        if kind == "inputs" and len(C) != Bd.shape[1]:
            raise ValueError(
                f"MPC.reads: {len(C)} signals, must be {Bd.shape[1]}, one for each input, to estimate disturbances of "
                "the inputs"
            )
        E = np.block([[A - np.eye(len(A)), Bd], [C, Cd]])
        rows, columns = equilibrium_scales(E)
        sigma = np.linalg.svd(E / rows[:, None] / columns, compute_uv=False)
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
        """Take the reading dy (ny,). The first one gives the likeliest state that explains it, and no disturbance."""
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


def _moved(F: np.ndarray, W: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Variances (n,) that noise of covariance W gives in n steps of F; of what it does not reach, that which a reading
    `seen` (ny, n) of deviation one tells."""
    found, step = W, W
    for _ in range(len(F)):
        step = F @ step @ F.T
        found = found + step
    moved, told = np.diag(found), np.square(seen).sum(axis=0)
    return np.where(moved > 0, moved, 1 / np.where(told > 0, told, 1.0))


def _gain(P: np.ndarray, C: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """P C'(C P C' + noise^2)^-1 (nx, ny), each reading in a unit of its own; the smallest where that is singular."""
    S = C @ P @ C.T + np.diag(noise**2)
    unit = np.sqrt(np.diag(S))
    unit = np.where(unit > 0, unit, 1.0)
    even = C @ P / unit[:, None]
    return np.asarray((np.linalg.pinv(S / unit[:, None] / unit, hermitian=True) @ even).T / unit)


def _made_again(*given: Any) -> Estimator:
    return Estimator(*owned(given))
