"""How long a stability verdict takes, and a chart of verdicts over two parameters on two processors."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from harness.sampling import TIME, Case, clock
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from pliant.plants import LTVModel
from pliant.plants.core.signals import Signal
from pliant.plants.stability import assess, finite_horizon
from pliant.studies.stability.parameter_map import map_stability

GROUP = "stability"
VERDICT = "assess, 20 states, 2,000 steps of a period"
POINT = "assess, 8 states, one point of a chart"
CHART = "chart of 64 x 64 points, 8 states"
NUMBERS = "numbers of a finite horizon, 20 states, 2,000 steps"
RICCATI = "its Gramian by scipy's solve_ivp, rtol 1e-6"
LARGE = "assess, 120 states, 2,000 steps of a period"
LARGE_NUMBERS = "numbers of a finite horizon, 120 states, 400 steps"
LARGE_RICCATI = "its Gramian by scipy's solve_ivp, 120 states, rtol 1e-6"


def periodic(t: np.ndarray, mean: np.ndarray, pulse: np.ndarray, damping: np.ndarray, nu: float) -> LTVModel:
    """q'' + D q' + (K + K1 cos nu t) q = 0 at the times t (nt,) [s]."""
    n, nt = len(mean), len(t)
    A = np.zeros((nt, 2 * n, 2 * n))
    A[:, :n, n:], A[:, n:, n:] = np.eye(n), -damping
    A[:, n:, :n] = -mean - np.cos(nu * t)[:, None, None] * pulse
    none, rows = np.zeros((nt, 2 * n, 0)), {k: np.zeros((nt, 2 * n if k in "cx" else 0)) for k in ("c", "x", "u", "y")}
    gone = {"C": np.zeros((nt, 0, 2 * n)), "D": np.zeros((nt, 0, 0)), "F": np.zeros((nt, 0, 0))}
    names = tuple(f"x{i}" for i in range(2 * n))
    return LTVModel(t, A, none, none, **gone, **rows, states=names, inputs=(), disturbances=(), outputs=())


def large(modes: int = 10, fastest: float = 12.0, steps: int = 2000) -> LTVModel:
    """20 states, all coupled, 2,000 steps; or as many and as fast as asked."""
    rng = np.random.default_rng(1)
    V, omega = np.linalg.qr(rng.standard_normal((modes, modes)))[0], np.linspace(1.0, fastest, modes)
    pulse = rng.standard_normal((modes, modes))
    t = np.linspace(0.0, 2 * np.pi / 1.5, steps + 1)
    return periodic(t, V * omega**2 @ V.T, 0.05 * (pulse + pulse.T), V * (0.04 * omega) @ V.T, 1.5)


def pushed(model: LTVModel) -> LTVModel:
    """The same with one force on the first coordinate, which is the output."""
    nt, n = model.A.shape[:2]
    E, C = np.zeros((nt, n, 1)), np.zeros((nt, 1, n))
    E[:, n // 2], C[:, 0, 0] = 1.0, 1.0
    matrices: dict[str, Any] = {
        "E": E,
        "C": C,
        "D": np.zeros((nt, 1, 0)),
        "F": np.zeros((nt, 1, 1)),
        "y": np.zeros((nt, 1)),
        "w": np.zeros((nt, 1)),
    }
    return replace(model, **matrices, disturbances=(Signal("push", "N"),), outputs=(Signal("reach", "m"),))


def numbers(model: LTVModel) -> None:
    """Peak by energy and within limits, bounds of both."""
    told = finite_horizon(model)
    assert told.peak["reach"].upper > 0 and told.bounded["reach"].upper > 0


def riccati(model: LTVModel) -> None:
    """dW/dt = A W + W A' + E E' alone, which gives the first of the two numbers."""
    n, A = model.A.shape[-1], CubicSpline(model.t, model.A)
    push = model.E[0] @ model.E[0].T

    def rate(t: float, flat: np.ndarray) -> np.ndarray:
        moved = A(t) @ flat.reshape(n, n)
        return np.asarray((moved + moved.T + push).ravel())

    solve_ivp(rate, (model.t[0], model.t[-1]), np.zeros(n * n), rtol=1e-6, atol=1e-9)


def point(depth: float, frequency: float) -> LTVModel:
    """8 states, one spring pulsating."""
    V = np.linalg.qr(np.random.default_rng(3).standard_normal((4, 4)))[0]
    t = np.linspace(0.0, 2 * np.pi / frequency, 129)
    pulse = depth * np.diag([1.0, 0.0, 0.0, 0.0])
    return periodic(t, V * np.array([1.0, 2.3, 3.9, 6.1]) ** 2 @ V.T, pulse, 0.02 * np.eye(4), frequency)


def chart() -> None:
    grid = {"depth": np.linspace(0.0, 2.0, 64), "frequency": np.linspace(1.0, 5.0, 64)}
    map_stability(point, grid, jobs=2)


def repeated(call: Callable[[], object], watch: Callable[[], float] = clock) -> Callable[[], Callable[[float], float]]:
    """Prepares the call once; a sample is its mean time [s] over as many calls as fit, at least one. watch: the wall's
    clock where workers that go on living do the work, whose processor time is nobody's."""

    def sample(seconds: float) -> float:
        began, calls = watch(), 0
        while calls == 0 or watch() - began < seconds:
            call()
            calls += 1
        return (watch() - began) / calls

    def prepare() -> Callable[[float], float]:
        call()
        return sample

    return prepare


def cases() -> Iterator[Case]:
    model, small = large(), point(0.7, 2.1)
    yield Case(group=GROUP, name=VERDICT, prepare=repeated(lambda: assess(model)), unit=TIME)
    force = pushed(model)
    yield Case(group=GROUP, name=NUMBERS, prepare=repeated(lambda: numbers(force)), unit=TIME)
    yield Case(group=GROUP, name=RICCATI, prepare=repeated(lambda: riccati(force)), unit=TIME)
    most, fewer = large(60, 60.0), pushed(large(60, 60.0, 400))
    yield Case(group=GROUP, name=LARGE, prepare=repeated(lambda: assess(most)), unit=TIME, rounds=3)
    yield Case(group=GROUP, name=LARGE_NUMBERS, prepare=repeated(lambda: numbers(fewer)), unit=TIME, rounds=3)
    yield Case(group=GROUP, name=LARGE_RICCATI, prepare=repeated(lambda: riccati(fewer)), unit=TIME, rounds=3)
    yield Case(group=GROUP, name=POINT, prepare=repeated(lambda: assess(small, thorough=False)), unit=TIME)
    yield Case(group=GROUP, name=CHART, prepare=repeated(chart, time.perf_counter), unit=TIME, threads=2, rounds=3)
