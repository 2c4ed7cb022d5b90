"""Random models with weights, noise and units: what designs must not depend on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.linalg as sla

from pliant.plants import LinearModel, LTVModel
from pliant.plants.core.matrix_roots import semidefinite_root

DECADES = 9


@dataclass(frozen=True)
class Case:
    """dx/dt = A x + B u + E w, y = C x + v; weights Q, R, N; W, V; sampled at dt."""

    A: Any
    B: Any
    E: Any
    C: Any
    Q: Any
    R: Any
    N: Any
    W: Any  # (nw,) densities
    V: Any  # (ny,) densities, or variances of samples
    dt: float

    def scaled(self, units: Units) -> Case:
        s, u, w, y, t, c = units.x, units.u, units.w, units.y, units.t, units.cost
        ss, uu = s[:, None], u[:, None]
        return Case(
            ss * self.A / s / t,
            ss * self.B / u / t,
            ss * self.E / w / t,
            y[:, None] * self.C / s,
            c / t * self.Q / ss / s,
            c / t * self.R / uu / u,
            c / t * self.N / ss / u,
            w**2 * self.W * t,
            y**2 * self.V,
            t * self.dt,
        )


@dataclass(frozen=True)
class Units:
    x: Any
    u: Any
    w: Any
    y: Any
    t: float
    cost: float


def units_for(rng, nx: int, nu: int, nw: int, ny: int) -> Units:
    x, u, w, y = (10.0 ** rng.uniform(-DECADES, DECADES, n) for n in (nx, nu, nw, ny))
    return Units(x, u, w, y, *(10.0 ** rng.uniform(-DECADES, DECADES, 2)))


def plant(rng, free: int) -> np.ndarray:
    """A (nx, nx) in even units, with at most `free` rigid bodies: an input reaches one of them, a reading sees one."""
    count, high = int(rng.integers(1, 31)) if rng.random() < 0.3 else int(rng.integers(1, 7)), rng.choice([2.0, 4.0])
    blocks = []
    for _ in range(count):
        w, kind = (
            10 ** rng.uniform(0, high),
            rng.choice(["rigid", "undamped", "damped", "first"], p=[0.2, 0.4, 0.3, 0.1]),
        )
        free -= kind == "rigid"
        if free < 0:
            kind = "damped"
        if kind == "first":
            blocks.append(np.array([[w * rng.choice([-1.0, 0.1])]]))
        else:
            zeta = 0.0 if kind == "undamped" else 10 ** rng.uniform(-3, -0.5)
            blocks.append(
                np.array([[0.0, 1.0], [0.0, 0.0]]) if kind == "rigid" else w * np.array([[0, 1.0], [-1.0, -2 * zeta]])
            )
    return sla.block_diag(*blocks)


def case(seed: int) -> tuple[Case, np.random.Generator]:
    rng = np.random.default_rng(seed)
    nu, ny = int(rng.integers(1, 4)), int(rng.integers(1, 4))
    A = plant(rng, min(nu, ny))
    n = len(A)
    B, C = rng.normal(size=(n, nu)), rng.normal(size=(ny, n))
    E = rng.normal(size=(n, nu))
    root = rng.normal(size=(nu, nu)) + 2 * np.eye(nu)
    R = root @ root.T * 10 ** rng.uniform(-3, 3)
    Q = np.diag(10 ** rng.uniform(-2, 2, n)) if rng.random() < 0.5 else C.T @ C
    N = np.zeros((n, nu))
    if rng.random() < 0.4:  # x'Qx + 2 x'Nu + u'Ru >= 0: a part of the root of each
        N = 0.5 * semidefinite_root(Q)[:, -min(n, nu) :] @ np.linalg.cholesky(R).T[: min(n, nu)]
    if n <= 12 and rng.random() < 0.4 and np.abs(A).max() < 200:  # coordinates that mix the modes
        T = np.linalg.qr(rng.normal(size=(n, n)))[0]
        A, B, E, C, Q, N = T @ A @ T.T, T @ B, T @ E, C @ T.T, T @ Q @ T.T, T @ N
    Q = (Q + Q.T) / 2
    W, V = 10 ** rng.uniform(-4, 2, nu), 10 ** rng.uniform(-10, 0, ny)
    dt = 0.3 / max(np.abs(np.linalg.eigvals(A)).max(), 1.0) * 10 ** rng.uniform(0, 1)
    return Case(A, B, E, C, Q, R, N, W, V, float(dt)), rng


def rounded(c: Case, rng) -> Case:
    """Every entry off by a rounding: what that changes, no design can know."""
    eps = np.finfo(float).eps
    near = {k: v * (1 + eps * rng.choice([-1.0, 1.0], size=np.shape(v))) for k, v in vars(c).items() if k != "dt"}
    return replace(c, **(near | {k: (near[k] + near[k].T) / 2 for k in "QR"}))


def model_of(c: Case) -> LinearModel:
    return LinearModel.from_matrices(c.A, c.B, c.C, E=c.E)


def ltv_of(c: Case) -> LTVModel:
    """A(t) = (1 + t/10) A and so on, 20 nodes."""
    n, nu, ny = *c.B.shape, len(c.C)
    t, z = c.dt * np.arange(20), np.zeros
    grow = (1 + np.arange(20) / 200)[:, None, None]
    parts = grow * c.A, grow * c.B, grow * c.E, grow * c.C, z((20, ny, nu)), z((20, ny, c.E.shape[1]))
    rows = {"c": z((20, n)), "x": z((20, n)), "u": z((20, nu)), "w": z((20, c.E.shape[1])), "y": z((20, ny))}
    m = model_of(c)
    return LTVModel(t, *parts, **rows, states=m.states, inputs=m.inputs, disturbances=m.disturbances, outputs=m.outputs)
