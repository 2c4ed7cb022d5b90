"""What an MPC about an equilibrium holds, made once: prediction, rows of limits, solver, estimator and target."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.base.controller import each, ends, saturation
from pliant.controllers.riccati.checks import weight_matrix
from pliant.controllers.riccati.late_inputs import past_of
from pliant.plants.core.argument_gates import (
    as_tuple,
    require_by_name,
    require_choice,
    require_count,
    require_instance,
    require_mapping,
    require_names,
    require_number,
    require_seconds,
    shown,
)
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.quadratic_cost import signal_rows

from .condensed_prediction import delayed_inputs, late_prediction, laws, predict
from .constraints import Limits, Step, Window, build, soft_names
from .exact_penalty import sufficient_penalty
from .offset_free import KINDS, Estimator, Sizes
from .steady_target import Target
from .steered_weights import steered_weights, step_weights

Limited = tuple[Any, Any, Mapping[str, tuple[float, float]] | None, int, float | None]
# limits, rates, bounds, terminal, penalty of MPC.design
NOISE = 1e-2  # standard deviation of a reading, where that of an input is one
LARGEST_RATE = 1e-6  # of a state at an equilibrium, per step, against its value and what inputs do to it


def regulator(
    model: LinearModel,
    weights: tuple[Any, Any, Any, Any],
    horizon: int,
    dt: float | None,
    limited: Limited,
    blocks: Sequence[int] | None,
    reads: Sequence[str] | None,
    free_of_offset: tuple[Sequence[str], str | None, float, Any],
    start: Any = None,
    late: tuple[Any, Any] = (0.0, None),
) -> dict[str, Any]:
    """What `MPC.design` says, as the arguments of MPC: weights (Q, R, N, P), (track, disturbance, time, noise), late
    (delay, before)."""
    Q, R, N, P = weights
    require_instance("MPC.model", model, LinearModel)
    delay, before = delayed_inputs(model, late, P, track=free_of_offset[0])
    left: tuple[tuple[str, ...], tuple[str, ...]] = ((), ())
    limits, rates, bounds, terminal, penalty = limited
    track, disturbance, time, noise = free_of_offset
    horizon, blocks, terminal = checked_horizon(horizon, blocks, terminal)
    penalty, track = checked_penalty(penalty), require_names("MPC.track", track)
    reads = model.state_names if reads is None else require_names("MPC.reads", reads)
    time = require_seconds("MPC.time", time)
    if P is None and model.dt is None:
        Q, R, N, P, left = steered_weights(model, Q, R, N, dt, start)
    rates_of_cost = None if delay is None else step_weights(model, Q, R, N)
    A, B, Q, R, N, dt = _sampled(model, Q, R, N, dt)
    nx, nu = B.shape
    n = horizon + terminal
    if P is None:
        P = riccati.dlqr(A, B, Q, R, N, names=model.state_names, dt=dt).P
    P = check_weights(Q, R, N, P)
    bounded = limits_of(model, limits, rates, bounds, dt)
    _require_rest(model, A, B, dt, bounded)
    C, D, z0 = signal_rows(model, bounded.bounded, "MPC.bounds: state or output")
    x0 = model.x0
    if delay is not None and rates_of_cost is not None:
        if delay[0] < delay[1] and any(left):
            raise ValueError(f"MPC.delay = {delay} must be one number where something is conserved or free")
        whole = late_prediction(model, (A, B, Q, R, N, P), rates_of_cost, dt, delay, n)
        A, B, found, C, D = whole.A, whole.B, whole.found, *whole.rows(C, D)
        x0 = np.concatenate([x0, np.tile(model.u0, whole.past)])
    else:
        As, Bs, cs, Qs, Rs, Ns = (np.broadcast_to(M, (n, *M.shape)) for M in (A, B, np.zeros(nx), Q, R, N))
        found = laws(As, Bs, cs, Qs, Rs, Ns, P)
    As, Bs, cs = (np.broadcast_to(M, (n, *M.shape)) for M in (A, B, np.zeros(len(A))))
    motion = predict(As, Bs, cs, found, horizon, blocks)
    extra: dict[str, Any] = {}
    seen, y0 = None, model.x0
    if track:
        seen, y0, extra = _offset_free(
            model, (A, B, dt), np.block([[Q, N], [N.T, R]]), bounded, reads, track, disturbance, time, noise
        )
    elif disturbance is not None:
        raise ValueError(f"MPC.disturbance = {disturbance!r} needs track, the names of signals to bring to their goal")
    elif len(reads) != nx:
        raise ValueError(f"MPC.reads = {reads} must be {nx} names, one for each state of the model")
    window = Window(
        np.broadcast_to(model.u0, (n, nu)),
        x0,
        np.broadcast_to(z0, (n + 1, len(z0))),
        np.broadcast_to(C, (n + 1, *C.shape)),
        np.broadcast_to(D, (n + 1, *D.shape)),
        seen,
    )
    exact = penalty is None
    if penalty is None:
        penalty = penalty_at(
            build(motion, window, bounded, horizon, None, hard=True), A, B, window, bounded, found.root
        )
    step = build(motion, window, bounded, horizon, penalty)
    return {
        "steps": [step],
        "limits": bounded,
        "reads": reads,
        "dt": dt,
        "start": 0.0,
        "origin": (model.x0, model.u0, y0),
        "names": soft_names(bounded, horizon, n),
        "exact": exact,
        "left": left,
        "late": None if delay is None else (delay, np.tile(model.u0 if before is None else before, past_of(delay[1]))),
        **extra,
    }


def checked_horizon(horizon: int, blocks: Any, terminal: int) -> tuple[int, tuple[int, ...] | None, int]:
    """Integers, the blocks' lengths adding up to the horizon."""
    horizon = require_count("MPC", "horizon", horizon, 1, 10_000)
    terminal = require_count("MPC", "terminal", terminal, 0, 10_000)
    if blocks is None:
        return horizon, None, terminal
    lengths = as_tuple("MPC.blocks", blocks)
    found = tuple(require_count("MPC", f"blocks[{i}]", n, 1, 10_000) for i, n in enumerate(lengths))
    if sum(found) != horizon:
        raise ValueError(f"MPC.blocks = {found} must be lengths >= 1 that add up to the horizon, {horizon}")
    return horizon, found, terminal


def checked_penalty(penalty: Any) -> float | None:
    """> 0, or None."""
    return None if penalty is None else require_number("MPC.penalty", penalty, "positive")


def check_weights(Q: np.ndarray, R: np.ndarray, N: np.ndarray, P: Any) -> np.ndarray:
    """P (nx, nx), symmetric; ValueError unless P >= 0, R > 0 and the cost of a step is never negative."""
    weight_matrix("MPC.R", R, len(R), definite=True)
    weight_matrix("MPC: [[Q, N], [N', R]]", np.block([[Q, N], [N.T, R]]), len(Q) + len(R), definite=False)
    return weight_matrix("MPC.P", P, len(Q), definite=False)


def _sampled(
    model: LinearModel, Q: Any, R: Any, N: Any, dt: float | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, float]:
    """A, B, Q, R, N of a step, and its length."""
    Q, R, N = step_weights(model, Q, R, N)
    dt = None if dt is None else require_seconds("MPC.dt", dt)
    if model.dt is not None:
        if dt is not None and abs(dt - model.dt) > 1e-9 * dt:
            raise ValueError(f"MPC.dt = {dt} must be {model.dt}, the model's, or be left out")
        return model.A, model.B, Q, R, N, model.dt
    if dt is None:
        raise ValueError("MPC.dt = None must be the sampling time in seconds, since the model is continuous")
    return *riccati.sampled(model.A, model.B, Q, R, N, dt=dt), dt


def _require_rest(model: LinearModel, A: np.ndarray, B: np.ndarray, dt: float, limits: Limits) -> None:
    """ValueError where a state moves in a step, against its value and what inputs do to it in as many steps as it has
    states: by half their range, by their value or one unit where that is infinite."""
    half = (limits.high - limits.low) / 2
    push = np.where(np.isfinite(half) & (half > 0), half, np.maximum(np.abs(model.u0), 1.0))
    step = np.abs(B) @ push
    size = np.abs(model.x0) + step
    for _ in range(len(A)):
        step = np.abs(A) @ step
        size = size + step
    off = np.abs(model.f0) * (dt if model.dt is None else 1.0)
    moves = off > LARGEST_RATE * size
    if moves.any():
        worst = int(np.argmax(np.where(moves, off / np.where(size > 0, size, 1e-300), 0.0)))
        name = model.state_names[worst]
        raise ValueError(
            f"MPC.design: the model's point is no equilibrium, {name} moves by {off[worst]:.3g} in a step; linearise "
            "at one, or use MPC.along"
        )


def limits_of(model: LinearModel, limits: Any, rates: Any, bounds: Mapping[str, Any] | None, dt: float) -> Limits:
    low, high = saturation("MPC", limits, model.input_names)
    change = np.full(len(low), np.inf)
    if isinstance(rates, Mapping):
        for name, value in require_by_name("MPC.rates", rates, model.input_names, "input").items():
            change[model.input_names.index(name)] = value
    elif rates is not None:
        change[:] = each("MPC.rates", rates, len(change))
    if not (change > 0).all():
        raise ValueError(f"MPC.rates = {shown(rates)} must be > 0")
    known = model.state_names + model.output_names
    bounds = {} if bounds is None else require_mapping("MPC.bounds", bounds, known, "state or output")
    found = [ends(f"MPC.bounds[{name!r}]", value) for name, value in bounds.items()]
    floor, ceiling = (np.array([one[i] for one in found], dtype=float) for i in (0, 1))
    return Limits(model.input_names, low, high, change * dt, tuple(bounds), floor, ceiling)


def penalty_at(hard: Step, A: np.ndarray, B: np.ndarray, window: Window, limits: Limits, root: np.ndarray) -> float:
    """Enough for states sampled about this step."""
    parts = [window.x]
    if window.seen is not None:
        parts += [window.x, window.u[0], np.zeros(window.seen.shape[1])]
    if limits.remembers:
        parts.append(window.u[0])
    p = np.concatenate(parts)
    return sufficient_penalty(hard, A, B, p, limits.low - window.u[0], limits.high - window.u[0], root[0])


def _offset_free(
    model: LinearModel,
    sampled: tuple[np.ndarray, np.ndarray, float],
    weight: np.ndarray,
    limits: Limits,
    reads: tuple[str, ...],
    track: tuple[str, ...],
    disturbance: str | None,
    time: float,
    noise: float | Mapping[str, float],
) -> tuple[np.ndarray, np.ndarray, dict[str, Any]]:
    """The disturbance in the bounded signals (nb, nd), the readings at the model's point, and what MPC takes more."""
    A, B, dt = sampled
    kind = "states" if disturbance is None else disturbance
    require_choice("MPC", "disturbance", kind, KINDS)
    if kind == "states":
        if len(reads) != len(A):
            raise ValueError(f"MPC.reads = {reads} must be {len(A)} names, one for each state of the model")
        C, y0 = np.eye(len(A)), model.x0
    else:
        C, D, y0 = signal_rows(model, reads, "MPC.reads: state or output")
        if D.any():
            direct = [name for name, row in zip(reads, D) if row.any()]
            raise ValueError(f"MPC.reads {direct} depend on the input at once: read signals that do not")
    estimator = Estimator(kind, A, B, C, dt, time, _sizes(noise, model.input_names, reads))
    H, D, z0 = signal_rows(model, track, "MPC.track: state or output")

    def seen(names: Sequence[str]) -> np.ndarray:
        """The disturbance in signals: that of the reading of the same name."""
        return np.array([estimator.seen[reads.index(n)] if n in reads else 0 * estimator.seen[0] for n in names])

    low, high = limits.low - model.u0, limits.high - model.u0
    target = Target(A, B, estimator.Bd, (H, D, seen(track)), weight, low, high)
    in_bounds = np.zeros((len(limits.bounded), 0))
    if kind == "outputs" and limits.bounded:
        in_bounds = seen(limits.bounded)
    more = {"estimator": estimator, "target": target, "tracked": dict(zip(track, z0.tolist()))}
    return in_bounds, y0, more


def _sizes(noise: float | Mapping[str, float], inputs: tuple[str, ...], reads: tuple[str, ...]) -> Sizes:
    """The standard deviations that MPC's `noise` says: of all readings, or by name of reading and input."""
    named = dict(noise) if isinstance(noise, Mapping) else dict.fromkeys(reads, noise)
    named = require_by_name("MPC.noise", named, (*reads, *inputs), "reading or input", "positive")
    readings = np.array([float(named.get(name, NOISE)) for name in reads])
    drift = readings / NOISE if isinstance(noise, Mapping) else np.ones(len(reads))
    return Sizes(np.array([float(named.get(name, 1.0)) for name in inputs]), readings, drift)
