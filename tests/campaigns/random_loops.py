"""Random plants with a law each, and their loops put together here, apart from the code under test."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg as sla

from pliant.controllers import LQR, Feedback
from pliant.controllers.analysis.linear_laws import LinearLaw
from pliant.plants import LinearModel

Array = Any
ROUNDING = 1e-9  # of the fastest pole: growth that eigenvalues of a loop inside a claim may show
STAYS = 1e-5  # of the fastest pole: nearer to zero, a pole of the closed loop is one that no input moves


class Wrong(Exception):
    """A claim that does not hold."""


def modes(rng) -> tuple[Array, Array]:
    """A (nx, nx), of one to four parts, and its oscillating eigenvalues."""
    parts, shaking = [], []
    for _ in range(int(rng.integers(1, 5))):
        w = 10 ** rng.uniform(-0.5, 1.2)
        kind = rng.choice(["damped", "undamped", "grows", "rigid", "lag", "away"], p=[0.4, 0.15, 0.1, 0.1, 0.15, 0.1])
        if kind in ("lag", "away"):
            parts.append([[-w if kind == "lag" else 0.1 * w]])
            continue
        zeta = {"damped": 10 ** rng.uniform(-2.5, -0.4), "grows": -0.02}.get(kind, 0.0)
        w = 0.0 if kind == "rigid" else w
        parts.append([[0.0, 1.0], [-(w**2), -2 * zeta * w]])
        shaking += [w * (-zeta + 1j * np.sqrt(1 - zeta**2))] if w else []
    return sla.block_diag(*parts), np.array(shaking)


def case(rng) -> tuple[LinearModel, Any, float | None]:
    """A model, a law that holds it, and the law's period."""
    A, _ = modes(rng)
    n, nu = len(A), int(rng.integers(1, 4))
    B = rng.standard_normal((n, nu))
    fastest = np.abs(np.linalg.eigvals(A)).max()
    dt = None if rng.random() < 0.4 else float(10 ** rng.uniform(-1, 1) / max(fastest, 0.3))
    states = LinearModel.from_matrices(A, B)
    weights = np.eye(n), 10 ** rng.uniform(-2, 1) * np.eye(nu)
    if rng.random() < 0.4:
        return states, LQR.design(states, *weights, dt=dt), dt
    ny, m = int(rng.integers(1, 4)), int(rng.integers(0, 3))
    C, D = rng.standard_normal((ny, n)), rng.standard_normal((ny, nu)) * (rng.random() < 0.5)
    model = LinearModel.from_matrices(A, B, C, D)
    for size in 10 ** rng.uniform(-2.5, 0.5, 30):
        S = -np.diag(rng.uniform(1, 10, m)) if dt is None else np.diag(rng.uniform(0, 0.9, m))
        parts = (
            S,
            rng.standard_normal((m, ny)),
            size * rng.standard_normal((nu, m)),
            size * rng.standard_normal((nu, ny)),
        )
        law = Feedback(parts[3], model.output_names, dt=dt) if not m else LinearLaw(*parts, model.output_names, dt)
        if growth(closed(series(model, law, dt, "input"), np.ones(nu)), dt) < -1e-6:
            return model, law, dt
    return states, LQR.design(states, *weights, dt=dt), dt  # where no such law holds the plant


def parts_of(law) -> tuple[Array, Array, Array, Array]:
    """A, B, C, D of a law u = -(C s + D y)."""
    if isinstance(law, LinearLaw):
        return law.A, law.B, law.C, law.D
    return np.zeros((0, 0)), np.zeros((0, law.K.shape[1])), np.zeros((len(law.K), 0)), law.K


def held(A: Array, B: Array, dt: float) -> tuple[Array, Array]:
    """E, G of x+ = E x + G u with u held over dt."""
    n, nu = B.shape
    both = sla.expm(dt * np.block([[A, B], [np.zeros((nu, n + nu))]]))
    return both[:n, :n], both[:n, n:]


def plant(model: LinearModel, law) -> tuple[Array, Array, Array, Array]:
    """A, B, C, D of what the law reads: the states, or the outputs."""
    nx, nu = model.B.shape
    if isinstance(law, LQR):
        return model.A, model.B, np.eye(nx), np.zeros((nx, nu))
    return model.A, model.B, model.C, model.D


def series(model: LinearModel, law, dt: float | None, at: str) -> tuple[Array, Array, Array, Array]:
    """L of the loop cut at the inputs or the readings; a sampled reading sees the input held before."""
    A, B, C, D = plant(model, law)
    if dt is not None:
        nu = B.shape[1]
        A, B = held(A, B, dt)
        A = sla.block_diag(A, np.zeros((nu, nu)))
        B, C, D = np.vstack([B, np.eye(nu)]), np.hstack([C, D]), 0 * D
    (A1, B1, C1, D1), (A2, B2, C2, D2) = ((A, B, C, D), parts_of(law))[:: 1 if at == "input" else -1]
    wide = np.block([[A1, np.zeros((len(A1), len(A2)))], [B2 @ C1, A2]])
    return wide, np.vstack([B1, B2 @ D1]), np.hstack([D2 @ C1, C2]), D2 @ D1


def closed(L, factors: Array) -> Array:
    """A of the loop e = -f (C x + D e)."""
    A, B, C, D = L
    return A - B @ np.linalg.solve(np.eye(len(D)) + factors[:, None] * D, factors[:, None] * C)


def alone(L, i: int) -> tuple[Array, Array, Array, float]:
    """Channel i of the loop with the others closed."""
    A, B, C, D = L
    o = np.delete(np.arange(len(D)), i)
    M = np.linalg.inv(np.eye(len(o)) + D[np.ix_(o, o)])
    return (
        A - B[:, o] @ M @ C[o],
        B[:, i] - B[:, o] @ M @ D[o, i],
        C[i] - D[i, o] @ M @ C[o],
        float(D[i, i] - D[i, o] @ M @ D[o, i]),
    )


def growth(A: Array, dt: float | None, left: int = 0) -> Array:
    """Of the fastest growing pole, against the fastest; of matrices (.., n, n). `left`: of those at rest, not seen:
    a double one, of a rigid body that no input moves, rounding takes apart by the root of 2^-52, to either side."""
    poles = np.linalg.eigvals(A)
    rest = np.argsort(np.abs(poles - (0 if dt is None else 1)), axis=-1)
    moved = np.take_along_axis(poles, rest[..., left:], axis=-1)
    if dt is not None:
        return np.abs(moved).max(axis=-1) - 1
    return moved.real.max(axis=-1) / np.maximum(np.abs(poles).max(axis=-1), 1e-300)


def resting(A: Array, dt: float | None) -> int:
    """How many poles of a closed loop (n, n) are at rest."""
    poles = np.linalg.eigvals(A)
    off = np.abs(poles - (0 if dt is None else 1))
    return int((off < STAYS * (np.abs(poles).max() if dt is None else 1.0)).sum())


def expect(holds: bool, worst: float, words: str) -> None:
    """Wrong where a loop that should hold grows, or one that should not decays."""
    if (worst > ROUNDING) if holds else (worst < -1e-12):
        raise Wrong(f"{words}: {worst:.2g}")
