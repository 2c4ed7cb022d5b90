"""What an MPC along a nominal motion holds, made once for every step of it, and the model about a scene's goal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.goal_model import goal_model
from pliant.controllers.base.joint_reference import values_of
from pliant.controllers.base.quadratic_weights import weight_matrices
from pliant.plants.core.argument_gates import require_instance, require_names
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.linear.quadratic_cost import signal_rows

from .condensed_prediction import Laws, laws, predict
from .constraints import Step, Window, build, soft_names
from .design import Limited, check_weights, checked_horizon, checked_penalty, limits_of, penalty_at

if TYPE_CHECKING:
    from pliant.controllers.base.scene_protocol import CostedScene
    from pliant.plants.linear.lti import LinearModel

POINTS = 3  # of the nominal, at which the penalty is found


def follower(
    ltv: LTVModel,
    weights: tuple[Any, Any, Any],
    horizon: int,
    limited: Limited,
    blocks: Sequence[int] | None,
    reads: Sequence[str] | None,
) -> dict[str, Any]:
    """What `MPC.along` says, as the arguments of MPC: weights (Q, R, P)."""
    Q, R, P = weights
    limits, rates, bounds, terminal, penalty = limited
    h = np.diff(require_instance("MPC.along: ltv", ltv, LTVModel).t)
    dt = float(h.mean())
    if np.abs(h - dt).max() > 1e-6 * dt:
        raise ValueError(f"MPC.along: ltv.t has steps from {h.min():.6g} to {h.max():.6g} s, must be equal")
    horizon, blocks, terminal = checked_horizon(horizon, blocks, terminal)
    penalty = checked_penalty(penalty)
    n, nodes, nx = horizon + terminal, len(ltv.t), len(ltv.states)
    own = require_names("MPC.reads", reads) if reads is not None else ltv.state_names
    if len(own) != nx:
        raise ValueError(f"MPC.reads = {own} must be {nx} names, one for each state of the model")
    models = [ltv.at(k) for k in range(nodes)]
    A, B, c, Qs, Rs, Ns, P = problem_along(ltv, Q, R, P, n)
    where = [*range(nodes), *[nodes - 1] * n]  # of each step in the nominal
    found = laws(A, B, c, Qs, Rs, Ns, P)
    bounded = limits_of(models[0], limits, rates, bounds, dt)
    signals = [signal_rows(model, bounded.bounded, "MPC.bounds: state or output") for model in models]
    C, D, z = (np.array([signals[k][i] for k in [*where, nodes - 1]]) for i in range(3))
    u, x, direct = ltv.u[where], ltv.x, np.asarray(D.any(axis=(0, 2)))

    def at(k: int, price: float | None, hard: bool = False) -> tuple[Step, Window]:
        one = slice(k, k + n)
        motion = predict(A[one], B[one], c[one], Laws(*(part[one] for part in found)), horizon, blocks)
        window = Window(u[one], x[k], z[k : k + n + 1], C[k : k + n + 1], D[k : k + n + 1], direct=direct)
        return build(motion, window, bounded, horizon, price, hard), window

    exact = penalty is None
    if penalty is None:
        penalty = 0.0
        for k in np.linspace(0, nodes - 1, POINTS).astype(int):
            hard, window = at(k, None, True)
            penalty = max(penalty, penalty_at(hard, A[k], B[k], window, bounded, found.root[k:]))
    return {
        "steps": [at(k, penalty)[0] for k in range(nodes)],
        "limits": bounded,
        "reads": own,
        "dt": dt,
        "start": float(ltv.t[0]),
        "origin": (ltv.x[0], ltv.u[0], ltv.x[0]),
        "names": soft_names(bounded, horizon, n),
        "exact": exact,
    }


def problem_along(ltv: LTVModel, Q: Any, R: Any, P: Any, n: int) -> tuple[np.ndarray, ...]:
    """A, B, c, Q, R, N (nodes + n, ..) of each step along a nominal, and n more at its last node; P past the end."""
    nodes, dt = len(ltv.t), float(np.diff(ltv.t).mean())
    models = [ltv.at(k) for k in range(nodes)]
    last = models[-1].discretize(dt)
    own_A, own_B, own_c = ltv.transition()
    A, B, c = (
        np.concatenate([part, np.repeat(end[None], n + 1, axis=0)])
        for part, end in ((own_A, last.A), (own_B, last.B), (own_c, last.f0))
    )
    costs = [tuple(dt * M for M in weight_matrices("MPC", model, Q, R)) for model in models]
    Qs, Rs, Ns = (np.array([costs[min(k, nodes - 1)][i] for k in range(nodes + n)]) for i in range(3))
    if P is None:
        P = riccati.dlqr(last.A, last.B, Qs[-1], Rs[-1], Ns[-1], names=ltv.state_names, dt=dt).P
    return A, B, c, Qs, Rs, Ns, check_weights(Qs[-1], Rs[-1], Ns[-1], P)


def about_goal(
    scene: CostedScene, bounds: Mapping[str, tuple[float, float]]
) -> tuple[LinearModel, np.ndarray | None, dict[str, tuple[float, float]], np.ndarray]:
    """The model about a scene's goal, its drift (nx,) [1/s] where it moves, the bounds that the model knows, and where
    the scene starts (nx,).
    """
    model, drift = goal_model(scene)
    known = {name for name, row in zip(model.output_names, model.C) if row.any()} | set(model.state_names)
    seen = {s.name for s in scene.plant.states + scene.plant.outputs} - known
    still = replace(model, f0=np.zeros_like(model.f0))
    known_bounds = {name: pair for name, pair in bounds.items() if name not in seen}
    start = values_of(scene.plant, *scene.initial, model.state_names)
    return still, drift if drift.any() else None, known_bounds, start
