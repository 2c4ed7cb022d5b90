"""Time per act of each controller in closed loop on the 12-state arm, beside HPIPM and do-mpc on the same problems.

The arm reaches within torque and deflection limits tight enough to bind, and its joints are struck every 0.2 s. Each
controller's own readings are recorded once and played back to it, each call timed by itself: median and 99th
percentile. The rows "where limits bind" leave out the acts of MPC that no limit changes, the cheap ones.
"""

from __future__ import annotations

import dataclasses
import importlib
import time
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np
from harness.sampling import TIME, Case, Row

from pliant.envs import scenes

GROUP = "controllers"
LQR, TVLQR, NMPC = "LQR", "TVLQR", "NMPC, 30 steps of 20 ms"
HORIZONS = (20, 40)
NONLINEAR = 30
EPISODES, KICKS, KICK = 4, 10, 1.0  # kicks: control periods between them, largest change of a joint's rate [rad/s]
COMPARED = 40  # acts of the peers
FAR = 1e3  # stands for no bound: HPIPM through CasADi does not converge with larger ones, which have multipliers too
SCENE = dataclasses.replace(
    scenes.get("two-link-reach"),
    limits=(30.0, 10.5),
    bounds=(("tip1_deflection", 0.12), ("tip2_deflection", 0.06), ("theta1_rate", 15.0), ("theta2_rate", 25.0)),
)
Sample = tuple[float, float]


def mpc_name(horizon: int) -> str:
    return f"MPC, {horizon} steps, where limits bind"


def hpipm_name(horizon: int) -> str:
    return f"HPIPM through CasADi, {horizon} steps"


def do_mpc_name(horizon: int) -> str:
    return f"do-mpc with IPOPT, {horizon} steps"


def known(name: str) -> bool:
    """Whether this version of Pliant has that controller."""
    return hasattr(importlib.import_module("pliant.controllers"), name)


@cache
def made(name: str, horizon: int | None = None) -> Any:
    """A controller by class name, built for the scene."""
    options = {} if horizon is None else {"horizon": horizon}
    return getattr(importlib.import_module("pliant.controllers"), name).for_scene(SCENE, **options)


def places(controller: Any) -> list[int]:
    return SCENE.positions(controller.reads)


def closed_loop(controller: Any) -> list[list[tuple[float, np.ndarray, bool]]]:
    """Time, reading, and whether a limit changed the act, at each period of some episodes."""
    rng = np.random.default_rng(0)
    plant = SCENE.plant
    step = plant.stepper(SCENE.dt, substeps=SCENE.substeps)
    picks, high = places(controller), np.array(SCENE.limits)
    first = plant.coordinates_slice.stop
    joints = [first, first + 1]
    record = getattr(controller, "record", None)
    episodes = []
    for _ in range(EPISODES):
        x = SCENE.initial[0].copy()
        x[:2] += rng.uniform(-0.3, 0.3, 2)
        u = np.zeros(plant.nu)
        controller.reset()
        told = []
        for k, t in enumerate(SCENE.times[:-1]):
            y = np.concatenate([x, plant.measure(x, u)])[picks]
            before = getattr(record, "limited", 0)
            u = controller.act(t, y)
            told.append((float(t), y, getattr(record, "limited", 0) > before))
            x = step(x[None], np.clip(u, -high, high)[None])[0].copy()
            if k % KICKS == 0:
                x[joints] += KICK * rng.uniform(-1, 1, 2)
        episodes.append(told)
    return episodes


def timed(controller: Any, bound: bool = False) -> Callable[[float], Sample]:
    """Median and 99th percentile [s] of single acts, over whole passes through the recorded episodes."""
    episodes = closed_loop(controller)

    def sample(seconds: float) -> Sample:
        spent: list[int] = []
        clock, act, begin = time.perf_counter_ns, controller.act, time.perf_counter()
        while not spent or time.perf_counter() - begin < seconds:
            for episode in episodes:
                controller.reset()
                for t, y, limited in episode:
                    start = clock()
                    act(t, y)
                    end = clock()
                    if limited or not bound:
                        spent.append(end - start)
        return 1e-9 * float(np.median(spent)), 1e-9 * float(np.percentile(spent, 99))

    sample(0.0)
    return sample


@dataclasses.dataclass(frozen=True)
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
    states: tuple[tuple[np.ndarray, np.ndarray], ...]  # where limits bind: x and the input that MPC chooses


@cache
def problem(horizon: int) -> Problem:
    from pliant.controllers import Objective, riccati

    objective = Objective.of(SCENE)
    model = SCENE.plant.linearize(objective.x_goal, objective.u_goal)
    sampled = riccati.sampled(model.A, model.B, *objective.quadratic(), dt=SCENE.dt)
    rows = np.vstack([np.eye(SCENE.plant.nx), model.C])[SCENE.positions([name for name, _ in SCENE.bounds])]
    z0 = SCENE.goal_values(tuple(name for name, _ in SCENE.bounds))
    mpc = made("MPC", horizon)
    found = [(y, t) for episode in closed_loop(mpc) for t, y, limited in episode if limited]
    chosen = []
    for y, t in found[:: max(1, len(found) // COMPARED)]:
        before = mpc.record.violations
        u = mpc.act(t, y)
        if mpc.record.violations == before:
            chosen.append((y, u))
    P = riccati.dlqr(*sampled).P
    reach = np.array([value for _, value in SCENE.bounds])
    return Problem(*sampled, P, rows, z0, reach, mpc.penalty, tuple(chosen))


def hpipm(horizon: int) -> Callable[[np.ndarray], np.ndarray]:
    """u of a state by HPIPM: states, inputs and excesses of the bounds as variables, its own order of stages."""
    import casadi as ca

    own = problem(horizon)
    x0, u0 = SCENE.target
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
    most = np.array(SCENE.limits)
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


def do_mpc(horizon: int) -> Callable[[np.ndarray], np.ndarray]:
    """u of a state by do-mpc's controller for discrete models."""
    import do_mpc as peer

    own = problem(horizon)
    x0, u0 = SCENE.target
    nx, nu = own.B.shape
    model = peer.model.Model("discrete")
    x, u = model.set_variable("_x", "x", (nx, 1)), model.set_variable("_u", "u", (nu, 1))
    model.set_rhs("x", own.A @ x + own.B @ u)
    model.setup()
    controller = peer.controller.MPC(model)
    controller.settings.n_horizon, controller.settings.t_step = horizon, SCENE.dt
    controller.settings.store_full_solution = False
    controller.settings.supress_ipopt_output()
    cost = x.T @ own.Q @ x + u.T @ own.R @ u + 2 * x.T @ own.N @ u
    controller.set_objective(lterm=cost, mterm=x.T @ own.P @ x)
    controller.set_rterm(u=0.0)
    most = np.array(SCENE.limits)
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


def beside(build: Callable[[int], Callable[[np.ndarray], np.ndarray]], horizon: int) -> Callable[[float], Sample]:
    """Times of a peer on states of MPC's closed loop where limits bind."""
    act = build(horizon)
    states = [x for x, _ in problem(horizon).states]

    def sample(seconds: float) -> Sample:
        spent: list[int] = []
        begin = time.perf_counter()
        while not spent or time.perf_counter() - begin < seconds:
            for x in states:
                start = time.perf_counter_ns()
                act(x)
                spent.append(time.perf_counter_ns() - start)
        return 1e-9 * float(np.median(spent)), 1e-9 * float(np.percentile(spent, 99))

    sample(0.0)
    return sample


@cache
def difference(build: Callable[[int], Callable[[np.ndarray], np.ndarray]], horizon: int) -> float:
    """Largest difference of a peer's inputs from MPC's [N m]."""
    act = build(horizon)
    return max(float(np.abs(act(x) - u).max()) for x, u in problem(horizon).states)


def cases() -> Iterator[Case]:
    for name, kind, horizon in ((LQR, "LQR", None), (TVLQR, "TVLQR", None), (NMPC, "NMPC", NONLINEAR)):
        if known(kind):
            yield Case(group=GROUP, name=name, unit=TIME, prepare=lambda kind=kind, n=horizon: timed(made(kind, n)))
    for horizon in HORIZONS:
        yield Case(
            group=GROUP, name=mpc_name(horizon), unit=TIME, prepare=lambda n=horizon: timed(made("MPC", n), bound=True)
        )
        yield Case(
            group=GROUP,
            name=f"MPC, {horizon} steps, every act",
            unit=TIME,
            prepare=lambda n=horizon: timed(made("MPC", n)),
        )
        for name, build in ((hpipm_name(horizon), hpipm), (do_mpc_name(horizon), do_mpc)):
            yield Case(group=GROUP, name=name, unit=TIME, peer=True, prepare=lambda b=build, n=horizon: beside(b, n))


def notes(rows: list[Row]) -> list[str]:
    """What limits did, and how far the peers' solutions are from ours."""
    own = [row for row in rows if row.group == GROUP]
    if not own:
        return []
    said = []
    for horizon in HORIZONS:
        acts = [limited for episode in closed_loop(made("MPC", horizon)) for *_, limited in episode]
        apart = []
        for name, build, short in ((hpipm_name(horizon), hpipm, "HPIPM"), (do_mpc_name(horizon), do_mpc, "do-mpc")):
            if any(row.name == name and row.samples for row in own):
                apart.append(f"{short} {difference(build, horizon):.1g} N m")
        said.append(
            f"MPC over {horizon} steps: limits change {np.mean(acts):.0%} of its {len(acts)} acts; largest difference "
            f"of inputs, of up to {max(SCENE.limits):g} N m, on {len(problem(horizon).states)} of those: "
            f"{', '.join(apart)}."
        )
    bends = [f"{value:g}" for name, value in SCENE.bounds if name.endswith("deflection")]
    said.append(
        f"Time per act: {SCENE.name}'s arm ({SCENE.plant.nx} states) within {SCENE.limits} N m and deflections of "
        f"{' and '.join(bends)} m, joints struck every {KICKS * SCENE.dt:g} s."
    )
    return said
