"""Regulators of inputs that act late, by whole periods and a part of one: known, or within a range.

Model    a delay of d = m + f periods, 0 <= f < 1: over the first f of period k acts u[k-m-1], over the rest u[k-m]
States   z = [x; u[k-M]; ..; u[k-1]], M the periods of the longest delay, begun ones counted: z+ = A_d z + B_d u and
         the cost of a period, both exact for held inputs
Known    u = -K F z: F z is the state that will be met when the input begins to act, K the gain without delay. It is the
         optimum, since a plant sampled at the times when inputs begin to act has no delay (Mirkin and Raskin 2003)
Range    each period's delay is drawn among points of the range, and the law does not know it:
         P = E[Q_d + A_d'P A_d] - K'S K,  S = E[R_d + B_d'P B_d],  K = S^-1 E[N_d' + B_d'P A_d]
         (De Koning 1982, "Infinite horizon optimal control of linear discrete time systems with stochastic parameters";
         of loops with delays Nilsson, Bernhardsson and Wittenmark 1998, "Stochastic analysis and control of real-time
         systems with random time delays"). It is stable in the mean square for such delays; one that stays is another
         matter, so that `radii` looks at those, and a law that is not stable for each is refused
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from pliant.controllers.base.controller import pair
from pliant.plants.core.argument_gates import require_number
from pliant.plants.core.errors import PliantError

from .algebraic import Regulator, sampled

Array = np.ndarray
MOST = 1000.0  # periods
WHOLE = 1e-9  # of a period: a part that is none
POINTS = 3  # of a range, ends among them, at which the law is designed
LOOKED = 17  # and at which its loop is looked at
SETTLED = 1e-12
ITERATIONS = 100_000


class LatePeriod(NamedTuple):
    """z+ = step [z; u] (nz, nz + nu) and the cost [z; u]' cost [z; u] of a period."""

    step: Array
    cost: Array


class LateRegulator(NamedTuple):
    """u = -K z, and what a prediction of it needs."""

    K: Array  # (nu, nz)
    P: Array  # (nz, nz): z'P z is the cost to go, in the mean where delays are drawn
    S: Array  # (nu, nu): what (u + K z)'S (u + K z) a change of one input adds
    poles: Array  # (nz,) in the z plane, at the middle of the range
    middle: LatePeriod  # of that delay


def delay_range(owner: str, delay: Any, field: str = "delay") -> tuple[float, float]:
    """(shortest, longest) delay [periods] from a number or a pair. ValueError that names `owner`.`field`."""
    name = f"{owner}.{field}"
    if isinstance(delay, (tuple, list, np.ndarray)) and np.ndim(delay):
        low, high = (require_number(name, end, "nonnegative", unit="periods") for end in pair(name, delay))
    else:
        low = high = require_number(name, delay, "nonnegative", unit="periods")
    if not low <= high <= MOST:
        raise ValueError(f"{name} = {delay!r} must be shortest <= longest, up to {MOST:g} periods")
    return float(low), float(high)


def periods_of(delay: float) -> tuple[int, float]:
    """(m, f) of m + f periods, 0 <= f < 1."""
    m = int(np.floor(delay + WHOLE))
    part = delay - m
    return m, part if part > WHOLE else 0.0


def past_of(delay: float) -> int:
    """How many inputs are on their way: the periods of the delay, a begun one counted."""
    m, part = periods_of(delay)
    return m + (part > 0)


def ahead(A: Array, B: Array, dt: float, delay: float) -> Array:
    """F (nx, nx + M nu): the state when the next input begins to act, from [x; u[k-M]; ..; u[k-1]], held inputs."""
    (nx, nu), past = B.shape, past_of(delay)
    _, part = periods_of(delay)
    F, none = np.eye(nx, nx + past * nu), (np.zeros((nx, nx)), np.eye(nu), np.zeros((nx, nu)))
    for k in range(past):
        E, _ = _held(A, B, *none, dt * part if part and not k else dt)
        F = E @ np.vstack([F, _picked(nx + past * nu, nx + k * nu, nu)])
    return F


def late_period(A: Array, B: Array, Q: Array, R: Array, N: Array, dt: float, delay: float, past: int) -> LatePeriod:
    """A period of `dt` with the last `past` inputs as states; A, B continuous, Q, R, N of the rate of cost."""
    nx, nu = B.shape
    m, part = periods_of(delay)
    nz = nx + past * nu
    x, cost = np.eye(nx, nz + nu), np.zeros((nz + nu, nz + nu))
    for share, age in ((part, m + 1), (1.0 - part, m)):
        if share:
            both = np.vstack([x, _picked(nz + nu, nz if age == 0 else nx + (past - age) * nu, nu)])
            E, H = _held(A, B, Q, R, N, share * dt)
            cost += both.T @ H @ both
            x = E @ both
    step = np.zeros((nz, nz + nu))
    step[:nx] = x
    step[nx:, nx + nu :] = np.eye(past * nu)
    return LatePeriod(step, cost)


def late_lqr(
    A: Array, B: Array, Q: Array, R: Array, N: Array, *, dt: float, delays: tuple[float, float], on_time: Regulator
) -> LateRegulator:
    """The law for inputs that act `delays` = (shortest, longest) [periods] late; A, B, Q, R, N of continuous time.

    on_time: the regulator of the sampled problem without delay, K (nu, nx). PliantError where the law of a range does
    not bear one of its delays.

    Example
    -------
    >>> from pliant.controllers.riccati import dlqr
    >>> A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])
    >>> weights = np.eye(2), np.eye(1), np.zeros((2, 1))
    >>> on_time = dlqr(*sampled(A, B, *weights, dt=0.1))
    >>> late_lqr(A, B, *weights, dt=0.1, delays=(0.0, 1.5), on_time=on_time).K.shape
    (1, 4)
    """
    low, high = delays
    past = past_of(high)
    periods = [late_period(A, B, Q, R, N, dt, d, past) for d in np.linspace(low, high, 1 if low == high else POINTS)]
    F = ahead(A, B, dt, high)
    first = _waiting_cost(A, B, Q, R, N, dt, high) + F.T @ on_time.P @ F
    middle = late_period(A, B, Q, R, N, dt, (low + high) / 2, past)
    if low == high:
        K = on_time.K @ F
        return LateRegulator(K, first, _mean(periods, first)[len(first) :, len(first) :], _poles(middle, K), middle)
    K, P, S = _drawn(periods, first)
    stays = np.linspace(low, high, LOOKED)
    largest = radii([late_period(A, B, Q, R, N, dt, d, past) for d in stays], K)
    if largest.max() >= 1:
        raise PliantError(
            f"delay = ({low:g}, {high:g}) periods: the law for all is not stable for one of "
            f"{stays[int(largest.argmax())]:.3g} that stays (largest |z| {largest.max():.4f}): narrow the range, or "
            "make the inputs dearer"
        )
    return LateRegulator(K, P, S, _poles(middle, K), middle)


def radii(periods: Sequence[LatePeriod], K: Array) -> Array:
    """Largest |z| of u = -K z for each delay (m,)."""
    return np.array([np.abs(_poles(period, K)).max() for period in periods])


def _held(A: Array, B: Array, Q: Array, R: Array, N: Array, h: float) -> tuple[Array, Array]:
    """[A_h, B_h] (nx, nx + nu) of an input held over h, and the cost (nx + nu, nx + nu) of that time."""
    found = sampled(A, B, Q, R, N, dt=h)
    return np.hstack([found.A, found.B]), np.block([[found.Q, found.N], [found.N.T, found.R]])


def _picked(size: int, first: int, count: int) -> Array:
    """(count, size): these of so many."""
    return np.eye(size)[first : first + count]


def _waiting_cost(A: Array, B: Array, Q: Array, R: Array, N: Array, dt: float, delay: float) -> Array:
    """(nz, nz) of z: what the time until the next input acts costs."""
    (nx, nu), past = B.shape, past_of(delay)
    _, part = periods_of(delay)
    nz = nx + past * nu
    x, cost = np.eye(nx, nz), np.zeros((nz, nz))
    for k in range(past):
        both = np.vstack([x, _picked(nz, nx + k * nu, nu)])
        E, H = _held(A, B, Q, R, N, dt * part if part and not k else dt)
        cost += both.T @ H @ both
        x = E @ both
    return cost


def _poles(period: LatePeriod, K: Array) -> Array:
    nz = len(period.step)
    return np.linalg.eigvals(period.step[:, :nz] - period.step[:, nz:] @ K).astype(complex)


def _mean(periods: Sequence[LatePeriod], P: Array) -> Array:
    """(nz + nu, nz + nu) of [z; u]: a period's cost and the cost to go after it, in the mean."""
    return np.asarray(np.mean([p.cost + p.step.T @ P @ p.step for p in periods], axis=0))


def _drawn(periods: Sequence[LatePeriod], P: Array) -> tuple[Array, Array, Array]:
    """K, P and S of the Riccati equation in the mean of the periods, by iteration from P."""
    nz = len(P)
    largest = np.abs(P).max() / np.finfo(float).eps ** 2  # past it nothing settles any more
    for _ in range(ITERATIONS):
        H = _mean(periods, P)
        S = H[nz:, nz:]
        K = np.linalg.solve(S, H[nz:, :nz])
        new = H[:nz, :nz] - H[:nz, nz:] @ K
        change = np.abs(new - P).max()
        P = (new + new.T) / 2
        if change <= SETTLED * np.abs(P).max():
            return K, P, S
        if not change < largest:
            break
    raise PliantError("no law for all delays of the range: their Riccati equation has no solution; narrow the range")
