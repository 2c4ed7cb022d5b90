"""Growth of deviations along any nominal, periodic or not, with jumps or without: what the transition matrix says.

Growth curve   largest singular value of Phi(t, t0): the most that a deviation can have grown by t
Windows        the same of Phi(t + window, t)
Exponents      finite-time Lyapunov exponents ln|R_ii|/(t - t0), Phi factored by QR along the way (Benettin 1980)

Sizes are those of z = x / scale, with powers of two from the mean of |A| unless given: in a norm that mixes metres and
rad/s everything seems to grow. Exponents over a long time do not depend on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_number
from pliant.plants.core.imports import linalg
from pliant.plants.core.parameters import require_count, require_finite
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear import magnus
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.rigorous.enclosed_growth import REPEATED, builds_up
from pliant.plants.transitions.state_matrix_path import MOST_STEPS, Model, Path, as_pieces, kept, scaling
from pliant.plants.transitions.transition_error import Transition

from .frozen_time import lasting

BLOCKS = 48  # stretches of the nominal between which growth is compared
OFF = 1e-8  # Phi's own error
MOST_NODES, FEW_STOPS = 501, 200
ACROSS = 1.0  # |eigenvalue| times step up to which one step serves


@dataclass(frozen=True, eq=False)
class Growth(OwnsArrays):
    """Rows belong to the times t (nt,) [s]."""

    t: np.ndarray = field(repr=False)
    logs: np.ndarray = field(repr=False)  # (nt,) ln of the largest growth since t[0]
    window: float  # [s]
    window_start: np.ndarray = field(repr=False)  # (nw,) [s]
    windows: np.ndarray = field(repr=False)  # (nw,) largest growth within each window
    exponents: np.ndarray  # (nx,) [1/s] finite-time Lyapunov exponents, largest first
    history: np.ndarray = field(repr=False)  # (nt, nx) [1/s] the same up to each time, in the order of the columns
    direction: np.ndarray = field(repr=False)  # (nx,) the deviation at t[0] that grows most until t[-1]
    scale: np.ndarray = field(repr=False)  # (nx,) sizes are those of x / scale
    critical_times: tuple[float, ...]  # [s] starts of windows between which deviations begin or cease to grow
    compounds: bool  # whether the growth builds on itself, as e^(at) does and a power of time does not

    @property
    def curve(self) -> np.ndarray:
        """Largest growth (nt,) since t[0], 1 at the start; infinite beyond the range of numbers."""
        with np.errstate(over="ignore"):
            return np.exp(self.logs)

    @property
    def total(self) -> float:
        """Largest growth over the whole nominal."""
        return float(self.curve[-1])

    @property
    def rate(self) -> float:
        """ln(total) / duration [1/s]."""
        return float(self.logs[-1] / (self.t[-1] - self.t[0]))


def growth(
    model: Model | LinearModel,
    window: float | None = None,
    *,
    states: Sequence[str] | None = None,
    scale: Any = None,
    points: int | None = None,
    duration: float | None = None,
) -> Growth:
    """Growth over the nominal and over windows of `window` [s] (None: a tenth of it) beginning at each time.

    `points` limits the times at which it is found (None: every node); the steps are the nodes all the same. `scale`
    (nx,): sizes that count alike. `duration` [s]: of a LinearModel, which has no nominal of its own.
    """
    t, Phi, size = chain(_timed(model, duration), states, scale)
    if points is not None:
        points = require_count("growth", "points", points, 2, 1_000_000)
        every = -(-(len(t) - 1) // points)
        edges = np.unique(np.r_[np.arange(0, len(t) - 1, every), len(t) - 1])
        t, Phi = t[edges], magnus.grouped(Phi, edges)
    return grown(t, Phi, size, window)


def grown(t: np.ndarray, Phi: np.ndarray, size: np.ndarray, window: float | None) -> Growth:
    """The same from transitions Phi (nt-1, n, n) between the times t (nt,), in z = x / size (n,)."""
    n = Phi.shape[-1]
    total, Q, power = np.eye(n), np.eye(n), 0.0
    so_far, powers, logs = np.empty((len(t), n, n)), np.zeros(len(t)), np.zeros((len(t), n))
    so_far[0], diagonal = total, np.empty((len(Phi), n))
    for k, step in enumerate(Phi):
        total = step @ total
        size_now = float(np.abs(total).max())
        if size_now > 1e100 or 0 < size_now < 1e-100:  # kept within range; the power is added back below
            total, power = total / size_now, power + np.log(size_now)
        so_far[k + 1], powers[k + 1] = total, power
        Q, diagonal[k] = _factored(step @ Q)
    with np.errstate(divide="ignore"):
        np.cumsum(np.log(np.abs(diagonal)), axis=0, out=logs[1:])
    history = np.zeros_like(logs)
    history[1:] = logs[1:] / (t[1:] - t[0])[:, None]
    start, within, length = _windows(t, Phi, window)
    _, _, right = np.linalg.svd(so_far[-1])
    return Growth(
        t,
        np.log(np.maximum(magnus.largest_growths(so_far), 1e-300)) + powers,
        length,
        start,
        within,
        np.sort(history[-1])[::-1],
        history,
        right[0] * size,
        size,
        _crossings(start, within, length),
        compounds(t, Phi),
    )


def _factored(M: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Q (n, n) and the diagonal of R of M = Q R: numpy's own asks the same of LAPACK, with four times the work beside
    it where n is small."""
    if not len(M):
        return M, np.zeros(0)
    packed, tau, _, _ = linalg.lapack.dgeqrf(M)
    return linalg.lapack.dorgqr(packed, tau)[0], np.diagonal(packed)


def growth_between(joined: Any, moved: Transition | None, window: float | None, states: Sequence[str] | None) -> Growth:
    """Growth between the nodes, MOST_NODES of them, of the transition's own steps where these stop at every node, or of
    a large model at many of them."""
    nodes = np.concatenate([joined.pieces[0].t[:1], *(piece.t[1:] for piece in joined.pieces)])
    nodes = nodes[np.unique(np.linspace(0, len(nodes) - 1, min(len(nodes), MOST_NODES)).astype(int))]
    if moved is not None:
        if FEW_STOPS < len(moved.times) < len(nodes):  # they are nodes too
            nodes = moved.times
        at = np.searchsorted(moved.times, nodes)
        if at[-1] < len(moved.times) and (moved.times[at] == nodes).all() and np.isfinite(moved.Phi).all():
            keep = kept(joined, states)
            size = scaling(np.concatenate([piece.A[:, keep][:, :, keep] for piece in joined.pieces]))
            return grown(nodes, magnus.grouped(moved.Phi, at), size, window)
    return growth(joined, window, states=states, points=MOST_NODES)


def compounds(t: np.ndarray, Phi: np.ndarray) -> bool:
    """Whether the growth up to the end compounds, from transitions Phi (m, n, n) between the times t (m + 1,) [s].

    t^p grows 2^p-fold when its time doubles, whatever the time; e^(at) by e^(at/2), the more the longer. So, over some
    stretch up to the end: the whole must be DOUBLED times any half of it, and that SQUARED times what a half is to any
    quarter (1 + t^p: at most 1.6 times for p = 2). A drift that starts late is as large over its last half as over all.
    A long chain of integrators passes for a while: so some stretch must also grow where it is repeated, which no power
    of time does.
    """
    m, n = len(Phi), Phi.shape[-1]
    count = min(m, BLOCKS if n <= 40 else BLOCKS // 2)
    if count < 4 or not n:
        return False
    edges = np.unique(np.r_[0, np.searchsorted(t, np.linspace(t[0], t[-1], count + 1)[1:-1]), m])
    blocks, at = magnus.grouped(Phi, edges), t[edges]
    count = len(blocks)
    logs, to_end = np.full((count + 1, count + 1), -np.inf), []  # ln |Phi| from block a to block b
    for length, products, power in magnus.consecutive(blocks):
        start = np.arange(len(products))
        with np.errstate(divide="ignore"):
            logs[start, start + length] = np.log(magnus.largest_growths(products)) + power
        to_end.append((products[-1], power[-1]))
    return builds_up(at, logs, logs) and any(_repeated(product, power) for product, power in reversed(to_end))


def _repeated(product: np.ndarray, power: float) -> bool:
    """Whether e^power times a product (n, n) has an |eigenvalue| beyond REPEATED, and what an n-fold one may be off."""
    size, most = (np.log(max(float(x), 1e-300)) for x in (max(abs(np.linalg.eigvals(product))), np.abs(product).max()))
    off = (power + most + np.log(OFF)) / len(product)
    return bool(power + size > np.log(REPEATED) + np.logaddexp(0.0, np.log(4.0) + off))


def _timed(model: Any, duration: float | None) -> Any:
    if not isinstance(model, LinearModel):
        if duration is not None:
            raise ValueError(f"growth.duration = {duration:g} s: the nominal has its own, must be None")
        return model
    if model.dt is not None or duration is None or not 0 < duration < np.inf:
        raise ValueError(f"growth.duration = {duration!r} must be > 0 [s] for a LinearModel, and its dt None")
    t = np.linspace(0.0, float(duration), 201)
    empty = {k: np.zeros((201, len(getattr(model, s)))) for k, s in zip("xuy", ("states", "inputs", "outputs"))}
    still = {k: np.broadcast_to(getattr(model, k), (201, *getattr(model, k).shape)) for k in "ABECDF"}
    signals = {k: getattr(model, k) for k in ("states", "inputs", "disturbances", "outputs")}
    parts: dict[str, Any] = {**still, **empty, **signals}
    return LTVModel(t, c=empty["x"], **parts)


def chain(
    model: Model, states: Sequence[str] | None = None, scale: Any = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Node times (nt,), transitions between them (nt-1, n, n) in z = x / scale, scale (n,).

    A jump belongs to the interval after it.
    """
    joined, keep = as_pieces(model), kept(model, states)
    matrices = [m.A[:, keep][:, :, keep] for m in joined.pieces]
    size = scaling(np.concatenate(matrices)) if scale is None else require_finite("growth.scale", scale, (len(keep),))
    if not (size > 0).all():
        raise ValueError(f"growth.scale = {size} must be > 0")
    times, found = [joined.pieces[0].t[:1]], []
    for k, (piece, A) in enumerate(zip(joined.pieces, matrices)):
        path = Path(piece.t, A, size)
        parts = max(1, int(np.ceil(path.fastest() * np.diff(piece.t).max() / ACROSS)))
        if parts * (len(piece.t) - 1) > MOST_STEPS:
            raise ValueError(
                f"growth: modes of up to {path.fastest():.4g} 1/s need {parts} steps in each of {len(piece.t) - 1} "
                f"intervals, more than {MOST_STEPS:,}: leave out the fastest modes"
            )
        Phi = path.between(piece.t, parts)
        if k:
            J = joined.jumps[k - 1][0][np.ix_(keep, keep)] * size / size[:, None]
            Phi = np.concatenate([Phi[:1] @ J, Phi[1:]])
        times.append(piece.t[1:])
        found.append(Phi)
    return np.concatenate(times), np.concatenate(found), size


def _windows(t: np.ndarray, Phi: np.ndarray, window: float | None) -> tuple[np.ndarray, np.ndarray, float]:
    """Starts (nw,), growth within each window (nw,), and its length [s]: whole intervals, equal in number.

    Where the nodes are uneven the windows are too, and the length is their mean.
    """
    span = float(t[-1] - t[0])
    length = span / 10 if window is None else require_number("growth.window", window, unit="s")
    if not 0 < length <= span * (1 + 1e-9):
        raise ValueError(f"growth.window = {length:.6g} must be > 0 and at most {span:.6g} s")
    m, n = len(Phi), Phi.shape[-1]
    count = min(m, max(1, round(length / span * m)))
    blocks = -(-m // count)
    padded = np.concatenate([Phi, np.broadcast_to(np.eye(n), (blocks * count - m, n, n))])
    padded = padded.reshape(blocks, count, n, n)
    rest, rest_power = _cumulated(padded[:, ::-1], last=False)  # from within a block to its end, and ..
    head, head_power = _cumulated(padded, last=True)  # .. from the start of a block
    head = np.concatenate([np.broadcast_to(np.eye(n), (blocks, 1, n, n)), head[:, :-1]], axis=1)
    head_power = np.concatenate([np.zeros((blocks, 1)), head_power[:, :-1]], axis=1)
    rest, rest_power = (v[:, ::-1].reshape(blocks * count, *v.shape[2:]) for v in (rest, rest_power))
    head, head_power = (v.reshape(blocks * count, *v.shape[2:])[count:] for v in (head, head_power))
    starts = m - count + 1
    within = rest[:starts]  # a window that starts with a block is that block
    power = rest_power[:starts].copy()
    later = min(starts, len(head))
    within = np.concatenate([head[:later] @ within[:later], within[later:]])
    power[:later] += head_power[:later]
    with np.errstate(over="ignore"):
        sizes = magnus.largest_growths(within) * np.exp(power)
    return t[:starts], sizes, count * span / m


def _cumulated(Phi: np.ndarray, *, last: bool) -> tuple[np.ndarray, np.ndarray]:
    """Products of the first 1, 2 .. of each row of Phi (k, m, n, n), later ones on the left where `last`, else on the
    right; kept within range by factors whose logarithms are given beside (k, m).
    """
    found, power = np.empty(Phi.shape), np.zeros(Phi.shape[:2])
    found[:, 0] = Phi[:, 0]
    for k in range(1, Phi.shape[1]):
        step = Phi[:, k] @ found[:, k - 1] if last else found[:, k - 1] @ Phi[:, k]
        if k % 16 == 0:
            size = np.maximum(np.abs(step).max(axis=(1, 2)), 1e-300)
            step, power[:, k] = step / size[:, None, None], power[:, k - 1] + np.log(size)
        else:
            power[:, k] = power[:, k - 1]
        found[:, k] = step
    return found, power


def _crossings(t: np.ndarray, size: np.ndarray, window: float) -> tuple[float, ...]:
    """Times [s] at which ln(size) changes sign, interpolated; what is about 1 for rounding or briefly is none."""
    logs = np.log(np.maximum(size, 1e-300))
    above = lasting(logs > 1e-9, np.abs(logs) * (np.gradient(t) / window if len(t) > 1 else 1.0), t)
    at = np.flatnonzero(above[1:] != above[:-1])
    return tuple(float(t[k] - logs[k] * (t[k + 1] - t[k]) / (logs[k + 1] - logs[k])) for k in at)
