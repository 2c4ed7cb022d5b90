"""Systems made to mislead a verdict, by seed: other units, times and grids, far from normal, near the boundary, drift.

Truth comes from outside the code under test: eigenvalues that a model was made with, closed forms (Meissner's equation,
Markus and Yamabe 1960, turning frames, powers of time), characteristic values of Mathieu's equation (SciPy), the method
of Dormand and Prince of order 8 at 1e-12.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from known_systems import ltv
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.special import mathieu_a, mathieu_b

from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.piecewise_ltv import PiecewiseLTV


@dataclass
class Unseen:
    """A model, what assess is told of it, and what is true: the rate for ever [1/s], Phi over the record."""

    model: Any
    options: dict[str, Any] = field(default_factory=dict)
    rate: float | None = None
    Phi: np.ndarray | None = None
    multipliers: np.ndarray | None = None


def integrated(A: Callable[[float], np.ndarray], begin: float, end: float, n: int) -> np.ndarray:
    """Phi(end, begin)."""
    run = solve_ivp(
        lambda t, y: (A(t) @ y.reshape(n, n)).ravel(),
        (begin, end),
        np.eye(n).ravel(),
        method="DOP853",
        rtol=1e-12,
        atol=1e-14,
    )
    return run.y[:, -1].reshape(n, n)


def along(A: Callable[[float], np.ndarray], t: np.ndarray, **told: Any) -> Unseen:
    """On a record that is not repeated."""
    model = ltv(t, np.array([A(s) for s in t]))
    Phi = integrated(A, t[0], t[-1], model.A.shape[1])
    return Unseen(model, {"periodic": False}, **{"Phi": Phi, **told})


def still(A: np.ndarray, dt: float | None = None) -> LinearModel:
    return dataclasses.replace(ltv(np.array([0.0, 1.0]), np.repeat(A[None], 2, axis=0)).at(0), dt=dt)


def turned(rng: np.random.Generator, n: int) -> np.ndarray:
    return np.linalg.qr(rng.normal(size=(n, n)))[0]


def uneven(rng: np.random.Generator, begin: float, span: float, m: int) -> np.ndarray:
    t = np.r_[0.0, rng.uniform(0.2, 1.8, m).cumsum()]
    return begin + t / t[-1] * span


def with_rate(rng: np.random.Generator, n: int, rate: float) -> np.ndarray:
    """A matrix whose rightmost root has that real part, the others 0.2 1/s or more to its left."""
    M, k = np.zeros((n, n)), 0
    while k < n:
        real = rate if k == 0 else rate - rng.uniform(0.2, 2)
        M[k, k] = real
        if k + 1 < n and rng.integers(2):
            turn = rng.uniform(0.3, 8)
            M[k : k + 2, k : k + 2] = [[real, turn], [-turn, real]]
            k += 1
        k += 1
    T = turned(rng, n) @ np.diag(np.exp(rng.uniform(-1, 1, n))) @ turned(rng, n)
    return T @ M @ np.linalg.inv(T)


def either(rng: np.random.Generator, low: float, high: float) -> float:
    """+-10^x, x uniform."""
    return float(rng.choice([-1, 1]) * 10 ** rng.uniform(low, high))


def constant_in_other_units(rng: np.random.Generator) -> Unseen:
    """States in units 1e12 apart, uneven nodes, at other times."""
    n, rate = int(rng.integers(1, 9)), either(rng, -2, 0)
    unit = 10.0 ** rng.uniform(-6, 6, n)
    A = with_rate(rng, n, rate) * unit[:, None] / unit
    t = uneven(rng, float(rng.choice([0, 1e5, -300])), 10 ** rng.uniform(-1, 2), int(rng.integers(2, 200)))
    rounding = 1e-15 * rng.normal(size=(len(t), n, n)) * rng.integers(2)
    return Unseen(ltv(t, A * (1 + rounding)), rate=rate)


def near_the_axis(rng: np.random.Generator) -> Unseen:
    turn, rate = 10 ** rng.uniform(0, 2), either(rng, -9, -5)
    A = np.zeros((4, 4))
    A[:2, :2], A[2:, 2:] = [[0, 1], [-(turn**2) - rate**2, 2 * rate]], [[-1, 3], [-3, -1]]
    Q = turned(rng, 4)
    return Unseen(still(Q @ A @ Q.T), rate=rate)


def near_the_circle(rng: np.random.Generator) -> Unseen:
    size, M = 1 + either(rng, -5, -1), with_rate(rng, int(rng.integers(1, 7)), 0.0)
    M = M / np.abs(np.linalg.eigvals(M)).max() if np.abs(np.linalg.eigvals(M)).max() > 0 else np.eye(len(M))
    return Unseen(still(size * M, 0.1), rate=float(np.log(size) / 0.1))


def hidden(rng: np.random.Generator) -> Unseen:
    """A slow mode that nothing feels, of any unit, beside many fast ones; of a period or constant."""
    n, rate = int(rng.integers(6, 16)), either(rng, -4, -1)
    A, D, unit = np.zeros((n, n)), np.zeros((n, n)), np.ones(n)
    A[0, 0], A[1:, 1:], unit[0] = rate, with_rate(rng, n - 1, -0.5) * rng.uniform(1, 30), 10.0 ** rng.uniform(-9, 9)
    A = A * unit[:, None] / unit
    if rng.integers(2):
        return Unseen(still(A), rate=rate)
    D[1:, 1:] = 0.1 * rng.normal(size=(n - 1, n - 1))
    t = np.linspace(0, 2 * np.pi, 201)
    return Unseen(ltv(t, A + D * np.sin(t)[:, None, None]), {"period": 2 * np.pi}, rate)


def mathieu(rng: np.random.Generator) -> Unseen:
    """Beside a characteristic value by 1e-4 to 0.1, on nodes that begin anywhere."""
    q, k, beside = float(rng.uniform(0.1, 8)), int(rng.integers(1, 5)), either(rng, -4, -1)
    edges = float(mathieu_b(k, q)), float(mathieu_a(k, q))
    a = edges[int(rng.integers(2))] + beside
    t = np.linspace(0, np.pi, int(rng.integers(40, 200))) + float(rng.choice([0, 0.7, 1e3]))
    A = lambda s: np.array([[0, 1], [2 * q * np.cos(2 * s) - a, 0]])  # noqa: E731
    lam = np.linalg.eigvals(integrated(A, t[0], t[0] + np.pi, 2))
    inside = edges[0] < a < edges[1]
    rate = float(np.log(np.abs(lam).max()) / np.pi) if inside or a < mathieu_a(0, q) or k > 1 else 0.0
    model = ltv(t, np.array([A(s) for s in t]))
    return Unseen(model, {"period": np.pi}, rate if rate > 1e-9 else 0.0, multipliers=lam)


def meissner(rng: np.random.Generator) -> Unseen:
    """Stiffness that jumps between two values."""
    mean, jump, damping = rng.uniform(0.2, 4), rng.uniform(0.1, 3), float(rng.choice([0, 0.02]))
    first, second = (np.array([[0, 1], [-(mean + s * jump), -2 * damping]]) for s in (1, -1))
    T1, T2 = rng.uniform(0.3, 2, 2)
    lam = np.linalg.eigvals(expm(second * T2) @ expm(first * T1))
    rate = float(np.log(np.abs(lam).max()) / (T1 + T2))
    parts = [
        ltv(np.linspace(begin, end, 5), np.repeat(A[None], 5, axis=0))
        for A, begin, end in ((first, 0.0, T1), (second, T1, T1 + T2))
    ]
    return Unseen(parts, {"periodic": True}, rate if abs(rate) > 1e-12 else 0.0, multipliers=lam)


def turning_frame(rng: np.random.Generator) -> Unseen:
    """A = e^(-S t) A0 e^(S t): the rates are those of A0 + S."""
    n, turn = int(rng.integers(2, 6)), rng.uniform(0.5, 6)
    S, A0 = np.zeros((n, n)), with_rate(rng, n, either(rng, -1.7, 0))
    S[0, 1], S[1, 0] = turn, -turn
    T, lam = 2 * np.pi / turn, np.linalg.eigvals(A0 + S)
    t = np.linspace(0, T, int(rng.integers(33, 130)))
    model = ltv(t, np.array([expm(-S * s) @ A0 @ expm(S * s) for s in t]))
    return Unseen(model, {"period": T}, float(lam.real.max()), multipliers=np.exp(lam * T))


def markus_yamabe(rng: np.random.Generator) -> Unseen:
    a, open_ = rng.uniform(0.3, 1.9), bool(rng.integers(2))
    T = rng.uniform(3, 25) if open_ else 2 * np.pi
    c, s, t = np.cos, np.sin, np.linspace(0, T, 300)
    A = np.array(
        [[[a * c(x) ** 2 - 1, 1 - a * s(x) * c(x)], [-1 - a * s(x) * c(x), a * s(x) ** 2 - 1]] for x in t.tolist()]
    )
    fast, slow = np.exp((a - 1) * T), np.exp(-T)
    Phi = np.array([[fast * c(T), slow * s(T)], [-fast * s(T), slow * c(T)]])
    if open_:
        return Unseen(ltv(t, A), {"periodic": False}, a - 1, Phi)
    return Unseen(ltv(t, A), {"period": T}, a - 1, multipliers=np.array([fast, slow]))


def jumping(rng: np.random.Generator) -> Unseen:
    n, T = int(rng.integers(1, 4)), rng.uniform(0.5, 2)
    A, J = with_rate(rng, n, -0.4), turned(rng, n) * rng.uniform(0.5, 3)
    parts = [ltv(np.linspace(k * T, (k + 1) * T, 9), np.repeat(A[None], 9, axis=0)) for k in range(3)]
    lam = np.linalg.eigvals(J @ expm(A * T))
    model = PiecewiseLTV(tuple(parts), ((J, np.zeros(n)),) * 2)
    return Unseen(model, {"period": T}, float(np.log(np.abs(lam).max()) / T), multipliers=lam)


def free_to_drift(rng: np.random.Generator) -> Unseen:
    """Two or three integrators driven by a mode whose stiffness varies."""
    chain, turn, T = int(rng.integers(2, 4)), rng.uniform(2, 20), rng.uniform(1, 20)
    damping, more, n = float(rng.choice([0, 0.01, 0.1])), rng.uniform(0, 0.5), chain + 2

    def A(s: float) -> np.ndarray:
        M = np.zeros((n, n))
        M[:chain, :chain] = np.diag(np.ones(chain - 1), 1)
        M[chain, chain + 1], M[chain - 1, chain] = 1, 0.3
        M[chain + 1, chain:] = -(turn**2) * (1 + more * s / T), -2 * damping * turn
        return M

    return along(A, np.linspace(0, T, 400 if T * turn < 150 else 1200), rate=0.0)


def long_chain(rng: np.random.Generator) -> Unseen:
    """Four to eight integrators in any axes beside a damped mode that varies: a high power of time, no exponential."""
    p, T = int(rng.integers(4, 9)), 10 ** rng.uniform(0, 1.5)
    Q = turned(rng, p + 2) if rng.integers(2) else np.eye(p + 2)

    def A(s: float) -> np.ndarray:
        M = np.zeros((p + 2, p + 2))
        M[:p, :p] = np.diag(np.ones(p - 1), 1)
        M[p, p + 1], M[p + 1, p], M[p + 1, p + 1] = 1, -9, -1 - 0.3 * s / T
        return Q @ M @ Q.T

    return along(A, np.linspace(0, T, 300), rate=0.0)


def power_of_time(rng: np.random.Generator) -> Unseen:
    """x' = c/(1 + t) x on nodes that are ever further apart: (1 + t)^c."""
    c, T = float(rng.uniform(-3, 3)), 10 ** rng.uniform(0, 3)
    t = np.r_[0, np.geomspace(1e-3, T, 600)]
    return Unseen(ltv(t, (c / (1 + t))[:, None, None]), {"periodic": False}, min(c, 0.0), np.array([[(1 + T) ** c]]))


def far_from_normal(rng: np.random.Generator) -> Unseen:
    """Stable, with growth by powers of ten before it decays."""
    p, couples, T = int(rng.integers(2, 8)), 10 ** rng.uniform(0, 2), 10 ** rng.uniform(0, 2)
    one, up = np.eye(p), couples * np.diag(np.ones(p - 1), 1)
    return along(
        lambda s: (-1 - 0.2 * np.sin(0.3 * s)) * one + up * (1 + 0.1 * np.cos(0.17 * s)),
        np.linspace(0, T, 500),
        rate=-1.0,
    )


def short_and_coarse(rng: np.random.Generator) -> Unseen:
    """Records of 1e-8 s and more, three nodes and more."""
    n, T = int(rng.integers(1, 6)), 10 ** rng.uniform(-8, 1)
    A0, A1, A2 = with_rate(rng, n, float(rng.uniform(-1, 1))), *0.2 * rng.normal(size=(2, n, n))
    t = uneven(rng, float(rng.choice([0, 1.0, -5])), T, int(rng.integers(3, 30)))
    span = t[-1] - t[0]
    return along(lambda s: A0 + A1 * (s - t[0]) / span + A2 * ((s - t[0]) / span) ** 2, t)


def one_state(rng: np.random.Generator) -> Unseen:
    a, b, turn, T = rng.uniform(-1, 1), rng.uniform(0, 3), rng.uniform(0.3, 5), rng.uniform(1, 40)
    t = np.linspace(0, T, 200 + int(7 * turn * T))
    Phi = np.array([[np.exp(a * T + b * (1 - np.cos(turn * T)) / turn)]])
    return Unseen(ltv(1e4 + t, (a + b * np.sin(turn * t))[:, None, None]), {"periodic": False}, Phi=Phi)


def undamped(rng: np.random.Generator) -> Unseen:
    """A skew at all times, in any units: nothing grows or decays."""
    n, T = int(rng.integers(2, 6)), rng.uniform(1, 20)
    K, L = (M - M.T for M in rng.normal(size=(2, n, n)))
    unit, t = 10.0 ** rng.uniform(-6, 6, n), np.linspace(0, T, 500)
    Phi = integrated(lambda s: K + L * np.sin(s), 0.0, T, n) * unit[:, None] / unit
    A = (K + L * np.sin(t)[:, None, None]) * unit[:, None] / unit
    return Unseen(ltv(t, A), {"periodic": False}, 0.0, Phi)


def many_states(rng: np.random.Generator) -> Unseen:
    A, D = with_rate(rng, 40, float(rng.choice([-0.3, 0.3]))), 0.05 * rng.normal(size=(40, 40))
    return along(lambda s: A + D * np.sin(1.3 * s), np.linspace(0, rng.uniform(2, 10), 300))


KINDS = (
    *(constant_in_other_units, near_the_axis, near_the_circle, hidden, mathieu, meissner, turning_frame),
    *(markus_yamabe, jumping, free_to_drift, long_chain, power_of_time, far_from_normal, short_and_coarse),
    *(one_state, undamped, many_states),
)


def unseen(seed: int) -> tuple[str, Unseen]:
    """One of the kinds in turn."""
    make = KINDS[seed % len(KINDS)]
    return make.__name__, make(np.random.default_rng([seed, 16]))
