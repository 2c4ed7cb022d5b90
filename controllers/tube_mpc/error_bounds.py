"""How far a plan's error reaches under an ancillary law: what the limits of a plan have to leave.

A plan made at time k has inputs of its own for N periods, then those of the law K_f. What acts at time s moves the
state off it, and the ancillary law u = v - K (x - z) answers, after N periods K_f:

    M_0 = I,  M_{l+1} = (A - B K) M_l  (l < N),  (A - B K_f) M_l  (l >= N);   U_l = -K M_l, -K_f M_l

An input, or a signal C x + D u, that is looked at j periods after k is off by at most

    t_k[j] = t_{k+1}[j-1] + h_k(C M_{j-1} + D U_{j-1}),   t_k[0] = 0

h_k being the support function of what acts at time k: the recursion with which a proof goes from one plan to the next
(Chisci, Rossiter and Zappa 2001). From a reading that is off by e the plan starts at x + e, and what it sees moves by
w + e_{k+1} - A e_k; a signal of the states alone moves, at the next period, by w - A e_k only. One with feedthrough is
looked at in the period of the plan too, where it is off by C e.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .disturbance_set import DisturbanceSet

Array = np.ndarray


class Course(NamedTuple):
    """The model, the signals and both laws over time, as arrays whose last entry stays."""

    A: Array  # (.., nx, nx)
    B: Array  # (.., nx, nu)
    C: Array  # (.., nb, nx) bounded signals
    D: Array  # (.., nb, nu)
    K: Array  # (.., nu, nx) ancillary
    Kf: Array  # (.., nu, nx) past the horizon, u = u0 - Kf (x - x0) - kf
    kf: Array | None = None  # (.., nu), None: zero

    @property
    def direct(self) -> Array:
        """(nb,) which signals have feedthrough, at one time at least."""
        return np.asarray(self.D.any(axis=(0, 2)))

    def at(self, k: int) -> tuple[Array, ...]:
        """(A, B, C, D, K, Kf) of time k."""
        return tuple(part[min(k, len(part) - 1)] for part in self[:6])

    def over(self, first: int, times: int) -> tuple[Array, ...]:
        """The same (times, .., ..) of times first, first + 1, ..; (1, .., ..) where it is the same at all times."""
        parts = self[:6]
        span = 1 if all(len(part) == 1 for part in parts) else times
        return tuple(part[np.minimum(np.arange(first, first + span), len(part) - 1)] for part in parts)


class Tightening(NamedTuple):
    """What a plan of time k has to leave j periods on: of inputs and of signals, to their upper and lower ends."""

    u_high: Array  # (times, n + 1, nu)
    u_low: Array
    z_high: Array  # (times, n + 1, nb)
    z_low: Array


def responses(course: Course, times: int, n: int, horizon: int) -> tuple[Array, Array]:
    """Inputs (times, n, nu, nx) and signals (times, n, nb, nx) 1 .. n periods after each time, by what the state is off
    one period after it; (1, ..) where the course is the same at all times."""
    M, inputs, signals = np.eye(course.A.shape[-1]), [], []
    for lag in range(n):
        A, B, C, D, K, Kf = course.over(1 + lag, times)
        U = -(K if lag < horizon else Kf) @ M
        inputs.append(U)
        signals.append(C @ M + D @ U)
        M = A @ M + B @ U
    return np.stack(inputs, axis=1), np.stack(signals, axis=1)


def tightening(course: Course, rows: tuple[Array, Array], disturbances: DisturbanceSet, times: int) -> Tightening:
    """Of plans made at times 0 .. times - 1, the last of which stays; rows: its `responses`."""
    (nu, nx), nb, n = course.K.shape[-2:], course.C.shape[-2], rows[0].shape[1]
    found = Tightening(*(np.zeros((times, n + 1, width)) for width in (nu, nu, nb, nb)))
    noise, unread = disturbances.noise, ~course.direct  # signals of the next period that no reading enters
    for k in range(times - 1, -1, -1):
        A, _, C = course.at(k)[:3]
        found.z_high[k, 0] = found.z_low[k, 0] = np.where(course.direct, np.abs(C) @ noise, 0.0)
        for seen, ends in zip(rows, (found[:2], found[2:])):
            d = seen[min(k, len(seen) - 1)].reshape(-1, nx)
            off = np.abs(d) @ noise
            if ends[0] is found.z_high:
                off[:nb][unread] = 0.0
            off += np.abs(d @ A) @ noise
            for end, way in zip(ends, (1.0, -1.0)):
                new = (disturbances.support(k, way * d) + off).reshape(n, -1)
                end[k, 1:] = end[k + 1, :-1] + new if k + 1 < times else end[k, 0] + np.cumsum(new, axis=0)
    return found
