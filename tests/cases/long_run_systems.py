"""Systems that are neither constant nor periodic on their record and whose rate for ever is known in closed form.

"slow"       A = e^(-S t) A0 e^(S t), S skew and small: in y = e^(S t) x constant, A0 + S; frozen roots are those of A0
"decaying"   A = A0 + what decays: the rates are those of A0; told of the limit, or of how near A stays to its end
"almost"     A = e^(-S t) (B(t) - S) e^(S t), B triangular with a_i + sums of oscillations: the rates are a_i
"little"     one of these, unstable, of which the record shows growth less than tenfold
"edge"       "almost" with the largest rate exactly 0: nothing may be said but drift
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from known_systems import ltv
from scipy.linalg import expm

from pliant.plants import LTVModel

FAMILIES = ("slow", "decaying", "almost", "little", "edge")


@dataclass
class LongRun:
    """A model, what is told of the time after its record, and the largest rate [1/s] for ever."""

    family: str
    model: LTVModel
    options: dict[str, Any]
    truth: float


def long_run(seed: int) -> LongRun:
    """One of the five in turn."""
    rng = np.random.default_rng(seed)
    family = FAMILIES[seed % len(FAMILIES)]
    n = int(rng.integers(2, 5))
    if family == "little":
        return LongRun("little", *_little(rng, n))
    if family == "edge":
        return LongRun("edge", *_almost(rng, n, 0.0, float(rng.uniform(60, 200))))
    made = {"slow": _slow, "decaying": _decaying, "almost": _almost}[family]
    rate = float(rng.choice([-1, 1]) * rng.uniform(0.08, 0.6))
    return LongRun(
        family, *made(rng, n, rate, float(rng.uniform(60, 200) if family == "almost" else rng.uniform(8, 40)))
    )


def _skew(rng: np.random.Generator, n: int, size: float) -> np.ndarray:
    M = rng.standard_normal((n, n))
    return size * (M - M.T) / np.linalg.norm(M - M.T, 2)


def _with_rate(rng: np.random.Generator, n: int, rate: float) -> np.ndarray:
    """A random A0 whose rightmost root has that real part, the others 0.3 1/s or more to its left; well conditioned."""
    while True:
        M = rng.standard_normal((n, n))
        lam, V = np.linalg.eig(M)
        right = np.sort(np.unique(lam.real.round(9)))[::-1]
        if np.linalg.cond(V) < 10 and (len(right) == 1 or right[0] - right[1] > 0.3) and np.abs(lam).max() < 4:
            return M + (rate - right[0]) * np.eye(n)


def _turned(S: np.ndarray, t: np.ndarray, A: np.ndarray) -> np.ndarray:
    steps = expm(-S * (t[1] - t[0]))
    frames = [np.eye(len(S))]
    for _ in t[1:]:
        frames.append(steps @ frames[-1])
    F = np.array(frames)
    return F @ A @ F.transpose(0, 2, 1)


def _slow(rng: np.random.Generator, n: int, rate: float, T: float) -> tuple[LTVModel, dict[str, Any], float]:
    while True:
        A0 = _with_rate(rng, n, rate)
        S = _skew(rng, n, rng.uniform(0.05, 0.25) * abs(rate))
        truth = float(np.linalg.eigvals(A0 + S).real.max())
        if abs(truth) > 0.2 * abs(rate):
            t = np.linspace(0.0, T, 401)
            return ltv(t, _turned(S, t, np.broadcast_to(A0, (len(t), n, n)))), {}, truth


def _decaying(rng: np.random.Generator, n: int, rate: float, T: float) -> tuple[LTVModel, dict[str, Any], float]:
    A0, A1 = _with_rate(rng, n, rate), rng.standard_normal((n, n)) * rng.uniform(0.5, 3)
    t = np.linspace(0.0, T, 801)
    if rng.integers(2):
        shape = np.exp(-t * rng.uniform(3, 12) / T)
        options = {"beyond": "tends", "limit": A0}
    else:
        shape = (1 + t) ** -rng.uniform(2, 4)
        options = {"beyond": "tends", "within": float(shape[-1] * np.linalg.norm(A1, 2))}
    return ltv(t, A0 + shape[:, None, None] * A1), options, rate


def _almost(
    rng: np.random.Generator, n: int, rate: float, T: float, fastest: float = 3.0
) -> tuple[LTVModel, dict[str, Any], float]:
    t = np.linspace(0.0, T, int(T * fastest * 5) + 1)
    a = np.sort(rate - np.r_[0.0, rng.uniform(0.4, 2.0, n - 1).cumsum()])[::-1]
    B = np.zeros((len(t), n, n))
    for i in range(n):
        B[:, i, i] = a[i]
        for j in range(i, n):
            for w in rng.uniform(0.3, 1.0, 2) * fastest:
                B[:, i, j] += rng.uniform(0.0, 0.6) * np.cos(w * t + rng.uniform(0, 6))
    S = _skew(rng, n, rng.uniform(0.0, 1.0))
    return ltv(t, _turned(S, t, B - S)), {}, rate


def _little(rng: np.random.Generator, n: int) -> tuple[LTVModel, dict[str, Any], float]:
    rate = float(rng.uniform(0.05, 0.4))
    T = float(np.log(rng.uniform(1.5, 6.0)) / rate)
    kind = rng.integers(3)
    if kind == 0:
        return _slow(rng, n, rate, T)
    if kind == 1:
        return _decaying(rng, n, rate, T)
    return _almost(rng, n, rate, T, 60.0 / T + 6.0)
