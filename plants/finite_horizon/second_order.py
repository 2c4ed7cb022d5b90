"""What a linear model leaves out of a motion that a disturbance pushes off its nominal: an estimate to second order.

Along the deviation dx(t) that the model has under w(t), its plant's own equations have, beyond A dx + E w, a remainder

    r(t) = f(x + dx, u, w) - f(x, u, 0) - A dx - E w,

which drives a deviation of its own, d(e)/dt = A e + r, and changes outputs by C e and their own remainder. It falls
with the square of the disturbance. Where it is no longer small beside what was predicted, no number of the model is one
of the plant. Higher orders, and what the larger deviation changes in turn, are not in it. Of a model whose plant is not
known the angles say as much: what a turn by a moves sideways it moves by a^2/2 along.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import Signal, names
from pliant.plants.linear.ltv import LTVModel

from .asked import listed, said
from .energy_gain import Gain

Array = np.ndarray
TRUSTED = 0.1  # of a prediction, up to which what is left out is not told
TURNED = 0.3  # [rad] by which an angle may be off its nominal, where nothing else is known: 15 % of what it moves


def pushed(model: LTVModel, t: Array, signals: Sequence[Signal], w: Array) -> tuple[Array, Array, Array]:
    """dx (nt, nx), du (nt, nu), dw (nt, nw) at the model's nodes from rest, where w (m, k) of these disturbances or
    inputs is held from each of the times t (m,) [s] on; its mean from node to node.
    """
    whole = np.concatenate([np.zeros((1, w.shape[1])), np.cumsum(w[:-1] * np.diff(t)[:, None], axis=0)])
    sums = np.stack([np.interp(model.t, t, column) for column in whole.T], axis=1)
    mean = np.diff(sums, axis=0) / np.diff(model.t)[:, None]
    known = dict(zip(signals, np.vstack([mean, w[-1:]]).T))
    none = np.zeros(len(model.t))
    du, dw = (
        np.array([known.get(s, none) for s in of]).reshape(len(of), len(none)).T
        for of in (model.inputs, model.disturbances)
    )
    steps, dx = model.discretize(), np.zeros(model.x.shape)
    push = np.einsum("kij,kj->ki", steps.B, du[:-1]) + np.einsum("kij,kj->ki", steps.E, dw[:-1])
    for k in range(len(push)):
        dx[k + 1] = steps.A[k] @ dx[k] + push[k]
    return dx, du, dw


def left_out(model: LTVModel, deviations: tuple[Array, Array, Array], at: Array) -> Array | None:
    """(nz,) the largest second-order change over the motion of the entries `at` of [x; y], under what `pushed` found;
    infinite where the plant has no such state. None: what the model is of is not known.
    """
    if model.missed is None:
        return None
    try:
        found = model.missed(model, *deviations)
    except (PliantError, ValueError):
        return np.full(len(at), np.inf)
    if found is None:
        return None
    (r, direct), steps, e = found, model.discretize(), np.zeros(model.x.shape)
    h = np.diff(model.t)[:, None] / 2
    for k in range(len(h)):
        e[k + 1] = steps.A[k] @ (e[k] + h[k] * r[k]) + h[k] * r[k + 1]
    y = np.einsum("kij,kj->ki", model.C, e) + direct
    most = np.abs(np.concatenate([e, y], axis=1)[:, at]).max(axis=0)
    return np.where(np.isfinite(most), most, np.inf)


def turned(model: LTVModel, dx: Array) -> tuple[str, float]:
    """The angle among the states that is off its nominal most, and by how much [rad]; ("", 0) where there is none."""
    angles = {s.name: float(np.abs(dx[:, k]).max()) for k, s in enumerate(model.states) if s.unit == "rad"}
    return max(angles.items(), key=lambda one: one[1], default=("", 0.0))


def beyond_linear(
    model: LTVModel, t: Array, signals: Sequence[Signal], output: Signal, pushes: Mapping[str, Gain]
) -> tuple[dict[str, float] | None, str]:
    """What is left out of the output by the name of each push that has a bound, None where the plant is not known; and
    which of these numbers the linear model has no right to, in words, "" where none.
    """
    at = np.array([names((*model.states, *model.outputs)).index(output.name)])
    known = {kind: push for kind, push in pushes.items() if np.isfinite(push.upper)}
    left: dict[str, float] = {}
    far: dict[str, str] = {}
    for kind, push in known.items():
        off = pushed(model, t, signals, push.disturbance)
        found = left_out(model, off, at)
        if found is None:
            name, angle = turned(model, off[0])
            if angle > TURNED:
                far[kind] = f"{name} turns by {angle:.2g} rad"
            continue
        left[kind] = most = float(found[0])
        if most > TRUSTED * push.upper:
            far[kind] = f"about {said(most, output.unit)}" if np.isfinite(most) else "more than can be told"
    if not far:
        return left or None, ""
    which = ["it"] if len(known) == 1 else ["the first", "the last"]
    why = listed(list(far.values()))
    why = f"what it leaves out is, to second order, {why}" if left else f"in it {why}"
    lie = "both lie" if len(far) == 2 else f"{which[list(known).index(next(iter(far)))]} lies"
    return left or None, f" ({lie} beyond where the linear model can be trusted: {why})"
