"""Sampled loops with one channel late by any time: the exact model, and the shortest delay that they do not bear.

A delay of m periods and s more reaches a plant between samples: over the first s of a period acts the input of m + 1
periods ago, then that of m periods ago, and a reading is that of the state m periods and s before (Astrom, Wittenmark
1997, "Computer-Controlled Systems", 3.2). What the sampled response alone tells, its phase over frequency, holds for
whole periods only: a mode above the Nyquist frequency turns far between two samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.plants.core.imports import linalg
from pliant.plants.core.signals import rows_by_name
from pliant.plants.linear.lti import LinearModel

from .linear_laws import Array, LinearLaw, closed_matrix, readings_under_way

MOST_PERIODS = 64  # of delay, for which poles are computed; all that are looked at where the response tells no end
COMPUTED = 300  # of delay, up to which the one that is told is made sure of by its poles; past it by response alone
ACROSS = 0.15  # turn of the fastest mode between two delays that are looked at [rad], and
PARTS = 8  # at least so many in a period
EVEN = 4000  # frequencies up to Nyquist's, beside those that crowd at the poles
TOGETHER = 1000  # frequencies that are worked on at once
BEFORE = 1 - 1e-9  # of a period: the delay with which an input acts just after the next sample, not before it
OFF = 1e-9  # how far out of the unit circle poles are counted: those of undamped modes, upon it, are within


@dataclass(frozen=True, eq=False)
class LateLoop:
    """A continuous model under a sampled law, one channel late: of the inputs, or of the readings."""

    model: LinearModel
    law: LinearLaw
    at: str

    @property
    def dt(self) -> float:
        assert self.law.dt is not None
        return self.law.dt

    def closed(self, channel: int, delay: float) -> Array:
        """A of the closed loop with this channel late by `delay` [s]."""
        periods = int(np.floor(delay / self.dt * (1 + 1e-12)))
        rest = min(max(delay - periods * self.dt, 0.0), self.dt)
        make = self._late_input if self.at == "input" else self._late_reading
        return self._closed(*make(channel, periods, rest))

    def response(self, channel: int, rests: Array, z: Array) -> Array:
        """T (len(rests), len(z)) of the loop cut at this channel: late by m periods and a rest, its poles are where
        z^-m T = 1.

        A rest changes the way of the late signal alone: of an input into the plant, of a reading out of it.
        """
        n, at = len(self.model.A), len(self.model.A) + self.model.B.shape[1]  # of the late signal among the states
        if self.at == "input":
            A, B, C = self._late_input(channel, 0, 0.0)
            A[:n, -1] = B[:n, channel] = 0.0
            whole = self._closed(A, B, C)
            inner, into, out = _cut(whole, at)
            seen = _solved(inner.T, out, z)  # out (z - A)^-1
            ways = [self._transitions(rest)[1::2] for rest in rests]
            old, new = (np.array([(G - late, late)[k][:, channel] for G, late in ways]) for k in range(2))
            return np.asarray((new + old / z[:, None, None]) @ seen[:, :n, None])[..., 0].T + (
                (seen @ into + whole[at, at]) / z
            )
        found, moved = [], None
        for rest in rests:
            whole = self._closed(*self._late_reading(channel, 0, rest))
            inner, into, out = _cut(whole, at)
            moved = _solved(inner, into, z) if moved is None else moved  # (z - A)^-1 into
            found.append((moved @ out + whole[at, at]) / z)
        return np.array(found)

    def _closed(self, A: Array, B: Array, C: Array) -> Array:
        A, B, C = readings_under_way(A, B, C, self.law.delay)
        return closed_matrix((A, B, C, np.zeros((len(C), B.shape[1]))), self.law)

    def _transitions(self, rest: float) -> tuple[Array, Array, Array, Array]:
        """F, G of x+ = F x + G u over a period, and over its end, dt - rest."""
        n = len(self.model.A)
        block = np.zeros((n + self.model.B.shape[1],) * 2)
        block[:n] = np.hstack([self.model.A, self.model.B])
        whole, end = (linalg.expm(h * block)[:n] for h in (self.dt, self.dt - rest))
        return whole[:, :n], whole[:, n:], end[:, :n], end[:, n:]

    def _with_past(self, i: int, periods: int, F: Array, G: Array) -> tuple[Array, Array, Array]:
        """The plant, the inputs held before, and a chain of periods + 1 earlier values; what is read without those."""
        n, nu = G.shape
        past = n + nu
        A, B = np.zeros((past + periods + 1,) * 2), np.zeros((past + periods + 1, nu))
        A[:n, :n], B[:n], B[n:past] = F, G, np.eye(nu)
        A[past + 1 :, past:-1] = np.eye(periods)
        _, C, D, _ = rows_by_name(self.model, self.law.reads)
        return A, B, np.hstack([C, D, np.zeros((len(C), periods + 1))])

    def _late_input(self, i: int, periods: int, rest: float) -> tuple[Array, Array, Array]:
        """The chain holds input i of 1 to periods + 1 samples ago."""
        F, G, _, new = self._transitions(rest)
        n, nu = G.shape
        A, B, seen = self._with_past(i, periods, F, G)
        B[:n, i], B[n + nu, i] = 0.0, 1.0
        if periods:
            A[:n, -2] = new[:, i]
        else:
            B[:n, i] = new[:, i]
        A[:n, -1] += G[:, i] - new[:, i]
        seen[:, -1], seen[:, n + i] = seen[:, n + i], 0.0
        return A, B, seen

    def _late_reading(self, i: int, periods: int, rest: float) -> tuple[Array, Array, Array]:
        """The chain holds reading i under way, the latest first."""
        F, G, end, new = self._transitions(rest)
        n, nu = G.shape
        A, B, seen = self._with_past(i, periods, F, G)
        C, D = seen[i, :n], seen[i, n : n + nu].copy()
        A[n + nu, :n], B[n + nu] = C @ end, C @ new + D
        seen[i] = 0.0
        seen[i, -1] = 1.0
        return A, B, seen


def _cut(whole: Array, at: int) -> tuple[Array, Array, Array]:
    """A system without its state number `at`, how that state drives it, and how it drives that state."""
    rest = np.delete(np.arange(len(whole)), at)
    return whole[np.ix_(rest, rest)], whole[rest, at], whole[at, rest]


def _solved(A: Array, b: Array, z: Array) -> Array:
    """(z - A)^-1 b (len(z), n)."""
    parts = [
        np.linalg.solve(some[:, None, None] * np.eye(len(A)) - A, np.broadcast_to(b[:, None], (len(some), len(b), 1)))
        for some in np.array_split(z, len(z) // TOGETHER + 1)
    ]
    return np.concatenate(parts)[..., 0]


def shortest(late: LateLoop | None, channel: int, dt: float, lag: float, grid: Array) -> float:
    """The delay [s] below which a sampled loop stays stable, from the `lag` [s] of its sampled response.

    Where the model is continuous, by how many poles are outside the unit circle, see `_outside`. Delays are looked at
    ACROSS of the model's fastest mode apart, and the first that is not borne is closed in on by its poles; past
    MOST_PERIODS the last before it is told. Where only a sampled model is known, a whole number of periods, all of
    which are borne.
    """
    whole = np.inf if np.isinf(lag) else max(int(np.ceil(lag / dt * (1 - 1e-9))) - 1, 0) * dt
    if late is None:
        return float(whole)
    fastest = np.abs(np.linalg.eigvals(late.model.A)).max(initial=0.0)
    parts = int(np.ceil(max(PARTS, fastest * dt / ACROSS)))
    rests = np.arange(parts) * dt / parts
    if rows_by_name(late.model, late.law.reads)[2].any():
        rests = np.append(rests, dt * BEFORE)  # a reading of the input jumps as that passes the sample
    omega = np.unique(np.concatenate([grid * dt, np.pi * np.linspace(1 / EVEN, 1.0, EVEN)]))
    omega = omega[omega <= np.pi]
    T = late.response(channel, rests, (1 + OFF) * np.exp(1j * omega))
    if (np.abs(T) < 1).all():
        return np.inf  # no pole reaches the circle, whatever the delay

    def leaves(delay: float) -> bool:
        return bool(np.abs(np.linalg.eigvals(late.closed(channel, delay))).max() >= 1.0)

    most = MOST_PERIODS if np.isinf(whole) else round(whole / dt) + 1
    delays = (np.arange(most + 1)[:, None] * dt + rests).ravel()

    def settled(k: int) -> float:
        """The last of the delays up to number k whose poles are within; number k where they are too many to compute."""
        while k > 0 and delays[k] <= COMPUTED * dt and leaves(delays[k]):
            k -= 1
        return float(delays[max(k, 0)])

    for k in np.flatnonzero(_outside(T, omega, most + 1).T.ravel() > 0).tolist():  # in order of the delay
        if delays[k] > MOST_PERIODS * dt:
            return settled(k - 1)
        if not leaves(delays[k]):
            continue
        while k > 0 and leaves(delays[k - 1]):
            k -= 1
        before, at = float(delays[max(k - 1, 0)]), float(delays[k])
        while at - before > 1e-9 * at:
            middle = (before + at) / 2
            before, at = (before, middle) if leaves(middle) else (middle, at)
        return before
    return float(whole) if np.isinf(whole) else settled(round(whole / dt) * len(rests))


def _outside(T: Array, omega: Array, periods: int) -> Array:
    """How many poles of 1 = z^-m T are outside the unit circle, (len(T), periods) for m = 0, 1, ..; none of T[0] at 0.

    At m = 0 by the turns of 1 - T around zero along the half circle z = exp(j omega). A response that falls through 1
    with the phase phi at omega_c sends a pair out for every m that passes (phi + 2 pi k) / omega_c, one that rises
    brings it back; so Cooke and van den Driessche 1986, "On zeroes of some transcendental equations", of real delays.
    """
    f = 1 - T
    turns = np.angle(f[:, 1:] / f[:, :-1]).sum(axis=1)
    m = np.arange(periods)
    found = -np.round((turns - turns[0]) / np.pi)[:, None] + m * (np.abs(T[:, -1:]) > 1)
    size, turn = np.log(np.abs(T)), np.angle(T[:, 1:] / T[:, :-1])
    for row, k in zip(*np.nonzero(np.diff(size > 0, axis=1))):
        share = size[row, k] / (size[row, k] - size[row, k + 1])
        at = omega[k] + share * (omega[k + 1] - omega[k])
        phase = (np.angle(T[row, k]) + share * turn[row, k]) % (2 * np.pi)
        pairs = np.floor((m * at - phase) / (2 * np.pi)) + 1
        found[row] += 2 * pairs * (1 if size[row, k] > 0 else -1)
    return np.asarray(found)
