"""Linear-quadratic regulators over a finite time, by square-root Riccati recursions.

dtvlqr   min x_T'P_T x_T + sum_k x'Qx + u'Ru + 2 x'Nu + 2 q'x + 2 s'u + r,   x+ = A_k x + B_k u + c_k
tvlqr    min x(T)'P_T x(T) + int x'Qx + u'Ru + 2 x'Nu dt,                    dx/dt = A(t) x + B(t) u + c(t)

Both give u = -K x - k and the cost to go x'P x + 2 p'x + r. The state carries a 1, z = [x; 1], so that c, the linear
terms and the constants are part of one quadratic z'S S'z, and only S is ever formed: by orthogonal factorisation of
what adds up (Morf and Kailath 1975). P = S S' then cannot lose its sign, as it does where P is integrated.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.argument_gates import real_array, require_count, require_finite, require_instance
from pliant.plants.core.errors import PliantError
from pliant.plants.core.matrix_roots import semidefinite_root
from pliant.plants.linear.ltv import LTVModel

from .checks import indefinite, weight_matrix
from .ltv_discretisation import LARGEST_DEFECT, hamiltonian_flow
from .node_distance import halved, measured
from .scaled_equation import input_units

Array = np.ndarray


class TimeVaryingRegulator(NamedTuple):
    """u = -K x - k at T times; cost to go x'P x + 2 p'x + r, at one time more in discrete time."""

    K: Array  # (T, nu, nx)
    k: Array  # (T, nu)
    P: Array  # (T or T+1, nx, nx)
    p: Array  # (T or T+1, nx)
    r: Array  # (T or T+1,)
    root: Array  # (T or T+1, nx + 1, nx + 1) S, lower triangular: [[P, p], [p', r]] = S S'
    error: float | None = 0.0  # of P, by the distance of an LTVModel's nodes; infinity: not known; None: not measured

    def cost_to_go(self, i: int, x: Any) -> float:
        """What is left to pay from x (nx,) at the time with index i."""
        i = require_count("cost_to_go", "i", i, -len(self.root), len(self.root) - 1)
        z = np.append(require_finite("x", x, self.p.shape[1:]), 1.0)
        return float(((z @ self.root[i]) ** 2).sum())


def dtvlqr(
    A: Any,
    B: Any,
    Q: Any,
    R: Any,
    N: Any = None,
    c: Any = None,
    *,
    q: Any = None,
    s: Any = None,
    r: Any = None,
    end: Any = None,
) -> TimeVaryingRegulator:
    """Discrete-time regulator over T steps.

    A (T, nx, nx), B (T, nx, nu); Q, R, N, c, q, s, r either with a leading T or the same at every step. `end`
    (nx, nx) weighs x_T, zero where None. The whole of a step's cost must be >= 0 at every (x, u), and R + B'P B > 0;
    ValueError names the step.

    Example
    -------
    >>> A, B = np.array([[1.0, 0.1], [0.0, 1.0]]), np.array([[0.005], [0.1]])
    >>> dtvlqr(np.array([A] * 20), np.array([B] * 20), np.eye(2), np.eye(1)).K.shape
    (20, 1, 2)
    """
    A = require_finite("A", A, (-1, -1, -1))
    T, nx = A.shape[:2]
    A = require_finite("A", A, (T, nx, nx))
    B = require_finite("B", B, (-1, -1, -1))
    nu = B.shape[-1]
    B = require_finite("B", B, (T, nx, nu))
    Q, R = (_along(name, real_array(name, M), T, (n, n)) for name, M, n in (("Q", Q, nx), ("R", R, nu)))
    N = _along("N", N, T, (nx, nu))
    c, q, s, r = _along("c", c, T, (nx,)), _along("q", q, T, (nx,)), _along("s", s, T, (nu,)), _along("r", r, T, ())
    weight = np.zeros((T, nu + nx + 1, nu + nx + 1))  # of [u; x; 1]
    weight[:, :nu, :nu], weight[:, nu:-1, nu:-1], weight[:, -1, -1] = R, Q, r
    weight[:, nu:-1, :nu], weight[:, -1, nu:-1], weight[:, -1, :nu] = N, q, s
    weight = np.tril(weight) + np.tril(weight, -1).transpose(0, 2, 1)
    roots, lacking = semidefinite_root(weight), indefinite(weight, 1e-9)
    if lacking.any():
        i = int(np.argmax(lacking))
        raise ValueError(f"step {i}: the cost [[Q, N, q], [N', R, s], [q', s', r]] has an eigenvalue < 0, must be >= 0")
    steps = np.zeros((T, nx + 1, nu + nx + 1))
    steps[:, :-1, :nu], steps[:, :-1, nu:-1], steps[:, :-1, -1], steps[:, -1, -1] = B, A, c, 1.0
    S = _end_root(end, nx)
    found, gains = [S], np.zeros((T, nu, nx + 1))
    for i in range(T - 1, -1, -1):
        stack = np.vstack([S.T @ steps[i], roots[i].T])
        upper = _triangle(stack)
        if (np.abs(np.diag(upper)[:nu]) <= 1e-14 * np.linalg.norm(upper[:, :nu], axis=0)).any():
            raise ValueError(f"step {i}: R + B'P B is singular, must be > 0")
        gains[i] = sla.solve_triangular(upper[:nu, :nu], upper[:nu, nu:])
        S = upper[nu:, nu:].T
        found.append(S)
    made = _regulator(gains, np.array(found[::-1]))
    _require_solved(A, B, Q, R, N, made)
    return made


def tvlqr(model: LTVModel, Q: Any, R: Any, N: Any = None, *, end: Any = None) -> TimeVaryingRegulator:
    """Continuous-time regulator at the nodes of an LTVModel, its affine term included.

    Q (nx, nx) >= 0, R (nu, nu) > 0, N (nx, nu) weigh the deviations from the nominal; `end` (nx, nx) those at the last
    node, zero where None. Of fourth order in the distance of the nodes. PliantError where they are too far apart;
    NodeWarning, and `error`, where they leave the cost to go unknown by more than a thousandth.

    Example
    -------
    >>> from pliant.plants import SingleLinkArm
    >>> arm = SingleLinkArm.textbook()
    >>> along = arm.linearize_along(arm.simulate(np.zeros(arm.nx), [1.0], np.linspace(0.0, 0.1, 11)))
    >>> tvlqr(along, np.eye(arm.nx), np.eye(1)).K.shape
    (11, 1, 6)
    """
    require_instance("model", model, LTVModel)
    made = _along_nodes(model, Q, R, N, end)
    half = lambda: _along_nodes(halved(model), Q, R, N, end).root  # noqa: E731
    return made._replace(error=measured(model, "tvlqr", made.root, half, 2, model.A - model.B @ made.K))


def _along_nodes(model: LTVModel, Q: Any, R: Any, N: Any, end: Any) -> TimeVaryingRegulator:
    nx, nu = len(model.states), len(model.inputs)
    Q, R = weight_matrix("Q", Q, nx, definite=False), weight_matrix("R", R, nu, definite=True)
    N = np.zeros((nx, nu)) if N is None else require_finite("N", N, (nx, nu))
    weight_matrix("[[Q, N], [N', R]]", np.block([[Q, N], [N.T, R]]), nx + nu, definite=False)
    unit = input_units(R)[:, None]
    even = unit * R * unit.T
    lean = unit * np.linalg.solve(even, unit * N.T)  # u = v - lean x has no cross term
    F, G, H, x = hamiltonian_flow(model, Q - N @ lean, R, lean)
    (input_roots, defect), (state_roots, other) = _roots(G), _roots(H)
    worst = np.maximum(defect, other)
    if worst.max() > LARGEST_DEFECT:
        i = int(np.argmax(worst))
        raise PliantError(
            f"tvlqr: between the nodes at {model.t[i]:.4g} and {model.t[i + 1]:.4g} s the cost to go loses its sign by "
            f"{worst[i]:.2g} of its size, at most {LARGEST_DEFECT:g}: put the nodes of the nominal closer there"
        )
    S = x[:, None] * _end_root(end, nx)
    found = [S]
    for i in range(len(F) - 1, -1, -1):
        upper = _triangle(np.vstack([np.eye(nx + 1), input_roots[i].T @ S]))  # upper'upper = I + S'G S
        ahead = sla.solve_triangular(upper, S.T @ F[i], trans="T")
        S = _triangle(np.vstack([ahead, state_roots[i].T])).T
        found.append(S)
    S = np.array(found[::-1]) / x[:, None]
    B = np.concatenate([model.B, np.zeros((len(model.t), 1, nu))], axis=1)
    gains = unit * np.linalg.solve(even, unit * (B.transpose(0, 2, 1) @ S @ S.transpose(0, 2, 1)))
    gains[:, :, :nx] += lean
    return _regulator(gains, S)


def _require_solved(A: Array, B: Array, Q: Array, R: Array, N: Array, made: TimeVaryingRegulator) -> None:
    """PliantError unless P satisfies the Riccati recursion, written without roots."""
    later, turned = made.P[1:], A.transpose(0, 2, 1)
    G = B.transpose(0, 2, 1) @ later @ A + N.transpose(0, 2, 1)
    H = R + B.transpose(0, 2, 1) @ later @ B
    terms = np.array([turned @ later @ A, Q, -G.transpose(0, 2, 1) @ made.K, -made.P[:-1]])
    spread = np.abs(turned) @ np.abs(later) @ np.abs(A) + np.abs(Q)
    own = np.sqrt(np.diagonal(spread, axis1=1, axis2=2))  # a unit of each state
    paid = np.sqrt(np.diagonal(H, axis1=1, axis2=2))  # and of each input
    left = _against(terms.sum(axis=0), own, own)
    worst = np.maximum(left, _against(H @ made.K - G, paid, own))
    if not worst.max() <= LARGEST_DEFECT:
        i = int(np.argmax(worst))
        raise PliantError(
            f"dtvlqr: step {i} is solved only to a relative residual of {worst[i]:.2g}, must be {LARGEST_DEFECT:g}: "
            "scale the states, or change Q and R"
        )


def _against(rest: Array, rows: Array, columns: Array) -> Array:
    """Largest entry (T,) of rest (T, n, m) against the units of its rows (T, n) and columns (T, m)."""
    unit = rows[:, :, None] * columns[:, None, :]
    return np.asarray((np.abs(rest) / np.where(unit > 0, unit, np.inf)).max(axis=(1, 2), initial=0.0))


def _roots(weight: Array) -> tuple[Array, Array]:
    """S (T, n, n) with S S' = weight (T, n, n) less its negative part, and that part against its size (T,)."""
    value = np.linalg.eigvalsh((weight + weight.transpose(0, 2, 1)) / 2)
    size = np.maximum(np.abs(value).max(axis=1, initial=0.0), 1e-300)
    return semidefinite_root(weight), np.maximum(-value.min(axis=1, initial=0.0), 0.0) / size


def _end_root(end: Any, nx: int) -> Array:
    weight = np.zeros((1, nx + 1, nx + 1))
    if end is not None:
        weight[0, :nx, :nx] = weight_matrix("end", end, nx, definite=False)
    return _triangle(_roots(weight)[0][0].T).T


def _triangle(stack: Array) -> Array:
    """Upper triangular U with U'U = stack'stack."""
    return np.asarray(np.linalg.qr(stack, mode="r"))


def _along(name: str, value: Any, T: int, shape: tuple[int, ...]) -> Array:
    """A value of every step (T, *shape) from one for all, one each, or None for zero."""
    if value is None:
        return np.zeros((T, *shape))
    value = real_array(name, value)
    each = value.ndim == len(shape) + 1
    return np.broadcast_to(require_finite(name, value, (T, *shape) if each else shape), (T, *shape))


def _regulator(gains: Array, S: Array) -> TimeVaryingRegulator:
    whole = S @ S.transpose(0, 2, 1)
    return TimeVaryingRegulator(
        gains[:, :, :-1], gains[:, :, -1], whole[:, :-1, :-1], whole[:, :-1, -1], whole[:, -1, -1], S
    )
