"""A linear time-varying model brought to triangular form by QR along its motion, and windows of the diagonal.

Discrete QR: Phi_k Q_k = Q_k+1 R_k, R_k upper triangular with a positive diagonal. In z = Q(t) y the model is upper
triangular, dy/dt = B(t) y, and the integral of B_ii over a step is ln R_ii of it: no growth is ever multiplied up.
On a half-line the dichotomy spectrum of a bounded triangular model is that of its diagonal blocks, each by itself.

Source   Dieci and Van Vleck, "Lyapunov spectral intervals: theory and computation", SIAM J. Numer. Anal. 40 (2002);
         "Lyapunov and Sacker-Sell spectral intervals", J. Dyn. Differ. Equ. 19 (2007). Adrianova 1995 for separation
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.signals import OwnsArrays
from pliant.plants.stability.transition_growth import chain
from pliant.plants.transitions.state_matrix_path import Model, as_pieces, kept

EPS = float(np.finfo(float).eps)
SAMPLES = 24  # windows of a block


@dataclass(frozen=True, eq=False)
class TriangularFlow(OwnsArrays):
    """Rows belong to the times t (nt,) [s]; all in z = x / scale."""

    t: np.ndarray = field(repr=False)
    Q: np.ndarray = field(repr=False)  # (nt, n, n) orthogonal
    R: np.ndarray = field(repr=False)  # (nt-1, n, n) upper triangular, diagonal > 0: between the times
    logs: np.ndarray = field(repr=False)  # (nt, n) integral of B_ii since t[0]
    scale: np.ndarray = field(repr=False)  # (n,)

    @property
    def averages(self) -> np.ndarray:
        """Running averages (nt-1, n) [1/s] of B_ii since t[0]: finite-time Lyapunov exponents."""
        return (self.logs[1:] - self.logs[0]) / (self.t[1:] - self.t[0])[:, None]

    def steklov(self, window: float) -> np.ndarray:
        """Averages (nw, n) [1/s] of B_ii over windows [s] that begin at the nodes; ends lie on chords of the logs."""
        start = self.t[self.t <= self.t[-1] - window * (1 - 1e-12)]
        end = np.minimum(start + window, self.t[-1])
        later = np.column_stack([np.interp(end, self.t, column) for column in self.logs.T])
        return (later - self.logs[: len(start)]) / window

    def smooth(self, window: float) -> np.ndarray:
        """Averages (SAMPLES, n) [1/s] of B_ii over windows [s] that begin at even distances, weighed by sin^2, so that
        oscillations fall out much faster than of plain ones: of a sum of them with a mean each lies near that mean.
        """
        middle, steps = (self.t[1:] + self.t[:-1]) / 2, np.diff(self.logs, axis=0)
        begin = np.linspace(self.t[0], self.t[-1] - window, SAMPLES)
        past = (middle[None, :] - begin[:, None]) / window
        weights = np.where((past > 0) & (past < 1), np.square(np.sin(np.pi * past)), 0.0)
        return np.asarray(weights @ steps / (weights @ np.diff(self.t))[:, None])

    def block(self, first: int, last: int, window: float) -> tuple[float, float]:
        """Least and largest rate [1/s] of anything within the block first..last-1, over windows [s] of whole steps."""
        B = self.R[:, first:last, first:last]
        last_start = int(np.flatnonzero(self.t <= self.t[-1] - window * (1 - 1e-12))[-1])
        start = np.unique(
            np.searchsorted(self.t[: last_start + 1], np.linspace(self.t[0], self.t[last_start], SAMPLES))
        )
        low, high = np.inf, -np.inf
        for k in start:
            end = min(int(np.searchsorted(self.t, self.t[k] + window * (1 - 1e-9))), len(self.t) - 1)
            small, large = _rates(B[k:end])
            length = self.t[end] - self.t[k]
            low, high = min(low, small / length), max(high, large / length)
        return low, high


Steps = tuple[np.ndarray, np.ndarray, np.ndarray]  # times (nt,), transitions (nt-1, n, n), scale (n,)


def triangular_flow(model: Model, states: Sequence[str] | None = None, steps: Steps | None = None) -> TriangularFlow:
    """From the ordered Schur vectors of the mean of A onwards, so that a constant or triangular model is so at once.

    `steps`: those of `transition_growth.chain`, where they are at hand.
    """
    t, Phi, scale = chain(model, states) if steps is None else steps
    keep = kept(model, states)
    A = np.concatenate([piece.A[:, keep][:, :, keep] for piece in as_pieces(model).pieces])
    Q = ordered_schur(A.mean(axis=0) * scale / scale[:, None])
    n = len(Q)
    found, R = np.empty((len(t), n, n)), np.empty((len(t) - 1, n, n))
    found[0] = Q
    for k, step in enumerate(Phi):
        Q, U = np.linalg.qr(step @ Q)
        sign = np.where(np.diagonal(U) < 0, -1.0, 1.0)
        Q = Q * sign
        found[k + 1], R[k] = Q, U * sign[:, None]
    diagonal = np.maximum(np.diagonal(R, axis1=1, axis2=2), 1e-300)
    logs = np.concatenate([np.zeros((1, n)), np.cumsum(np.log(diagonal), axis=0)])
    return TriangularFlow(t, found, R, logs, scale)


def ordered_schur(A: np.ndarray) -> np.ndarray:
    """Schur vectors (n, n), real parts of their eigenvalues descending."""
    Q = np.eye(len(A))
    if not len(A) or ((np.tril(A, -1) == 0).all() and (np.diff(np.diagonal(A)) <= 0).all()):
        return Q
    values = np.sort(np.linalg.eigvals(A).real)[::-1]
    size = max(float(np.abs(values).max()), 1e-300)
    for edge in (values[1:] + values[:-1])[np.diff(values) < -1e-9 * size] / 2:  # one gap after another, fastest first
        done = _leading(A, Q, edge)
        T = Q[:, done:].T @ A @ Q[:, done:]
        _, Z, _ = sla.schur(T, output="real", sort=lambda re, im, edge=edge: re > edge)
        Q = np.concatenate([Q[:, :done], Q[:, done:] @ Z], axis=1)
    return Q


def _leading(A: np.ndarray, Q: np.ndarray, edge: float) -> int:
    """How many leading columns of Q span eigenvalues that stand above the next edge already."""
    T = Q.T @ A @ Q
    size = EPS * 1e4 * max(float(np.abs(A).max()), 1e-300)
    for k in range(len(A) - 1, 0, -1):
        if np.abs(T[k:, :k]).max() <= size and (np.linalg.eigvals(T[:k, :k]).real > edge).all():
            return k
    return 0


def _rates(B: np.ndarray) -> tuple[float, float]:
    """ln of the smallest and of the largest singular value of the product of B (m, k, k), upper triangular."""
    if B.shape[-1] == 1:
        both = float(np.log(np.maximum(B[:, 0, 0], 1e-300)).sum())
        return both, both
    inverse = np.linalg.inv(B)[::-1]
    return -_grown(inverse), _grown(B)


def _grown(B: np.ndarray) -> float:
    power = 0.0
    while len(B) > 1:
        last = B[len(B) - len(B) % 2 :]
        B = np.concatenate([B[1::2] @ B[: len(B) - len(B) % 2 : 2], last])
        size = np.maximum(np.abs(B).max(axis=(1, 2)), 1e-300)
        power += float(np.log(size).sum())
        B = B / size[:, None, None]
    return float(np.log(np.linalg.norm(B[0], 2))) + power
