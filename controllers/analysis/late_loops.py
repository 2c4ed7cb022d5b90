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

MOST_PERIODS = 64  # of delay that are looked at between the samples
ACROSS = 0.15  # turn of the fastest mode between two delays that are looked at [rad], and
PARTS = 32  # at least so many in a period


@dataclass(frozen=True, eq=False)
class LateLoop:
    """A continuous model under a sampled law, one channel late: of the inputs, or of the readings."""

    model: LinearModel
    law: LinearLaw
    at: str

    def closed(self, channel: int, delay: float) -> Array:
        """A of the closed loop with this channel late by `delay` [s]."""
        dt = float(self.law.dt or 0.0)
        periods = int(np.floor(delay / dt * (1 + 1e-12)))
        rest = min(max(delay - periods * dt, 0.0), dt)
        make = self._late_input if self.at == "input" else self._late_reading
        A, B, C = make(channel, periods, rest)
        A, B, C = readings_under_way(A, B, C, self.law.delay)
        return closed_matrix((A, B, C, np.zeros((len(C), B.shape[1]))), self.law)

    def _parts(self, rest: float) -> tuple[Array, Array, Array, Array, Array, Array]:
        """Transitions over a period and over its end, dt - rest, and the readings' C and D."""
        dt, n = float(self.law.dt or 0.0), len(self.model.A)
        block = np.zeros((n + self.model.B.shape[1],) * 2)
        block[:n] = np.hstack([self.model.A, self.model.B])
        whole, end = (linalg.expm(h * block)[:n] for h in (dt, dt - rest))
        _, C, D, _ = rows_by_name(self.model, self.law.reads)
        return whole[:, :n], whole[:, n:], end[:, :n], end[:, n:], C, D

    def _late_input(self, i: int, periods: int, rest: float) -> tuple[Array, Array, Array]:
        """States: the plant's, the inputs held before, then input i of 1 to periods + 1 samples ago."""
        F, G, _, new, C, D = self._parts(rest)
        n, nu = G.shape
        past = n + nu
        A, B = np.zeros((past + periods + 1,) * 2), np.zeros((past + periods + 1, nu))
        A[:n, :n], B[:n], B[n:past] = F, G, np.eye(nu)
        B[:n, i] = 0.0
        A[past + 1 :, past:-1] = np.eye(periods)
        B[past, i] = 1.0
        if periods:
            A[:n, -2] = new[:, i]
        else:
            B[:n, i] = new[:, i]
        A[:n, -1] += G[:, i] - new[:, i]
        seen = np.hstack([C, D, np.zeros((len(C), periods + 1))])
        seen[:, n + i] = 0.0
        seen[:, -1] = D[:, i]
        return A, B, seen

    def _late_reading(self, i: int, periods: int, rest: float) -> tuple[Array, Array, Array]:
        """States: the plant's, the inputs held before, then reading i under way, the latest first."""
        F, G, end, new, C, D = self._parts(rest)
        n, nu = G.shape
        past = n + nu
        A, B = np.zeros((past + periods + 1,) * 2), np.zeros((past + periods + 1, nu))
        A[:n, :n], B[:n], B[n:past] = F, G, np.eye(nu)
        A[past, :n], B[past] = C[i] @ end, C[i] @ new + D[i]
        A[past + 1 :, past:-1] = np.eye(periods)
        seen = np.hstack([C, D, np.zeros((len(C), periods + 1))])
        seen[i] = 0.0
        seen[i, -1] = 1.0
        return A, B, seen


def shortest(late: LateLoop | None, channel: int, dt: float, lag: float) -> float:
    """The delay [s] below which a sampled loop stays stable, from the `lag` [s] of its sampled response.

    Exact where the model is continuous and the delay within MOST_PERIODS: delays are looked at ACROSS of its fastest
    mode apart, and the first limit is closed in on. Else a whole number of periods, all of which are borne.
    """
    whole = np.inf if np.isinf(lag) else max(int(np.ceil(lag / dt * (1 - 1e-9))) - 1, 0) * dt
    if late is None:
        return float(whole)
    fastest = np.abs(np.linalg.eigvals(late.model.A)).max(initial=0.0)
    parts = int(np.ceil(max(PARTS, fastest * dt / ACROSS)))

    def radius(delay: float) -> float:
        return float(np.abs(np.linalg.eigvals(late.closed(channel, delay))).max())

    periods = min(MOST_PERIODS, MOST_PERIODS if np.isinf(whole) else round(whole / dt) + 1)
    before = 0.0
    for k in range(1, periods * parts + 1):
        at = k * dt / parts
        if radius(at) >= 1.0:
            while at - before > 1e-9 * at:
                middle = (before + at) / 2
                before, at = (before, middle) if radius(middle) >= 1.0 else (middle, at)
            return before
        before = at
    return float(max(whole, before))
