"""How far a linear loop is from instability: gain, phase, delay and disk margins, and the peaks of S and T.

One loop at a time   the others closed: 1 + L_i = 1/S_ii. A gain factor inside `gain`, a phase of less than `phase_deg`
                     either way, a delay of less than `delay` keeps the loop stable, each alone
Disk                 any factor f = (1 + d/2)/(1 - d/2) with |d| < disk, gain and phase at once, of any frequency: the
                     reciprocal of the largest |S - 1/2| = |S - T|/2
All loops at once    an own such factor in each. S - 1/2 with its channels scaled to the least norm, one scaling for all
                     frequencies, bounds the structured singular value from above: `disk` is never too large

Source   Seiler, Packard and Gahinet 2020, "An introduction to disk margins", with skew 0; Skogestad and Postlethwaite
         (2005), Chapter 2, for the others. Peaks by `hinf_norm`, which no grid can miss; crossings by a grid that
         crowds at the poles
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq, minimize

from pliant.controllers.solvers.hinf_norm import Array, Peak, peak
from pliant.plants.core.argument_gates import require_instance, require_number
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import OwnsArrays

from .late_loops import shortest
from .loops import Loop

EDGE = 1e-12  # of the unit circle: poles that rounding does not tell from it
NOTHING = 1e-14  # sensitivity that rounding leaves where the loop integrates
POINTS = 1500  # of the grid, from FAR below the slowest to FAR above the fastest pole
FAR = 1e3
CROWD = np.concatenate([-np.geomspace(30, 1e-2, 24), [0.0], np.geomspace(1e-2, 30, 24)])  # in half-widths of a pole
MOST_CHANNELS = 8  # whose scaling is looked for
ROUNDS, WORST = 6, 40  # of that search, and how many frequencies each adds to those that it looks at


@dataclass(frozen=True)
class Channel:
    """One loop with the others closed."""

    name: str
    gain: tuple[float, float]  # smallest and largest factor, apart from 1, at which the loop is at its limit
    phase_deg: float
    delay: float  # [s] of a sampled loop exact up to 64 periods where its model is continuous, else whole periods
    disk: float
    crossover_hz: float  # highest at which |L_i| = 1; 0 where there is none

    @property
    def disk_gain(self) -> tuple[float, float]:
        """Gain factors that the disk margin allows."""
        return disk_gain(self.disk)

    @property
    def disk_phase_deg(self) -> float:
        """Phase that the disk margin allows."""
        return disk_phase_deg(self.disk)


@dataclass(frozen=True)
class Margins(OwnsArrays):
    """Readings of one loop."""

    channels: tuple[Channel, ...]
    disk: float  # of all channels at once
    S: Peak  # largest singular value of S = (I + L)^-1
    T: Peak  # of T = L S
    conserved: tuple[str, ...] = ()  # what no input changes: these are margins of all else
    free: tuple[str, ...] = ()  # what inputs change and neither plant nor controller feels: left as it is

    @property
    def bandwidth_hz(self) -> float:
        """The highest crossover [Hz]."""
        return max(c.crossover_hz for c in self.channels)

    def __str__(self) -> str:
        low, high = disk_gain(self.disk)
        room = f"gain {low:.3g} to {high:.3g}, {disk_phase_deg(self.disk):.3g} deg"
        peaks = f"peak of S {self.S.value:.3g} at {self.S.hz:.3g} Hz, of T {self.T.value:.3g} at {self.T.hz:.3g} Hz"
        lines = [f"all loops at once: disk {self.disk:.3g} ({room}), {peaks}"]
        for c in self.channels:
            classic = f"gain {c.gain[0]:.3g} to {c.gain[1]:.3g}, phase {c.phase_deg:.3g} deg, delay {c.delay:.3g} s"
            lines.append(f"{c.name}: {classic}, disk {c.disk:.3g}, crossover {c.crossover_hz:.3g} Hz")
        lines += [f"apart from what no input changes: {'; '.join(self.conserved)}"] if self.conserved else []
        lines += [f"left as it is: {'; '.join(self.free)}"] if self.free else []
        return "\n".join(lines)


def disk_gain(disk: float) -> tuple[float, float]:
    """Smallest and largest gain factor inside a disk margin."""
    disk = require_number("disk_gain.disk", disk, "nonnegative")
    return max(0.0, (2 - disk) / (2 + disk)), (2 + disk) / (2 - disk) if disk < 2 else np.inf


def disk_phase_deg(disk: float) -> float:
    """Largest phase inside a disk margin."""
    return float(np.rad2deg(2 * np.arctan(require_number("disk_phase_deg.disk", disk, "nonnegative") / 2)))


def margins(loop: Loop) -> Margins:
    """All readings of a loop (see `loops.loop`). PliantError, with the pole, where it is not stable.

    Example
    -------
    >>> from pliant.controllers import loop
    >>> from pliant.plants import LinearModel
    >>> motor = LinearModel.from_matrices([[0.0, 1.0], [0.0, -1.0]], [[0.0], [1.0]])
    >>> round(margins(loop(motor, [[4.0, 2.0]])).bandwidth_hz, 3)
    0.382
    """
    closed = require_instance("margins.loop", loop, Loop).closed()
    poles = np.linalg.eigvals(closed).astype(complex)
    grows = poles.real >= 0 if loop.dt is None else np.abs(poles) >= 1 - EDGE
    if grows.any():
        worst = poles[grows][np.argmax(np.abs(poles[grows]))]
        rests = loop.dt is not None and bool((np.abs(poles[grows] - 1) <= EDGE).all())
        why = ", as of what inputs change, a filter reads and the law leaves as it is" if rests else ""
        raise PliantError(f"the closed loop is not stable, a pole is {worst:.4g}{why}: it has no margins")
    n = len(loop.channels)
    direct = np.linalg.inv(np.eye(n) + loop.D)
    B, C = loop.B @ direct, -direct @ loop.C  # S = direct + C (s - closed)^-1 B
    half = direct - np.eye(n) / 2
    grid = _grid(loop, poles)
    S = Loop(closed, B, C, direct, loop.dt, loop.channels)
    each = []
    for i, name in enumerate(loop.channels):
        alone = Loop(closed, B[:, [i]], C[[i]], direct[i : i + 1, i : i + 1], loop.dt, (name,))
        disk = 1 / peak(closed, alone.B, alone.C, half[i : i + 1, i : i + 1], loop.dt).value
        found = _channel(alone, disk, grid)
        if loop.dt is not None:
            found = replace(found, delay=shortest(loop.late, i, loop.dt, found.delay, grid))
        each.append(found)
    whole = 1 / scaled_peak(Loop(closed, B, C, half, loop.dt, loop.channels), grid) if n > 1 else each[0].disk
    T = peak(closed, B, -C, np.eye(n) - direct, loop.dt)
    return Margins(tuple(each), float(whole), peak(closed, S.B, S.C, S.D, loop.dt), T, loop.conserved, loop.free)


def scaled_peak(system: Loop, grid: Array) -> float:
    """An upper bound of the structured singular value of a stable system over all frequencies: diagonal uncertainty.

    The norm of W G W^-1 with one diagonal W: the least on a grid, then taken over all frequencies.
    """
    n = len(system.channels)
    G = system.at(grid)

    def sizes(w: Array, among: Array) -> Array:
        return np.asarray(np.linalg.svd(w[:, None] * among / w, compute_uv=False)[:, 0])

    def largest(log_w: Array) -> float:
        return float(sizes(np.exp(np.append(log_w, 0.0)), G[kept]).max())

    w, kept = np.ones(n), np.zeros(len(G), dtype=bool)
    for _ in range(ROUNDS if n <= MOST_CHANNELS else 0):  # over frequencies that were the largest under some scaling
        size = sizes(w, G)
        if kept.any() and size.max() <= largest(np.log(w[:-1] / w[-1])) * (1 + 1e-6):
            break
        kept[np.argsort(size)[-WORST:]] = True
        start = np.log(w[:-1] / w[-1])
        found = minimize(largest, start, method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-9})
        w = np.exp(np.append(found.x, 0.0))
    return peak(system.A, system.B / w, w[:, None] * system.C, w[:, None] * system.D / w, system.dt).value


def _grid(loop: Loop, poles: Array) -> Array:
    """Frequencies [rad/s], ascending, crowded at the poles of the open and the closed loop."""
    every = np.concatenate([np.linalg.eigvals(loop.A), poles]).astype(complex)
    if loop.dt is not None:
        every = np.log(every[np.abs(every) > 1e-9]) / loop.dt
    size = np.abs(every)
    slow, fast = (size[size > 1e-9 * size.max()].min(), size.max()) if size.max(initial=0.0) > 0 else (1.0, 1.0)
    omega = np.geomspace(slow / FAR, fast * FAR, POINTS)
    near = np.abs(every.imag)[:, None] + np.maximum(np.abs(every.real), 1e-6 * size)[:, None] * CROWD
    omega = np.concatenate([omega, near.ravel()])
    omega = omega[omega > 0]
    if loop.dt is not None:
        top = np.pi / loop.dt * (1 - 1e-9)
        omega = np.append(omega[omega < top], top)
    return np.unique(omega)


def _channel(sensitivity: Loop, disk: float, grid: Array) -> Channel:
    """Crossings of L = 1/S - 1 of one channel."""

    def L(omega: float | Array) -> Array:
        S = sensitivity.at(np.atleast_1d(omega))[:, 0, 0]
        none = np.abs(S) <= NOTHING
        return np.where(none, np.inf, 1 / np.where(none, 1.0, S) - 1)

    values = L(grid)
    size = np.log(np.maximum(np.abs(values), 1e-300))
    lags, phases, crossover = [np.inf], [np.pi], 0.0
    for k in np.flatnonzero(np.diff(np.sign(size)) != 0):
        at = _root(lambda w: float(np.log(np.abs(L(w)[0]))), grid[k], grid[k + 1])
        turned = np.angle(-L(at)[0])
        phases.append(abs(turned))
        lags.append((turned % (2 * np.pi)) / at)
        crossover = max(crossover, at)
    found = []
    for k in np.flatnonzero(np.diff(np.sign(values.imag)) != 0):
        if values[k].real < 0 or values[k + 1].real < 0:
            found.append(L(_root(lambda w: float(L(w)[0].imag), grid[k], grid[k + 1]))[0])
    found.append(L(0.0)[0])
    found.append(end := L(np.pi / sensitivity.dt)[0] if sensitivity.dt is not None else 1 / sensitivity.D[0, 0] - 1)
    real = [z.real for z in found if np.isfinite(z) and z.real < 0 and abs(z.imag) <= 1e-6 * abs(z.real)]
    factors = [-1 / z for z in real]
    gain = max([k for k in factors if k < 1], default=0.0), min([k for k in factors if k > 1], default=np.inf)
    if not abs(end) < 1:
        # Delayed, a feedthrough has a pole for every turn of its phase, all of them growing; and with L(-1) z^-1 for
        # L(-1) at z = -1 the characteristic function changes its sign there: a real pole is past it after one period
        lags.append(0.0)
    phase, lag = float(np.rad2deg(min(phases))), float(min(lags))
    return Channel(sensitivity.channels[0], gain, phase, lag, disk, crossover / (2 * np.pi))


def _root(f: Callable[[float], float], a: float, b: float) -> float:
    return float(brentq(f, a, b, xtol=1e-12 * b, rtol=1e-14))
