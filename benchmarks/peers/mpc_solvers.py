"""The program that MPC solves at each act, by HPIPM through CasADi and by do-mpc with IPOPT."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

FAR = 1e3  # stands for no bound: HPIPM through CasADi does not converge with larger ones, which have multipliers too
Act = Callable[[np.ndarray], np.ndarray]  # u of a state


@dataclass(frozen=True)
class Problem:
    """What MPC solves, of which the peers are told: the same model, weights, limits and penalty."""

    A: np.ndarray
    B: np.ndarray
    Q: np.ndarray
    R: np.ndarray
    N: np.ndarray
    P: np.ndarray
    C: np.ndarray  # (nb, nx) bounded signals ..
    z0: np.ndarray  # (nb,) .. at the goal
    reach: np.ndarray  # (nb,) largest size of each
    penalty: float
    target: tuple[np.ndarray, np.ndarray]  # x and u of the goal
    limits: tuple[float, ...]  # of the inputs
    dt: float  # [s]
    states: tuple[tuple[np.ndarray, np.ndarray], ...]  # where limits bind: x and the input that MPC chooses


def hpipm(own: Problem, horizon: int) -> Act:
    """u of a state by HPIPM: states, inputs and excesses of the bounds as variables, its own order of stages."""
    import casadi as ca

    x0, u0 = own.target
    (nx, nu), nb = own.B.shape, len(own.C)
    stage = nx + nu + nb  # x, u, s
    size = horizon * stage + nx
    H, g = np.zeros((size, size)), np.zeros(size)
    A, lba, uba = np.zeros((horizon * (nx + 2 * nb), size)), [], []
    for j in range(horizon):
        x, u, s = j * stage, j * stage + nx, j * stage + nx + nu
        row = j * (nx + 2 * nb)
        H[x:u, x:u], H[u:s, u:s], H[x:u, u:s], H[u:s, x:u] = 2 * own.Q, 2 * own.R, 2 * own.N, 2 * own.N.T
        H[s : s + nb, s : s + nb] = 2 * 0.0005 * own.penalty * np.eye(nb)
        g[s : s + nb] = own.penalty
        A[row : row + nx, x:u], A[row : row + nx, u:s] = own.A, own.B
        A[row : row + nx, x + stage : x + stage + nx] = -np.eye(nx)
        low, high = -own.reach - own.z0, own.reach - own.z0
        for k, sign in enumerate((-1.0, 1.0)):
            at = row + nx + k * nb
            A[at : at + nb, x:u], A[at : at + nb, u:s] = own.C @ own.A, own.C @ own.B
            A[at : at + nb, s : s + nb] = sign * np.diag(own.reach)
        lba += [np.zeros(nx), np.full(nb, -FAR), low]
        uba += [np.zeros(nx), high, np.full(nb, FAR)]
    H[-nx:, -nx:] = 2 * own.P
    most = np.array(own.limits)
    free, none, far = np.full(nx, FAR), np.zeros(nb), np.full(nb, FAR)
    lbx = np.concatenate([*[part for _ in range(horizon) for part in (-free, -most - u0, none)], -free])
    ubx = np.concatenate([*[part for _ in range(horizon) for part in (free, most - u0, far)], free])
    sparse_H, sparse_A = (ca.sparsify(ca.DM(M)) for M in (H, A))
    shapes = {"h": sparse_H.sparsity(), "a": sparse_A.sparsity()}
    options = {"error_on_fail": True, "hpipm": {"iter_max": 100, "mode": "speed"}}
    options |= {
        "N": horizon,
        "nx": [nx] * (horizon + 1),
        "nu": [nu + nb] * horizon + [0],
        "ng": [2 * nb] * horizon + [0],
    }
    solver = ca.conic("hpipm", "hpipm", shapes, options)
    given = {"h": sparse_H, "g": g, "a": sparse_A, "lbx": lbx, "ubx": ubx}
    given |= {"lba": np.concatenate(lba), "uba": np.concatenate(uba)}
    held = {name: ca.DM(value) for name, value in given.items()}

    def act(x: np.ndarray) -> np.ndarray:
        held["lbx"][:nx] = held["ubx"][:nx] = x - x0
        found = solver(**held)
        return u0 + found["x"][nx : nx + nu].full().ravel()

    return act


def do_mpc(own: Problem, horizon: int) -> Act:
    """u of a state by do-mpc's controller for discrete models."""
    import do_mpc as peer

    x0, u0 = own.target
    nx, nu = own.B.shape
    model = peer.model.Model("discrete")
    x, u = model.set_variable("_x", "x", (nx, 1)), model.set_variable("_u", "u", (nu, 1))
    model.set_rhs("x", own.A @ x + own.B @ u)
    model.setup()
    controller = peer.controller.MPC(model)
    controller.settings.n_horizon, controller.settings.t_step = horizon, own.dt
    controller.settings.store_full_solution = False
    controller.settings.supress_ipopt_output()
    cost = x.T @ own.Q @ x + u.T @ own.R @ u + 2 * x.T @ own.N @ u
    controller.set_objective(lterm=cost, mterm=x.T @ own.P @ x)
    controller.set_rterm(u=0.0)
    most = np.array(own.limits)
    controller.bounds["lower", "_u", "u"], controller.bounds["upper", "_u", "u"] = -most - u0, most - u0
    following = own.C @ (own.A @ x + own.B @ u) + own.z0
    for name, sign in (("above", 1.0), ("below", -1.0)):
        for i, reach in enumerate(own.reach):
            controller.set_nl_cons(
                f"{name}{i}", sign * following[i] / reach, ub=1.0, soft_constraint=True, penalty_term_cons=own.penalty
            )
    controller.setup()
    controller.x0 = np.zeros((nx, 1))
    controller.set_initial_guess()
    return lambda x: u0 + controller.make_step((x - x0)[:, None]).ravel()
