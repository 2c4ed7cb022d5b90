"""The quadratic cost of a linear prediction as a distance: J(xi_0, z) = V(xi_0) + |z|^2.

    xi_{j+1} = A_j xi_j + B_j mu_j + c_j,   J = sum_j xi'Q xi + mu'R mu + 2 xi'N mu + xi_n' P xi_n

With V_j(xi) = xi'P_j xi + 2 p_j'xi + const of the Riccati recursion and its law mu = -K_j xi - k_j, completing the
square gives J = V_0 + sum_j v_j' S_j v_j for mu_j = -K_j xi_j - k_j + v_j, S_j = R + B'P_{j+1}B (Bertsekas, Dynamic
Programming and Optimal Control, Section 3.1). So the Hessian in the pre-stabilised inputs v is block diagonal, and the
identity in z_j = S_j^(1/2) v_j; z = 0 is the unconstrained optimum, whatever the horizon.

Inputs that act late are states while on their way. With one delay the model is exact and the law its LQR. Within a
range the prediction is that of the middle; the law is the one for all of it (`riccati.late_inputs`), from which the
plan departs as little as the limits ask: min sum of v_j' S v_j, as in predictive control about a stabilised loop
("Efficient robust predictive control", Kouvaritakis, Rossiter and Schuurmans 2000).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg as sla

from pliant.controllers import riccati
from pliant.controllers.riccati.late_inputs import delay_range, late_lqr, past_of
from pliant.plants.core.argument_gates import require_finite
from pliant.plants.linear.lti import LinearModel


class Laws(NamedTuple):
    """mu_j = -K_j xi_j - k_j + root_j^-1 z_j, and the cost to go xi'P_j xi + 2 p_j'xi + const."""

    K: np.ndarray  # (n, nu, nx)
    k: np.ndarray  # (n, nu)
    root: np.ndarray  # (n, nu, nu) upper triangular, root'root = S_j
    P: np.ndarray  # (n + 1, nx, nx)
    p: np.ndarray  # (n + 1, nx)


class Prediction(NamedTuple):
    """xi_j = X_j [xi_0; z; 1] and mu_j = U_j [xi_0; z; 1]."""

    X: np.ndarray  # (n + 1, nx, nx + nz + 1)
    U: np.ndarray  # (n, nu, nx + nz + 1)


def laws(
    A: np.ndarray, B: np.ndarray, c: np.ndarray, Q: np.ndarray, R: np.ndarray, N: np.ndarray, P: np.ndarray
) -> Laws:
    """Backward from the terminal weight P (nx, nx). A (n, nx, nx), B (n, nx, nu), c (n, nx), Q, R, N (n, ., .)."""
    n, nx, nu = B.shape
    K, k, root = np.empty((n, nu, nx)), np.empty((n, nu)), np.empty((n, nu, nu))
    Ps, ps = np.empty((n + 1, nx, nx)), np.zeros((n + 1, nx))
    Ps[n] = P
    for j in range(n - 1, -1, -1):
        PA, PB = Ps[j + 1] @ A[j], Ps[j + 1] @ B[j]
        S = R[j] + B[j].T @ PB
        root[j] = sla.cholesky((S + S.T) / 2)
        rest = Ps[j + 1] @ c[j] + ps[j + 1]
        K[j] = sla.cho_solve((root[j], False), B[j].T @ PA + N[j].T)
        k[j] = sla.cho_solve((root[j], False), B[j].T @ rest)
        closed = A[j] - B[j] @ K[j]
        cross = N[j] @ K[j]
        now = Q[j] - cross - cross.T + K[j].T @ R[j] @ K[j] + closed.T @ Ps[j + 1] @ closed
        Ps[j], ps[j] = (now + now.T) / 2, closed.T @ rest
    return Laws(K, k, root, Ps, ps)


def predict(
    A: np.ndarray, B: np.ndarray, c: np.ndarray, found: Laws, horizon: int, blocks: Sequence[int] | None = None
) -> Prediction:
    """The motion as a function of xi_0 and z. Arrays over n >= horizon steps; past the horizon v = 0.

    With `blocks`, of lengths that add up to the horizon, mu is constant over each block; J is then V'(xi_0) + |z|^2
    with z of the free directions only, and z = 0 is the optimum without limits of such inputs.
    """
    n, nx, nu = B.shape
    nz = horizon * nu
    X, U = np.zeros((n + 1, nx, nx + nz + 1)), np.zeros((n, nu, nx + nz + 1))
    X[0, :, :nx] = np.eye(nx)
    for j in range(n):
        U[j] = -found.K[j] @ X[j]
        U[j, :, -1] -= found.k[j]
        if j < horizon:
            at = nx + j * nu
            U[j, :, at : at + nu] += sla.solve_triangular(found.root[j], np.eye(nu))
        X[j + 1] = A[j] @ X[j] + B[j] @ U[j]
        X[j + 1, :, -1] += c[j]
    if blocks is None:
        return Prediction(X, U)
    change = _blocked(U[:horizon].reshape(nz, -1), nx, nu, blocks)
    return Prediction(X @ change, U @ change)


def _blocked(U: np.ndarray, nx: int, nu: int, blocks: Sequence[int]) -> np.ndarray:
    """[xi_0; z; 1] (.., nx + nz + 1) from the same with z of the blocks.

    mu = U_x xi_0 + U_z z + U_1 must be T w, so z = G w - g, G = U_z^-1 T, g = U_z^-1 (U_x xi_0 + U_1); with G = Y F
    orthogonal-triangular, |z|^2 = |F w - Y'g|^2 + |g - Y Y'g|^2, the last of which no input changes.
    """
    T = np.kron(np.repeat(np.eye(len(blocks)), blocks, axis=0), np.eye(nu))
    size = len(U)
    inverse = np.linalg.solve(U[:, nx : nx + size], np.hstack([T, U[:, :nx], U[:, -1:]]))
    G, g = inverse[:, : T.shape[1]], inverse[:, T.shape[1] :]
    Y, _ = np.linalg.qr(G)
    left = Y @ (Y.T @ g) - g
    few = T.shape[1]
    change = np.zeros((nx + size + 1, nx + few + 1))
    change[:nx, :nx] = np.eye(nx)
    change[-1, -1] = 1.0
    change[nx : nx + size, :nx], change[nx : nx + size, -1] = left[:, :nx], left[:, nx]
    change[nx : nx + size, nx : nx + few] = Y
    return change


class LatePrediction(NamedTuple):
    """z+ = A z + B u, z = [x; the last `past` inputs, the oldest first], all less the model's point."""

    A: np.ndarray
    B: np.ndarray
    found: Laws
    past: int
    acts: int  # how many samples ago the input was given that acts at a sample

    def rows(self, C: np.ndarray, D: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """C (nb, nz), D (nb, nu) of signals C x + D u."""
        nu = D.shape[1]
        wide = np.hstack([C, np.zeros((len(C), self.past * nu))])
        if not self.acts:
            return wide, D
        first = C.shape[1] + (self.past - self.acts) * nu
        wide[:, first : first + nu] = D
        return wide, np.zeros_like(D)


def delayed_inputs(
    model: LinearModel, late: tuple[Any, Any], P: Any, track: Sequence[str]
) -> tuple[tuple[float, float] | None, np.ndarray | None]:
    """(shortest, longest) delay, None without one, and what acts before the first input does (nu,)."""
    delay, before = delay_range("MPC", late[0]), late[1]
    if before is not None:
        before = require_finite("MPC.before", before, model.u0.shape)
    if not delay[1]:
        return None, before
    if model.dt is not None or P is not None or len(track):
        raise ValueError(f"MPC.delay = {late[0]!r} must be 0 with a sampled model, with P and with track")
    return delay, before


def late_prediction(
    model: LinearModel,
    on_time: tuple[np.ndarray, ...],
    rates: tuple[np.ndarray, np.ndarray, np.ndarray],
    dt: float,
    delay: tuple[float, float],
    n: int,
) -> LatePrediction:
    """on_time: A, B, Q, R, N, P of the sampled problem without delay; rates: Q, R, N of continuous time."""
    A, B, _, R, N, P = on_time
    K = np.linalg.solve(R + B.T @ P @ B, N.T + B.T @ P @ A)
    without = riccati.Regulator(K, P, np.linalg.eigvals(A - B @ K).astype(complex))
    made = late_lqr(model.A, model.B, *rates, dt=dt, delays=delay, on_time=without)
    nz, nu = len(made.P), B.shape[1]
    root = sla.cholesky((made.S + made.S.T) / 2)
    found = Laws(
        np.tile(made.K, (n, 1, 1)),
        np.zeros((n, nu)),
        np.tile(root, (n, 1, 1)),
        np.tile(made.P, (n + 1, 1, 1)),
        np.zeros((n + 1, nz)),
    )
    step = made.middle.step
    return LatePrediction(step[:, :nz], step[:, nz:], found, past_of(delay[1]), past_of(sum(delay) / 2))
