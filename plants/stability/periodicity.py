"""Whether A(t) is periodic, and with which period: what Floquet's theory must know before it may speak."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import LEAST, require_seconds
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.linear.piecewise_ltv import PiecewiseLTV
from pliant.plants.splines.cubic_spline import CubicSpline
from pliant.plants.transitions.state_matrix_path import CLOSES, Path, scaling

ONE_SIDED = np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0  # first derivative at the first of five nodes
TURNS = 2e-2  # of the largest |dA/dt|: how near its rate must come back


def varying(model: LTVModel) -> tuple[np.ndarray, float]:
    """The entries of A(t) that vary, (nt, m), and their largest range.

    In scaled coordinates, where a slow motion's entries are not lost beside a fast one's squared frequency.
    """
    scale = scaling(model.A)
    flat = (model.A * scale / scale[:, None]).reshape(len(model.t), -1)
    spread = np.ptp(flat, axis=0)
    moving = spread > 1e-12 * np.abs(flat).max(initial=1e-300)
    return flat[:, moving], float(spread.max(initial=0.0))


def why_not(model: LTVModel, period: float) -> str:
    """Why A(t) does not have this period [s] as far as the model reaches; "" where it has."""
    return _tried(model, period)[1]


def _tried(model: LTVModel, period: float) -> tuple[Path | None, str]:
    """A(t) over the first period [s], and `why_not`."""
    span = float(model.t[-1] - model.t[0])
    if period > span * (1 + 1e-9):
        return None, f"the model covers {span:.6g} s, less than the period {period:.6g} s"
    return one_period(model.t, model.A, period, model.state_names, found=True)


def one_period(
    t: np.ndarray,
    A: np.ndarray,
    period: float,
    names: Sequence[str],
    *,
    found: bool = False,
    rounding: np.ndarray | None = None,
) -> tuple[Path, str]:
    """A(t) over the first period [s], and why the nodes of later ones do not agree with it, "" where they do.

    Compared at every shift, entry by entry, with A between the nodes of the first; what differs by less than CLOSES of
    an entry's range, or by less than the nodes of the first leave open, is counted as an error of A there. A period
    that is `found` is not believed where much is open. `rounding` (n, n) [1/s]: what A may be off at all times.
    """
    begin, span = t[0], float(t[-1] - t[0])
    inner = t < begin + period * (1 - 1e-9)
    first, values = t[inner], A[inner]
    if len(first) > 2 and begin + period - first[-1] < 1e-3 * period / len(first):
        first, values = first[:-1], values[:-1]
    later = t >= begin + period * (1 - 1e-9)
    k = int(np.argmax(later))
    ends = later.any() and abs(t[k] - begin - period) <= 1e-9 * period
    last = A[k] if ends else values[0]
    scale, spread = scaling(A), np.ptp(A, axis=0)
    moving = spread > 1e-14 * np.abs(A).max(axis=0)
    nodes = np.append(first, begin + period)
    path = Path(nodes, np.concatenate([values, last[None]]), scale, periodic=True, moving=moving)
    if rounding is not None:
        path.rounding = rounding * scale / scale[:, None]
    if path.constant:
        return path, ""
    at = (slice(None), path.rows, path.columns)
    ratio = scale[path.columns] / scale[path.rows]
    spread = spread[at[1:]] * ratio
    open_ = 2 * np.maximum(path.values.most, path.values.beside())
    if found:
        open_ = np.minimum(open_, 0.02 * spread)
    if period > span * (1 - 1e-9):
        open_ = np.zeros_like(open_)  # nothing but the seam is there to see
    allowed = CLOSES * spread + 64 * np.finfo(float).eps * np.abs(path.values.f).max(axis=0)
    allowed = allowed + path.rounding[path.rows, path.columns]
    worst = np.zeros_like(path.values.most)
    times = t[later]
    for j in range(0, len(times), 256):
        turns = np.floor((times[j : j + 256] - begin) / period * (1 + 1e-15) + 1e-9)
        local = np.clip(times[j : j + 256] - turns * period, begin, begin + period)
        k = np.clip(np.searchsorted(path.t, local, side="right") - 1, 0, len(path.t) - 2)
        miss = np.abs(A[len(t) - len(times) + j :][:256][at] * ratio - path.values(local))
        over = miss - allowed - open_[k]
        if (over > 0).any():
            row, column = np.unravel_index(int((miss / spread * (over > 0)).argmax()), miss.shape)
            share = miss[row, column] / spread[column]
            entry = f"({names[path.rows[column]]}, {names[path.columns[column]]})"
            count = int(turns[row])
            where = f"; largest in {entry} after {count} period{'s' if count > 1 else ''}"
            return path, f"A(t + T) differs from A(t) by {share:.2g} of its range for T = {period:.6g} s{where}"
        np.maximum.at(worst, k, np.where(miss > path.values.most[k], miss, 0.0))
    path.values.add(slice(None), worst)
    return path, ""


def require_period(period: float) -> float:
    """[s], > 0."""
    return require_seconds("floquet.period", period, LEAST)


def pieced(joined: PiecewiseLTV, period: float, keep: list[int]) -> tuple[list[Path], list[np.ndarray], float, str]:
    """The first period of a nominal in pieces; the later ones must be like it, their jumps too."""
    begin, end = joined.pieces[0].t[0], joined.pieces[-1].t[-1]
    turns = round((end - begin) / period)
    if turns < 1 or abs(turns * period - (end - begin)) > 1e-9 * (end - begin):
        raise ValueError(f"floquet.period = {period:.6g} s: the pieces cover {end - begin:.6g} s, no whole number")
    stops = np.array([piece.t[-1] for piece in joined.pieces])
    count = int(np.argmin(np.abs(stops - begin - period))) + 1
    if abs(stops[count - 1] - begin - period) > 1e-9 * (end - begin) or count * turns != len(joined.pieces):
        raise ValueError(f"floquet.period = {period:.6g} s: a period must begin where a piece does")
    A = [piece.A[:, keep][:, :, keep] for piece in joined.pieces]
    scale = scaling(np.concatenate(A[:count]))
    paths = [Path(p.t, a, scale) for p, a in zip(joined.pieces[:count], A[:count])]
    square = np.ix_(keep, keep)
    jumps = [J[square] * scale / scale[:, None] for J, _ in joined.jumps]
    size = max(path.size for path in paths)
    for k in range(count, len(A)):
        first, shift = paths[k % count], (k // count) * period
        local = np.clip(joined.pieces[k].t - shift, first.t[0], first.t[-1])
        miss = float(np.abs(A[k] * scale / scale[:, None] - first(local)).max()) if len(A[k]) else 0.0
        slack = abs(joined.pieces[k].t[0] - shift - first.t[0]) + abs(joined.pieces[k].t[-1] - shift - first.t[-1])
        if miss > 1e-9 * size or slack > 1e-9 * period or np.abs(jumps[k - 1] - jumps[(k - 1) % count]).max() > 1e-9:
            raise ValueError(f"floquet.period = {period:.6g} s: piece {k} differs from piece {k % count}")
    if turns > 1:  # the jump between two periods is known; of a single one its end is its start
        paths.append(Path(paths[-1].t[-1] + np.array([0.0, 0.0]), np.zeros((2, len(scale), len(scale))), scale))
        return paths, jumps[:count], period, f"given, {turns} periods of {count} pieces"
    return paths, jumps, period, f"given, {count} pieces"


def find(model: LTVModel) -> tuple[float | None, str, Path | None]:
    """The period [s] and where it comes from, or None and why there is none; A(t) over it, where A(t) varies.

    Either A(t) repeats itself at least once within the model, or the whole model closes: A, its rate and the nominal
    state come back (angles up to whole turns, quaternions up to their sign).
    """
    flat, _ = varying(model)
    span = float(model.t[-1] - model.t[0])
    if not flat.shape[1]:
        return span, "A is constant", None
    repeated, path = _repeats(model, flat)
    if repeated is not None:
        return repeated, f"A(t) repeats every {repeated:.6g} s", path
    path, reason = _tried(model, span)
    reason = reason or _why_not_smooth(model, flat) or _why_not_closed(model)
    if reason:
        return None, reason, None
    return span, f"the nominal closes after {span:.6g} s and is taken as one period", path


def _uniform(t: np.ndarray) -> bool:
    h = np.diff(t)
    return bool(h.max() - h.min() <= 1e-7 * h[0])


def _why_not_smooth(model: LTVModel, flat: np.ndarray) -> str:
    t, few = model.t, min(12, len(model.t))
    if len(t) >= 5 and _uniform(t):
        begin, end = ONE_SIDED @ flat[:5] / (t[1] - t[0]), -ONE_SIDED @ flat[:-6:-1] / (t[1] - t[0])
    else:
        begin, end = CubicSpline(t[:few], flat[:few])(t[0], 1), CubicSpline(t[-few:], flat[-few:])(t[-1], 1)
    largest = np.abs(np.diff(flat, axis=0) / np.diff(t)[:, None]).max()
    miss = float(np.abs(end - begin).max() / largest)
    return f"dA/dt at the end differs from that at the start by {miss:.2g} of its largest" if miss > TURNS else ""


def _why_not_closed(model: LTVModel) -> str:
    for signal, x in zip(model.states, model.x.T):
        miss = abs(x[-1] - x[0])
        if signal.unit == "rad":
            miss = abs(miss - 2 * np.pi * round(miss / (2 * np.pi)))
        elif signal.unit in ("", "-"):
            miss = min(miss, abs(x[-1] + x[0]))
        if miss > 1e-4 * np.ptp(x) + 1e-9:
            return f"the nominal {signal.name} ends at {x[-1]:.6g}, not at {x[0]:.6g} {signal.unit} where it began"
    return ""


def _repeats(model: LTVModel, flat: np.ndarray) -> tuple[float | None, Path | None]:
    """The shortest shift [s], at most half the span, after which A(t) is the same, and A(t) up to it."""
    t, n = model.t, len(model.t)
    if n < 17:
        return None, None
    rng = np.random.default_rng(0)
    centred = (flat - flat.mean(axis=0)) / np.ptp(flat, axis=0)
    few = centred @ rng.uniform(0.5, 1.0, (flat.shape[1], 2)) / flat.shape[1]
    uniform = few if _uniform(t) else CubicSpline(t, few)(np.linspace(t[0], t[-1], n))
    half = n // 2 + 2  # the neighbours of every shift up to half the span
    square = np.vstack([np.zeros(1), np.cumsum((uniform**2).sum(axis=1))[:, None]])[:, 0]
    pad = np.fft.rfft(uniform, 2 * n, axis=0)
    cross = np.fft.irfft((np.abs(pad) ** 2).sum(axis=1))[:half]
    shift = np.arange(half)
    distance = (square[n - shift] + square[n] - square[shift] - 2 * cross) / (n - shift)
    low = (distance[1:-1] <= distance[:-2]) & (distance[1:-1] <= distance[2:])
    level = 2 * square[n] / n
    step = (t[-1] - t[0]) / (n - 1)
    near = np.flatnonzero(low & (distance[1:-1] < 0.1 * level))[:8] + 1
    path = CubicSpline(t, few) if len(near) else None
    for k in near:
        found = _refined(path, t, float(k * step), step)
        if found <= (t[-1] - t[0]) / 2 * (1 + 1e-9):
            period, reason = _tried(model, found)
            if not reason:
                return found, period
    return None, None


def _refined(path: Any, t: np.ndarray, shift: float, step: float) -> float:
    """The shift [s] near `shift` at which the path repeats best, by Gauss-Newton."""
    limit = shift
    for _ in range(20):
        at = t[t + shift <= t[-1]]
        miss, rate = path(at + shift) - path(at), path(at + shift, 1)
        change = float((miss * rate).sum() / (rate**2).sum())
        shift -= change
        if abs(change) < 1e-14 * limit or abs(shift - limit) > 2 * step:
            break
    return shift
