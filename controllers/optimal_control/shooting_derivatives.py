"""The control period of a plant over many lanes, with its first and second derivatives.

x+ = F(x, u): `substeps` RK4 steps over dt with u held. First derivatives follow the stages forward, from df/d(x, u);
the Hessian of m'F is a sum over the stages i, S_i' (d2 a_i'f) S_i, with S_i the stage's sensitivity to (x, u) and a_i
the adjoint of its slope, swept backward. All exact to rounding, at a few evaluations of f a stage; f and its
derivatives run on native kernels.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from pliant.plants.core.parameters import require_count
from pliant.plants.native.batch_kernels import NativeFunction, random_points
from pliant.plants.native.scalar_codegen import operations

if TYPE_CHECKING:
    from pliant.plants.dynamics.plant import Plant

LONG = 10_000  # operations of one compiled piece: 2 s for gcc, where twice that takes 15 s


class Derivatives:
    """f, df/d(x, u) and d2(m'f)/d(x, u)^2 of a plant, for lanes."""

    def __init__(self, plant: Plant) -> None:
        self.plant, self.nx, self.nz = plant, plant.nx, plant.nx + plant.nu
        self._points = random_points(plant, np.random.default_rng(0))
        f, self._z = ca.densify(plant.expressions[0]), ca.vertcat(plant.symbols[1], plant.symbols[2])
        whole = ca.vertcat(f, ca.vec(ca.densify(ca.jacobian(f, self._z))))
        self._slope = self._pieces("slope", list(plant.symbols), whole, self._points)
        self._curvature: list[NativeFunction] | None = None

    def slope(self, t: np.ndarray, x: np.ndarray, u: np.ndarray, w: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        """f (B, nx) and df/d(x, u) (B, nx, nx + nu)."""
        B, nx = len(x), self.nx
        pieces = [f(t, x, u, w, p, batch=B)[0] for f in self._slope]
        both = pieces[0] if len(pieces) == 1 else np.concatenate(pieces, axis=1)
        return [both[:, :nx], both[:, nx:].reshape(B, self.nz, nx).transpose(0, 2, 1)]

    def curvature(
        self, t: np.ndarray, x: np.ndarray, u: np.ndarray, w: np.ndarray, p: np.ndarray, m: np.ndarray
    ) -> np.ndarray:
        """d2(m'f)/d(x, u)^2 (B, nx + nu, nx + nu) for m (B, nx)."""
        if self._curvature is None:
            self._build_curvature()
        assert self._curvature is not None
        found = np.zeros((len(x), self.nz, self.nz))
        if len(self._rows):
            values = np.concatenate([f(t, x, u, w, p, m, batch=len(x))[0] for f in self._curvature], axis=1)
            found[:, self._rows, self._columns] = values
            found[:, self._columns, self._rows] = values
        return found

    def _build_curvature(self) -> None:
        plant = self.plant
        m = ca.SX.sym("m", plant.nx)
        lower = ca.tril(ca.hessian(ca.dot(m, plant.expressions[0]), self._z)[0])
        self._rows, self._columns = (np.array(k, dtype=int) for k in lower.sparsity().get_triplet())
        points = [*self._points, np.random.default_rng(1).normal(size=(plant.nx, self._points[0].shape[1]))]
        entries = ca.SX(lower.nz[:])
        self._curvature = self._pieces("curvature", [*plant.symbols, m], entries, points) if lower.nnz() else []

    def _pieces(
        self, name: str, symbols: list[ca.SX], entries: ca.SX, points: list[np.ndarray]
    ) -> list[NativeFunction]:
        """The entries by functions that compile in seconds, halved until each does."""
        made = ca.Function(name, symbols, ca.cse([entries]))
        if operations(made) <= LONG or entries.numel() == 1:
            return [NativeFunction(made, points)]
        middle = entries.numel() // 2
        halves = entries[:middle], entries[middle:]
        return [piece for half in halves for piece in self._pieces(name, symbols, half, points)]


@lru_cache(maxsize=16)
def derivatives(plant: Plant) -> Derivatives:
    """The derivatives of a plant, built once."""
    return Derivatives(plant)


class HeldSteps:
    """F over B lanes at the times t (B,) at which the periods begin."""

    def __init__(self, plant: Plant, dt: float, substeps: int, t: np.ndarray, w: np.ndarray, p: np.ndarray) -> None:
        require_count("shooting", "substeps", substeps, 1, 100_000)
        self.h, self.substeps = dt / substeps, substeps
        self.given = derivatives(plant)
        self.t, self.w, self.p = t[:, None], np.tile(w, (len(t), 1)), np.tile(p, (len(t), 1))

    def ends(self, x: np.ndarray, u: np.ndarray) -> np.ndarray:
        """F (B, nx)."""
        h = self.h
        for j in range(self.substeps):
            t = self.t + j * h

            def f(t: np.ndarray, x: np.ndarray) -> np.ndarray:
                return self.given.slope(t, x, u, self.w, self.p)[0]

            k1 = f(t, x)
            k2 = f(t + h / 2, x + h / 2 * k1)
            k3 = f(t + h / 2, x + h / 2 * k2)
            x = x + h / 6 * (k1 + 2 * (k2 + k3) + f(t + h, x + h * k3))
        return x

    def slopes(self, x: np.ndarray, u: np.ndarray, *, keep: bool = False) -> Expansion:
        """F and dF/d(x, u) (B, nx, nx + nu); `keep` keeps the stages for `Expansion.hessian`."""
        return Expansion(self, x, u, keep)


class Expansion:
    """F (B, nx) and its derivatives about (x, u)."""

    def __init__(self, steps: HeldSteps, x: np.ndarray, u: np.ndarray, keep: bool) -> None:
        self.steps, self.u = steps, u
        B, nx, nz = len(x), x.shape[1], x.shape[1] + u.shape[1]
        h = steps.h
        S = np.zeros((B, nx, nz))
        S[:, :, :nx] = np.eye(nx)
        self.stages: list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]] = []  # t, x, S, df/dx of each

        def stage(t: np.ndarray, x: np.ndarray, S: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            k, J = steps.given.slope(t, x, u, steps.w, steps.p)
            K = J[:, :, :nx] @ S
            K[:, :, nx:] += J[:, :, nx:]
            if keep:
                self.stages.append((t, x, S, J[:, :, :nx]))
            return k, K

        for j in range(steps.substeps):
            t = steps.t + j * h
            k1, K1 = stage(t, x, S)
            k2, K2 = stage(t + h / 2, x + h / 2 * k1, S + h / 2 * K1)
            k3, K3 = stage(t + h / 2, x + h / 2 * k2, S + h / 2 * K2)
            k4, K4 = stage(t + h, x + h * k3, S + h * K3)
            x = x + h / 6 * (k1 + 2 * (k2 + k3) + k4)
            S = S + h / 6 * (K1 + 2 * (K2 + K3) + K4)
        self.end, self.slope = x, S

    def hessian(self, m: np.ndarray) -> np.ndarray:
        """d2(m'F)/d(x, u)^2 (B, nx + nu, nx + nu) for m (B, nx)."""
        h, steps = self.steps.h, self.steps
        adjoints: list[np.ndarray] = []
        for j in range(len(self.stages) - 4, -1, -4):
            J1, J2, J3, J4 = (self.stages[j + i][3] for i in range(4))
            a4 = h / 6 * m
            b4 = _back(J4, a4)
            a3 = h / 3 * m + h * b4
            b3 = _back(J3, a3)
            a2 = h / 3 * m + h / 2 * b3
            b2 = _back(J2, a2)
            a1 = h / 6 * m + h / 2 * b2
            m = m + _back(J1, a1) + b2 + b3 + b4
            adjoints += [a4, a3, a2, a1]
        n, (B, nx, nz) = len(self.stages), self.slope.shape
        t, x, S = (np.concatenate([s[i] for s in self.stages]) for i in range(3))
        u, w, p = (np.tile(v, (n, 1)) for v in (self.u, steps.w, steps.p))
        H = steps.given.curvature(t, x, u, w, p, np.concatenate(adjoints[::-1]))
        wide = np.zeros((n * B, nz, nz))
        wide[:, :nx] = S
        wide[:, nx:, nx:] = np.eye(nz - nx)
        return (wide.transpose(0, 2, 1) @ (H @ wide)).reshape(n, B, nz, nz).sum(axis=0)


def _back(J: np.ndarray, a: np.ndarray) -> np.ndarray:
    """J'a, lane by lane."""
    return np.einsum("bij,bi->bj", J, a)
