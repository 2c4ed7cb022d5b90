"""Systems whose stability is known: constant, switched, pulsating, drifting, in clusters, and the library's own plants.

Truth comes from outside the code under test: eigenvalues that the model was made with, products of matrix exponentials
(SciPy) for waves that are constant between jumps, Dormand and Prince's method of order 8 at 1e-12, started anew at each
jump and kink, for the others. What leaves no trace at any node is not asked: each stretch of a wave between two of its
corners holds a node.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from waves import Wave, grid, seen, wave

from pliant.plants import LTVModel, SingleLinkArm
from pliant.plants.linear.lti import LinearModel

FAMILIES = {
    "constant": 6,
    "sampled": 4,
    "chain": 2,
    "pieces": 6,
    "oscillator": 9,
    "undamped": 3,
    "mixed": 2,
    "cluster": 2,
    "drift": 2,
    "plant": 1,
}


@dataclass
class System:
    """A model, how assess is told of it, and what is true of it."""

    family: str
    wave: str
    nodes: int
    model: Any
    options: dict[str, Any]
    truth: np.ndarray  # multipliers (eigenvalues of a constant model)
    line: bool = False  # the boundary is Re z = 0
    size: float = 1.0  # of the eigenvalues
    exact: bool = False  # made to lie on the boundary, nothing outside
    note: dict[str, Any] = field(default_factory=dict)


def ltv(t: np.ndarray, A: np.ndarray) -> LTVModel:
    nt, n, z = len(t), A.shape[-1], np.zeros
    rows = {"c": z((nt, n)), "x": z((nt, n)), "u": z((nt, 0)), "y": z((nt, 0))}
    names = tuple(f"x{k}" for k in range(n))
    none = (z((nt, n, 0)), z((nt, n, 0)), z((nt, 0, n)), z((nt, 0, 0)), z((nt, 0, 0)))
    return LTVModel(t, A, *none, **rows, states=names, inputs=(), disturbances=(), outputs=())


def monodromy(A: Callable[[float], np.ndarray], n: int, w: Wave) -> np.ndarray:
    """Over [0, 1] for A(t) with the wave's corners."""
    cuts = np.unique(np.clip(np.r_[0.0, np.sort(w.corners), 1.0], 0.0, 1.0))
    M = np.eye(n)
    for a, b in pairwise(cuts):
        if b - a < 1e-13:
            continue
        if w.steps:
            M = expm(A((a + b) / 2) * (b - a)) @ M
            continue
        # The right-hand side is never asked beyond a corner: times are drawn inwards by a part in 1e13.
        inner = lambda s, a=a, b=b: min(max(s, a + 1e-11 * (b - a)), b - 1e-11 * (b - a))  # noqa: E731
        rhs = lambda s, y: (A(inner(s)) @ y.reshape(n, n)).ravel()  # noqa: B023, E731
        run = solve_ivp(rhs, (a, b), np.eye(n).ravel(), method="DOP853", rtol=1e-12, atol=1e-13)
        M = run.y[:, -1].reshape(n, n) @ M
    return M


# --- systems ------------------------------------------------------------------------------------------------------


def _nodes(rng: np.random.Generator, low: int = 5, high: int = 2000) -> int:
    return int(np.exp(rng.uniform(np.log(low), np.log(high + 0.99))))


def _turned(rng: np.random.Generator, A: np.ndarray) -> np.ndarray:
    """Rotated, permuted, with other units, or as it is: A (.., n, n)."""
    n, kind = A.shape[-1], rng.choice(5)
    if kind == 1:
        Q = np.linalg.qr(rng.standard_normal((n, n)))[0]
        return Q @ A @ Q.T
    if kind == 2:
        p = rng.permutation(n)
        return A[..., p, :][..., :, p]
    if kind == 3:
        s = 10.0 ** rng.uniform(-9, 9, n)
        return A * s / s[:, None]
    return A


def constant(rng: np.random.Generator, family: str) -> System:
    """Eigenvalues on both sides of their boundary, or chains of them upon it."""
    n = int(rng.integers(1, 7))
    if family == "chain":
        k = int(rng.integers(2, 5))
        n, line = max(n, k), bool(rng.choice(2))
        A = np.diag(-rng.uniform(0.1, 2, n))
        A[:k, :k] = np.diag(np.ones(k - 1), 1)
        truth = np.r_[np.zeros(k), np.diag(A)[k:]].astype(complex)
        if not line:
            A, truth = expm(A), np.exp(truth)
    else:
        line = family == "constant"
        rate = rng.choice([-1, 1], p=[0.6, 0.4]) * 10.0 ** rng.uniform(-7, 0) - np.r_[0, rng.uniform(0, 3, n - 1)]
        A, truth, k = np.zeros((n, n)), [], 0
        while k < n:
            if k + 1 < n and rng.uniform() < 0.6:
                w = 10.0 ** rng.uniform(-1, 1.5)
                A[k : k + 2, k : k + 2] = [[rate[k], w], [-w, rate[k]]]
                truth += [rate[k] + 1j * w, rate[k] - 1j * w]
                k += 2
            else:
                A[k, k] = rate[k]
                truth.append(rate[k])
                k += 1
        A = A + np.triu(rng.standard_normal((n, n)), 2) * rng.choice([0, 1])
        if rng.uniform() < 0.15 and n > 1 and line:  # fast beside slow
            A[-1, -1], truth[-1] = (-1e15, -1e15) if A[-1, -2] == 0 else (A[-1, -1], truth[-1])
        truth = np.array(truth, dtype=complex)
        if not line:
            A, truth = expm(A * 0.1), np.exp(truth * 0.1)
    A = _turned(rng, A) if np.abs(A).max(initial=0) < 1e14 else A
    speed = 10.0 ** rng.choice([0, 0, rng.uniform(-9, 9)])
    model = LinearModel.from_matrices(A * (speed if line else 1), np.zeros((n, 0)), dt=None if line else 0.1 / speed)
    truth = truth * (speed if line else 1)
    return System(family, "", 0, model, {}, truth, line, speed, exact=family == "chain")


def pieces(rng: np.random.Generator) -> System:
    n, count = int(rng.integers(2, 5)), int(rng.integers(2, 5))
    Q = np.linalg.qr(rng.standard_normal((n, n)))[0]
    shift = rng.uniform(-0.6, 1.2) * np.eye(n)
    A = [Q @ (rng.standard_normal((n, n)) * rng.uniform(0.3, 2) - shift) @ Q.T for _ in range(count)]
    length, turns = rng.uniform(0.1, 1.0, count), int(rng.integers(1, 4))
    M = np.eye(n)
    for a, h in zip(A, length):
        M = expm(a * h) @ M
    made, t = [], 0.0
    for a, h in zip(A * turns, np.tile(length, turns)):
        nodes = int(rng.integers(2, 9))
        made.append(ltv(np.linspace(t, t + h, nodes), np.repeat(a[None], nodes, 0)))
        t = made[-1].t[-1]
    return System("pieces", "levels", count, made, {"period": float(length.sum())}, np.linalg.eigvals(M))


@cache
def arm(friction: float, modes: int, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """A of an arm of the library at rest, and what gravity has in it."""
    found = []
    for gravity in (9.81, 4.905):
        one = replace(
            SingleLinkArm.textbook(), gravity=gravity, hub_friction=friction, basis="clamped-free", modes=modes
        )
        found.append(one.linearize(*one.equilibrium(hub_angle=angle)).A)
    return found[0], 2 * (found[0] - found[1])


def varying(rng: np.random.Generator, family: str) -> System | None:
    w = wave(rng)
    m = _nodes(rng)
    turns = int(rng.choice([1, 1, 1, 2, 3]))
    own = grid(rng, m)
    t = np.concatenate([[0.0], *(own[1:] + k for k in range(turns))])
    if not seen(own, w.corners):
        return None
    exact = False
    period = 2 * np.pi if family in ("oscillator", "undamped") else rng.uniform(0.5, 3.0)
    if family == "plant":
        period *= 0.3
    if family == "plant":  # its gravity pulsates, as on a table that shakes
        mean, pump = arm(
            float(rng.choice([0.02, 0.3])), int(rng.integers(1, 3)), float(rng.choice([-1, 1])) * np.pi / 2
        )
        pump = pump * rng.uniform(0.1, 3.0)
    elif family in ("oscillator", "undamped", "cluster", "drift"):
        k, depth = rng.uniform(0.05, 3.0), 0.0
        depth = rng.uniform(0.02, 0.95) * k
        d = 0.0 if family == "undamped" else float(rng.choice([-1, 1], p=[0.2, 0.8])) * 10.0 ** rng.uniform(-3, -0.3)
        mean, pump = np.array([[0, 1], [-k, -2 * d]]), np.array([[0, 0], [-depth, 0]])
        if family == "cluster":
            zero = np.zeros((2, 2))
            coupling = rng.choice([0.0, 1.0]) * rng.standard_normal((2, 2))
            mean, pump = np.block([[mean, coupling], [zero, mean]]), np.block([[pump, zero], [zero, pump]])
        if family == "drift":
            mean = np.block([[mean, np.zeros((2, 2))], [np.array([[1.0, 0], [0, 0]]), np.array([[0, 1.0], [0, 0]])]])
            pump = np.block([[pump, np.zeros((2, 2))], [np.zeros((2, 4))]])
    else:
        n = int(rng.integers(2, 7))
        mean = rng.standard_normal((n, n)) * rng.uniform(0.2, 1.0) - rng.uniform(-0.2, 1.5) * np.eye(n)
        pump = rng.standard_normal((n, n)) * rng.uniform(0.05, 1.0) * (rng.uniform(size=(n, n)) < 0.6)
        if not pump.any():
            return None
    n = len(mean)
    M = monodromy(lambda s: (mean + w.f(np.array(s)) * pump) * period, n, w)
    truth = np.linalg.eigvals(M).astype(complex)
    if family == "drift":  # in closed form: the two states that drift are triangular below the oscillator
        truth = np.r_[np.linalg.eigvals(M[:2, :2]), 1.0, 1.0].astype(complex)
        exact = bool(np.abs(truth[:2]).max() < 1)
    if family == "cluster":
        truth = np.tile(np.linalg.eigvals(M[:2, :2]), 2).astype(complex)
    if family == "undamped":
        half = (M[0, 0] + M[1, 1]) / 2
        exact = abs(half) < 1
        root = np.sqrt(complex(half**2 - 1))
        truth = np.array([half + root, half - root])
        truth = truth / np.abs(truth) if exact else truth
    speed = 10.0 ** rng.choice([0, 0, rng.uniform(-9, 9)])
    A = _turned(rng, mean + w.f(t)[:, None, None] * pump) * speed
    model = ltv(t * period / speed, A)
    if np.abs(np.ptp(model.A, axis=0)).max() == 0:
        return None
    return System(family, w.name, m, model, {"period": float(period / speed)}, truth, exact=exact)


def system(seed: int) -> System:
    rng = np.random.default_rng([seed, 11])
    names = list(FAMILIES)
    share = np.array(list(FAMILIES.values()), dtype=float)
    family = str(rng.choice(names, p=share / share.sum()))
    while True:
        if family in ("constant", "sampled", "chain"):
            return constant(rng, family)
        if family == "pieces":
            return pieces(rng)
        found = varying(rng, family)
        if found is not None:
            return found
