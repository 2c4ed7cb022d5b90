"""Designs do not depend on units: random models and every shipped scene, in random units of 1e-9 to 1e+9.

    python tests/campaigns/units.py

States, inputs, outputs, disturbances, time and cost each get a unit of their own. A gain, taken back into the first
units, must be the same to 1e-8 of the largest of its row, or to 30 times what one rounding of the model's own entries
moves it (such are counted); a mode that is out of reach must be refused in both, under the same name. The first design
is checked against SciPy's solvers in even units (1e-6: what they keep themselves), and what is refused there must be
what cannot be reached: it was made so.
"""

from __future__ import annotations

import re
import time
import warnings
from collections import Counter
from dataclasses import replace
from functools import cache
from typing import Any

import by_seed
import numpy as np
import scipy.linalg as sla
from random_designs import DECADES, Case, Units, case, ltv_of, model_of, rounded, units_for

from pliant.controllers import LQR, MPC, TVLQR, Kalman, Sensor, riccati
from pliant.controllers.base.goal_model import goal_model
from pliant.controllers.base.quadratic_weights import weight_matrices
from pliant.controllers.riccati.node_distance import NodeWarning
from pliant.envs import scenes
from pliant.plants import LinearModel, PliantError, UncontrollableError

SAME = 1e-8  # of a row's largest gain
TRUE = 1e-6
KINDS = ("lqr", "lqr", "sampled", "lqi", "kalman", "Kalman", "tvlqr", "dtvlqr", "unreached", "scene")


def design(kind: str, c: Case, units: Units | None) -> dict[str, np.ndarray]:
    """Gains in the first units, by name."""
    nx, nu, ny = *c.B.shape, len(c.C)
    one = Units(np.ones(nx), np.ones(nu), np.ones(c.E.shape[1]), np.ones(ny), 1.0, 1.0) if units is None else units
    back = lambda K: np.asarray(K) * one.x / one.u[:, None]  # noqa: E731
    gain = lambda L: np.asarray(L) * one.y / one.x[:, None]  # noqa: E731
    c = c.scaled(one)
    if kind in ("lqr", "unreached"):
        return {"K": back(riccati.lqr(c.A, c.B, c.Q, c.R, c.N).K)}
    if kind == "sampled":
        step = riccati.sampled(c.A, c.B, c.Q, c.R, c.N, dt=c.dt)
        return {"A": step.A * one.x / one.x[:, None], "K": back(riccati.dlqr(*step, dt=c.dt).K)}
    if kind == "lqi":
        C = c.C[: min(nu, ny, nx)]
        Q = sla.block_diag(c.Q, np.diag(one.cost / one.t**3 / one.y[: len(C)] ** 2))
        wide = np.concatenate([one.x, one.y[: len(C)] * one.t])
        return {"K": riccati.lqi(c.A, c.B, C, Q, c.R).K * wide / one.u[:, None]}
    if kind == "kalman":
        return {"L": gain(one.t * riccati.kalman(c.A, c.E, c.C, np.diag(c.W), np.diag(c.V) * one.t)[0])}
    names = [f"y{i + 1}" for i in range(ny)]
    sensors = [Sensor("other", name, "", noise=float(v)) for name, v in zip(names, np.sqrt(c.V))]
    W = {f"w{i + 1}": float(w) for i, w in enumerate(c.W)}
    if kind == "Kalman":
        made = Kalman.design(model_of(c), sensors, W, dt=c.dt).gains[-1]
        return {"L": gain(made.L), "P": made.P / one.x / one.x[:, None]}
    ltv = ltv_of(c)
    if kind == "tvlqr":
        return {"K": back(riccati.tvlqr(ltv, c.Q, c.R, c.N).K)[0]}
    made = TVLQR.design(ltv, c.Q, c.R, c.N)
    P0 = np.diag(one.x**2)
    filtered = Kalman.along(ltv, sensors, W, P0=P0).gains[-1]
    return {"K": back(made.K[0]), "L": gain(filtered.L), "P": filtered.P / one.x / one.x[:, None]}


def distance(found: dict[str, np.ndarray], wanted: dict[str, np.ndarray]) -> float:
    """Largest difference against the largest of a row; of a covariance, against the standard deviations."""
    worst = 0.0
    for name, right in wanted.items():
        size = np.abs(right).max(axis=-1, keepdims=True) if name != "P" else np.sqrt(np.outer(d := np.diag(right), d))
        off = np.abs(found[name] - right) / np.where(size > 0, size, 1.0)
        worst = max(worst, float(off.max(initial=0.0)) if np.isfinite(off).all() else np.inf)
    return worst


def truth(kind: str, c: Case) -> dict[str, np.ndarray] | None:
    """From SciPy, in even units."""
    try:
        if kind == "lqr":
            P = sla.solve_continuous_are(c.A, c.B, c.Q, c.R, s=c.N)
            return {"K": np.linalg.solve(c.R, c.B.T @ P + c.N.T)}
        if kind == "kalman":
            P = sla.solve_continuous_are(c.A.T, c.C.T, c.E @ np.diag(c.W) @ c.E.T, np.diag(c.V))
            return {"L": P @ c.C.T @ np.diag(1 / c.V)}
    except np.linalg.LinAlgError:
        pass
    return None


def attempt(kind: str, c: Case, units: Units | None) -> tuple[dict[str, np.ndarray], str]:
    """The gains, or what was said instead."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", NodeWarning)  # how far a few nodes tell is no matter of units
            return design(kind, c, units), ""
    except UncontrollableError as error:
        return {}, f"out of reach: {', '.join(sorted(re.sub(r'[0-9.]+ Hz', '', m) for m in error.modes))}"
    except PliantError as error:
        return {}, str(error)


def random_case(seed: int, kind: str) -> dict[str, Any]:
    c, rng = case(seed)
    lost = None
    if kind == "unreached":  # an undamped mode that no input moves
        lost = 10 ** rng.uniform(0, 2)
        block, n = lost * np.array([[0.0, 1.0], [-1.0, 0.0]]), len(c.A)
        A, B = sla.block_diag(c.A, block), np.vstack([c.B, np.zeros((2, c.B.shape[1]))])
        Q, wide = sla.block_diag(c.Q, np.eye(2)), lambda M: np.vstack([M, np.zeros((2, M.shape[1]))])
        C = np.hstack([c.C, np.ones((len(c.C), 2))])
        c = replace(c, A=A, B=B, E=wide(c.E), C=C, Q=Q, N=wide(c.N))
        T = np.eye(n + 2) + np.diag(np.full(n + 1, 1e-3), -1) if rng.random() < 0.5 and n < 10 else np.eye(n + 2)
        back = np.linalg.inv(T)
        c = replace(c, A=T @ c.A @ back, B=T @ c.B, E=T @ c.E, C=c.C @ back, Q=back.T @ c.Q @ back, N=back.T @ c.N)
        c = replace(c, Q=(c.Q + c.Q.T) / 2)
    units = units_for(rng, *c.B.shape, c.E.shape[1], len(c.C))
    found, said = attempt(kind, c, None)
    other, said_too = attempt(kind, c, units)
    row: dict[str, Any] = {"nx": len(c.A), "off": 0.0, "true": 0.0, "moved": 0.0, "said": said[:100], "wrong": ""}
    if bool(said) != bool(said_too) or (said.startswith("out of reach") and said != said_too):
        row["wrong"] = f"refused in one unit only: {said!r}, {said_too!r}"
    elif said:
        row["wrong"] = "" if kind == "unreached" or "known only" in said else f"refused: {said}"
    else:
        row["off"] = distance(other, found)
        right = truth(kind, c)
        row["true"] = distance(found, right) if right else 0.0
        if not row["off"] <= SAME:
            row["moved"] = distance(attempt(kind, rounded(c, rng), None)[0], found)
        if not row["off"] <= max(SAME, 30 * row["moved"]):
            row["wrong"] = f"off by {row['off']:.2g} in other units"
        elif not row["true"] <= TRUE:
            row["wrong"] = f"off by {row['true']:.2g} of SciPy's"
        elif lost is not None:
            row["wrong"] = "a mode that no input moves was not refused"
    return row


@cache
def goal(name: str) -> tuple[Any, ...] | None:
    scene = scenes.get(name)
    try:
        model, _ = goal_model(scene)
        return scene, model, weight_matrices("units", model, dict(scene.weights), dict(scene.effort))
    except PliantError:
        return None  # its goal cannot be held: there is no steady design


def scene_case(seed: int) -> dict[str, Any]:
    """LQR, continuous and sampled, Kalman and MPC of a scene."""
    rng, name = np.random.default_rng(seed), scenes.names()[seed // len(KINDS) % len(scenes.names())]
    row: dict[str, Any] = {"nx": 0, "off": 0.0, "true": 0.0, "moved": 0.0, "said": name, "wrong": ""}
    given = goal(name)
    if given is None:
        return row
    scene, model, (Q, R, _) = given
    nx, nu = model.B.shape
    row["nx"] = nx
    x, u = (10.0 ** rng.uniform(-DECADES, DECADES, k) for k in (nx, nu))
    flat = {"states": model.state_names, "inputs": model.input_names}
    high = np.array(scene.limits, dtype=float)
    start = rng.normal(size=nx) * 0.01

    def designs(x: np.ndarray, u: np.ndarray) -> dict[str, np.ndarray]:
        """By sensors of single states, of noise 1e-5, and noise on every rate."""
        m = LinearModel.from_matrices(x[:, None] * model.A / x, x[:, None] * model.B / u, **flat)
        Qs, Rs = Q / x[:, None] / x, R / u[:, None] / u
        back = x / u[:, None]
        made = {
            "K": LQR.design(m, Qs, Rs).K * back,
            "Kd": LQR.design(m, Qs, Rs, dt=scene.dt).K * back,
            "u": MPC.design(m, Qs, Rs, horizon=8, dt=scene.dt, limits=(-high * u, high * u)).act(0.0, x * start) / u,
        }
        sensors = [Sensor("other", name, "", noise=1e-5 * float(s)) for name, s in zip(m.state_names, x)]
        noise = {name: 1e-4 * float(s) ** 2 for name, s in zip(m.state_names, x)}
        filtered = Kalman.design(m, sensors, noise, dt=scene.dt).gains[-1]
        return made | {"L": filtered.L * x / x[:, None], "P": filtered.P / x / x[:, None]}

    try:
        row["off"] = distance(designs(x, u), designs(np.ones(nx), np.ones(nu)))
        row["wrong"] = "" if row["off"] <= SAME else f"{name}: off by {row['off']:.2g}"
    except (PliantError, ValueError) as error:
        row["wrong"] = f"{name}: {error}"
    return row


def run(seed: int) -> dict[str, Any]:
    kind, began = KINDS[seed % len(KINDS)], time.perf_counter()
    row = scene_case(seed) if kind == "scene" else random_case(seed, kind)
    return {"seed": seed, "kind": kind, **row, "seconds": round(time.perf_counter() - began, 3)}


def summary(rows: list[dict[str, Any]]) -> str:
    wrong = [r for r in rows if r["wrong"]]
    text = f"{len(rows)} designs in two units each: {len(wrong)} faults"
    for kind in dict.fromkeys(KINDS):
        own = [r for r in rows if r["kind"] == kind]
        unknown = Counter("known only" in r["said"] for r in own)[True]
        text += f"\n  {kind}: {len(own)}, off by {max((r['off'] for r in own), default=0):.2g} at most"
        text += f", of SciPy's {max((r['true'] for r in own), default=0):.2g}, {unknown} known too little and said so"
        text += f", {sum(r['moved'] > 0 for r in own)} moved as far by rounding of the model"
    return text + "".join(f"\n  seed {r['seed']} ({r['kind']}, {r['nx']} states): {r['wrong']}" for r in wrong[:20])


if __name__ == "__main__":
    by_seed.main(__doc__, 1000, run, summary, lambda row: bool(row["wrong"]))
