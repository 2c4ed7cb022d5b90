"""Linear models of a plant: about a point, along any nominal motion, and over an impulse.

Along a motion the nodes may not show what A(t) does: they stand a period apart, or a pulse falls between two. A is
therefore looked at between them too, at a share of 0.38 or 0.62 of each interval in turn (at its middle the sine whose
period is an interval would be missed), from the motion as `Trajectory.resample` has it there. Where it lies beyond the
four nodes about it by more than HIDDEN of their range, nodes are put there and about, until the chords between them
show what is seen: `LTVModel.finer`. What `resample` itself misses is not taken for A: where nodes are shown as well as
that by every third of them, and it is HARMLESS, nothing is hidden.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pliant.plants.core.argument_gates import require_finite, require_instance, require_number
from pliant.plants.core.errors import MassMatrixError
from pliant.plants.core.imports import linalg
from pliant.plants.core.signals import names
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.splines.cubic_spline import CubicSpline

from .arguments import one_state

if TYPE_CHECKING:
    from .plant import Plant

Array = np.ndarray
SHARE = 0.381966  # of an interval, by the golden section; the next one's is taken from its end
LOOKED_AT = 128  # intervals of the first look; all where one of them hides something
HIDDEN, CHORD = 0.25, 0.1  # of the range of the four nodes about: beyond them, and off the chord
NOTHING = 1e-2  # of all that is seen of an entry
FELT = 1e-2  # of the largest in an entry's row or column: what varies by less is not looked for
FAINT = 1e-6  # what varies by less times the span of the model changes no multiplier by as much: rounding, mostly
HARMLESS = 1e-2  # times the span: of a multiplier
MOST_NODES = 8  # times the nodes that were asked for


class Point(NamedTuple):
    """Where a plant is linearised, and what it has there: [A, B, E, C, D, F], dx/dt, y."""

    x: Array
    u: Array
    w: Array
    jacobians: Sequence[Array]
    dx: Array
    y: Array


def at_point(plant: Plant, x0: Any, u0: Any, w: Any, p: Any, t: float) -> Point:
    """ValueError where that is no point."""
    t = require_number("linearize.t", t, unit="s")
    (_, x, u, w, p), batch = plant._arguments(x0, u0, w, p, t)
    x = one_state(plant, x)
    if batch is not None:
        shapes = ", ".join(f"{name} {value.shape}" for name, value in zip("xuwp", (x, u, w, p)))
        raise ValueError(f"{type(plant).__name__}: {shapes} must be one point to linearise, not a batch of {batch}")
    options = {"w": w, "p": p, "t": t}
    dx = plant.dynamics(x, u, **options)  # first: it says where a mass matrix is lost
    return Point(x, u, w, plant.jacobians(x, u, **options), dx, plant.measure(x, u, **options))


def about(plant: Plant, x0: Any, u0: Any, w: Any, p: Any, t: float) -> LinearModel:
    """The model at one point, f0 the rate there."""
    at = at_point(plant, x0, u0, w, p, t)
    A, B, E, C, D, F = at.jacobians
    return LinearModel(
        *(A, B, E, C, D, F),
        states=plant.states,
        inputs=plant.inputs,
        disturbances=plant.disturbances,
        outputs=plant.outputs,
        x0=at.x,
        u0=at.u,
        w0=at.w,
        y0=at.y,
        f0=at.dx,
    )


def check_signals(plant: Plant, nominal: Trajectory) -> None:
    """ValueError where a nominal is not given in the plant's states and inputs."""
    require_instance("nominal", nominal, Trajectory)
    for name, have, want in (
        ("states", nominal.states, plant.states),
        ("inputs", nominal.inputs, plant.inputs),
    ):
        if names(have) != names(want):
            raise ValueError(f"nominal.{name} = {names(have)} must be {names(want)}")


def along(plant: Plant, nominal: Trajectory, p: Any) -> LTVModel:
    """The model along a nominal, c its residual f(x, u) - dx/dt."""
    check_signals(plant, nominal)
    made = _at_nodes(plant, nominal, p)
    return replace(
        made,
        between=partial(finer, partial(_at_nodes, plant), nominal, p),
        missed=partial(missed, plant, p, made.t, made.A[:: max(1, len(made.t) - 1)]),
    )


def missed(
    plant: Plant, p: Any, t: Array, ends: Array, model: LTVModel, dx: Array, du: Array, dw: Array
) -> tuple[Array, Array] | None:
    """What f (nt, nx) and h (nt, ny) have at deviations dx, du, dw (nt, ..) from the model's nominal beyond what is
    linear in them; None where the model is no longer the one that was made: of other nodes t, of another A at the ends.
    """
    same = len(model.t) == len(t) and bool((model.t == t).all()) and names(model.states) == names(plant.states)
    if not same or not np.array_equal(model.A[:: max(1, len(t) - 1)], ends):
        return None
    assert model.w is not None

    def at(x: Array, u: Array, w: Array) -> tuple[Array, Array]:
        return plant.dynamics(x, u, w=w, p=p, t=t), plant.measure(x, u, w=w, p=p, t=t)

    still, moved = at(model.x, model.u, model.w), at(model.x + dx, model.u + du, model.w + dw)
    linear = [
        sum(np.einsum("kij,kj->ki", M, v) for M, v in zip(Ms, (dx, du, dw)))
        for Ms in ((model.A, model.B, model.E), (model.C, model.D, model.F))
    ]
    return moved[0] - still[0] - linear[0], moved[1] - still[1] - linear[1]


def _at_nodes(plant: Plant, nominal: Trajectory, p: Any) -> LTVModel:
    w = nominal.w if nominal.w is not None else np.zeros((len(nominal.t), plant.nw))
    rate = plant.dynamics(nominal.x, nominal.u, w=w, p=p, t=nominal.t)
    A, B, E, C, D, F = plant._jacobians_along(nominal, w, p)
    return LTVModel(
        *(nominal.t, A, B, E, C, D, F),
        c=rate - nominal.derivative(),
        x=nominal.x,
        u=nominal.u,
        w=w,
        y=plant.measure(nominal.x, nominal.u, w=w, p=p, t=nominal.t),
        states=plant.states,
        inputs=plant.inputs,
        disturbances=plant.disturbances,
        outputs=plant.outputs,
    )


def finer(made: Callable[[Trajectory, Any], LTVModel], nominal: Trajectory, p: Any, model: LTVModel) -> LTVModel | None:
    """That which made(motion, p) is with nodes between those of the model, where these hide what A does; else None.

    None as well where the plant has no model between them (MassMatrixError): such nodes are no motion of it there; and
    where the model is not of this motion, but at times beyond it or of other states.
    """
    if len(model.t) < 3 or model.t[0] < nominal.t[0] or model.t[-1] > nominal.t[-1]:
        return None
    nominal = _whole_turns(nominal)
    try:
        t = _finer_times(made, model, nominal, p)
        return made(*_at(nominal, p, t)) if len(t) > len(model.t) else None
    except MassMatrixError:
        return None


def _finer_times(made: Callable[[Trajectory, Any], LTVModel], model: LTVModel, nominal: Trajectory, p: Any) -> Array:
    """The nodes of the model, and those between them at which the chords of A show what is seen."""
    t, A, span = model.t, model.A, float(model.t[-1] - model.t[0])
    for every in sorted({max(1, (len(t) - 1) // LOOKED_AT), 1}, reverse=True):
        k = np.arange(len(t) - 1)[::every]
        seen = made(*_at(nominal, p, _between(t)[k])).A
        if seen.shape[1:] != A.shape[1:]:
            return t
        hidden = _hidden(A, seen, k, span, beyond=True)
        if hidden.any() and len(t) > 6:
            hidden = _hidden(A, seen, k, span, beyond=True, missed=_missed(made, model, nominal, p))
        if not hidden.any():
            return t
    while hidden.any() and len(t) < MOST_NODES * len(model.t):
        new = k[hidden] + 1
        t, A = np.insert(t, new, _between(t)[k[hidden]]), np.insert(A, new, seen[hidden], axis=0)
        fresh = new + np.arange(len(new))  # nodes; the intervals beside them, and those beside these, are looked at
        k = np.unique(np.clip(fresh[:, None] + np.arange(-2, 2), 0, len(t) - 2))  # two at least
        seen = made(*_at(nominal, p, _between(t)[k])).A
        hidden = _hidden(A, seen, k, span, beyond=False)
    return t


def _between(t: Array) -> Array:
    """A time within each interval of t (nt,)."""
    share = np.where(np.arange(len(t) - 1) % 2 == 0, SHARE, 1 - SHARE)
    return t[:-1] + share * np.diff(t)


def _at(nominal: Trajectory, p: Any, times: Array) -> tuple[Trajectory, Any]:
    """The motion at other times and the parameters there."""

    found = nominal.resample(times)
    if found.dx is None:  # of the whole motion, not of a few times of it
        found = replace(found, dx=CubicSpline(nominal.t, nominal.x)(times, 1))
    if p is not None and np.ndim(p) == 2:
        p = np.array([np.interp(times, nominal.t, column) for column in np.asarray(p, dtype=float).T]).T
    return found, p


def _whole_turns(nominal: Trajectory) -> Trajectory:
    """The motion with angles that go on where they were set back by whole turns, as their rates tell."""
    if nominal.dx is None:
        return nominal
    x, turn = nominal.x.copy(), 2 * np.pi
    steps, told = np.diff(x, axis=0), np.diff(nominal.t)[:, None] * (nominal.dx[1:] + nominal.dx[:-1]) / 2
    turns = np.round((steps - told) / turn)
    angle = np.array([s.unit == "rad" for s in nominal.states])
    back = np.where(angle & (np.abs(steps) > np.pi) & (np.abs(steps - told - turn * turns) < 1), turns, 0.0)
    x[1:] -= turn * np.cumsum(back, axis=0)
    return replace(nominal, x=x) if back.any() else nominal


def _missed(made: Callable[[Trajectory, Any], LTVModel], model: LTVModel, nominal: Trajectory, p: Any) -> Array:
    """What A (nt, n, n) differs by at nodes between every third of them from what `resample` makes of these."""
    motion, q = _at(nominal, p, model.t)
    kept = np.union1d(np.arange(0, len(model.t), 3), len(model.t) - 1)
    left = np.setdiff1d(np.arange(len(model.t)), kept)
    rows = {name: v[kept] for name in ("t", "x", "u", "y", "dx", "w") if (v := getattr(motion, name)) is not None}
    few = q[kept] if q is not None and np.ndim(q) == 2 else q
    off = np.zeros_like(model.A)
    off[left] = np.abs(made(*_at(replace(motion, **rows), few, model.t[left])).A - model.A[left])
    return off


def _hidden(A: Array, seen: Array, k: Array, span: float, *, beyond: bool, missed: Array | None = None) -> Array:
    """Of which intervals k (m,) between nodes the values A (nt, n, n) there do not show what is seen (m, n, n).

    `beyond`: it is beyond what the four nodes about it hold; else off the chord between two nodes. `missed` (nt, n, n):
    what may be seen of it for want of a better motion between the nodes.
    """
    about = A[np.clip(k[:, None] + np.arange(-1, 3), 0, len(A) - 1)]  # (m, 4, n, n)
    low, high = about.min(axis=1), about.max(axis=1)
    share = np.where(k % 2 == 0, SHARE, 1 - SHARE)[:, None, None]
    chord = (1 - share) * A[k] + share * A[k + 1]
    miss = np.maximum(seen - high, low - seen) if beyond else np.abs(seen - chord)
    least, largest = np.minimum(A.min(axis=0), seen.min(axis=0)), np.maximum(A.max(axis=0), seen.max(axis=0))
    size = np.maximum(np.abs(largest), np.abs(least))
    _, (scale, _) = linalg.matrix_balance(size, permute=False, separate=True)  # units do not count
    beside = size * scale / scale[:, None]
    felt = np.maximum(FELT * np.minimum(beside.max(axis=0), beside.max(axis=1)[:, None]), FAINT / span)
    varies = largest - least > felt * scale[:, None] / scale
    if missed is not None:
        off = missed[np.clip(k[:, None] + np.arange(-1, 3), 0, len(A) - 1)].max(axis=1)  # one at least is told
        varies = varies & ((miss > off) | (off * span > HARMLESS * scale[:, None] / scale))
    return ((miss > (HIDDEN if beyond else CHORD) * (high - low) + NOTHING * (largest - least)) & varies).any(
        axis=(1, 2)
    )


def over_impulse(plant: Plant, x: Array, after: Array, P: Array, p: Any, t: float) -> tuple[Array, Array]:
    """(J (nx, nx), j (nx,)) of dx+ = J dx- + j, where a nominal goes from x (nx,) to `after` (nx,) in an impulse P
    (nu,) [input units times s].
    """
    x, after = (require_finite(f"jump_map.{name}", value, (plant.nx,)) for name, value in (("x", x), ("after", after)))
    P, t = require_finite("jump_map.P", P, (plant.nu,)), require_number("jump_map.t", t, unit="s")
    still = np.zeros(plant.nu)
    moved = plant.dynamics(x, P, p=p, t=t) - plant.dynamics(x, still, p=p, t=t)
    J = np.eye(plant.nx) + plant.jacobians(x, P, p=p, t=t)[0] - plant.jacobians(x, still, p=p, t=t)[0]
    return J, moved - (after - x)
