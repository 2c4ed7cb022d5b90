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
from harness.sampling import TIME, Case, Row, acts_of
from peers.mpc_solvers import Act, Problem, do_mpc, hpipm

from pliant.envs import scenes

GROUP = "controllers"
LQR, TVLQR, NMPC = "LQR", "TVLQR", "NMPC, 30 steps of 20 ms"
HORIZONS = (20, 40)
NONLINEAR = 30
EPISODES, KICKS, KICK = 4, 10, 1.0  # kicks: control periods between them, largest change of a joint's rate [rad/s]
COMPARED = 40  # acts of the peers
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
    episodes = [[(t, y, limited or not bound) for t, y, limited in told] for told in closed_loop(controller)]
    return acts_of(controller, episodes)


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
    return Problem(*sampled, P, rows, z0, reach, mpc.penalty, SCENE.target, SCENE.limits, SCENE.dt, tuple(chosen))


def beside(build: Callable[[Problem, int], Act], horizon: int) -> Callable[[float], Sample]:
    """Times of a peer on states of MPC's closed loop where limits bind."""
    act = build(problem(horizon), horizon)
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
def difference(build: Callable[[Problem, int], Act], horizon: int) -> float:
    """Largest difference of a peer's inputs from MPC's [N m]."""
    act = build(problem(horizon), horizon)
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
