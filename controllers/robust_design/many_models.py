"""One linear law for many sampled models: the sum of their quadratic costs, its exact gradient, its descent.

Models     x+ = A x + B u,  y = C x + v,   k = 1 .. m, padded to one size
Law        u = T_u [y; s],  s+ = T_s [y; s]: a static gain of outputs where it has no states s of its own
Cost       J(T) = mean_k sum over t of E (x'Q x + u'R u + 2 x'N u), from a random start of mean x0 and covariance X.
           What comes in every period of a motion, as v does, is counted as coming at once: V and X hold it so often
Gradient   dJ_k/dT = 2 [(R T C + N' + B'P F) X C' + (R + B'P B) T V],  F = A + B T C, with the two Lyapunov equations
           P = F'P F + Q + .., X = F X F' + X_0 + B T V T'B'  (Levine and Athans 1970, "On the determination of the
           optimal constant output feedback gains", in discrete time; many models: Ackermann 1980, "Parameter space
           design of robust control systems")

Where the first law is unstable on some model, the cost is discounted, F becomes g F with g below 1 over the largest
|z|, and g is raised to 1 as the law gets better. No certificate: what it finds is a local minimum that is stable on
each of the models that it was given, and says nothing of what is between them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

Array = np.ndarray
Structure = Callable[[Array], tuple[Array, Callable[[Array], Array]]]  # theta -> (T, dJ/dT -> dJ/dtheta)

DOUBLINGS = 40  # of a Lyapunov sum: 2^40 periods
SETTLED = 1e-12  # share of the sum that a doubling still adds
INSIDE = 0.999  # largest g |z| with which a discount is begun


@dataclass(frozen=True, eq=False)
class Models:
    """Stacked over k: A (m, n, n), B (m, n, nu), C (m, ny, n), Q, R, N of the cost, V (m, ny, ny), and of the start its
    mean x0 (m, n) and covariance X (m, n, n)."""

    A: Array
    B: Array
    C: Array
    Q: Array
    R: Array
    N: Array
    X: Array
    V: Array
    x0: Array

    @classmethod
    def of(cls, parts: Sequence[tuple[Array, ...]]) -> Models:
        """From (A, B, C, Q, R, N, X, V, x0 (n, 1)) of each; states that the smaller ones lack are zero and stay so."""
        n = max(len(part[0]) for part in parts)

        def wide(M: Array, rows: bool, columns: bool) -> Array:
            grown = ((0, n - M.shape[0] if rows else 0), (0, n - M.shape[1] if columns else 0))
            return np.pad(M, grown)

        ways = ((1, 1), (1, 0), (0, 1), (1, 1), (0, 0), (1, 0), (1, 1), (0, 0), (1, 0))
        stacks = [np.stack([wide(p[i], bool(r), bool(c)) for p in parts]) for i, (r, c) in enumerate(ways)]
        stacks[-1] = stacks[-1][..., 0]
        return cls(*stacks)

    def with_history(self, ny: int, readings: int) -> Models:
        """For laws that know `readings` of the first ny outputs besides the newest: states of the law, which join each
        model's states, what is read, and the inputs. All of them are the first reading at the start."""
        m = ny * readings
        if not m:
            return self

        def join(M: Array, corner: float) -> Array:
            rows, columns = M.shape[1:]
            made = np.pad(M, ((0, 0), (0, m), (0, m)))
            made[:, rows:, columns:] = corner * np.eye(m)
            return made

        corners = (0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        parts = (self.A, self.B, self.C, self.Q, self.R, self.N, self.X, self.V)
        first = np.einsum("kij,kj->ki", self.C[:, :ny], self.x0)
        x0 = np.hstack([self.x0, np.tile(first, (1, readings))])
        return Models(*[*(join(M, corner) for M, corner in zip(parts, corners, strict=True)), x0])


class Costed(NamedTuple):
    """At one law: J, dJ/dT, J of each model (m,) and its largest |z| (m,)."""

    cost: float
    slope: Array
    each: Array
    radii: Array


def _t(M: Array) -> Array:
    return np.swapaxes(M, -1, -2)


def lyapunov(F: Array, W: Array) -> Array:
    """sum over t of F^t W F'^t (m, n, n), by doubling; not finite where some F is not stable."""
    total, power = W, F
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(DOUBLINGS):
            more = power @ total @ _t(power)
            total = total + more
            size = np.abs(more).max()
            if not np.isfinite(size) or size <= SETTLED * np.abs(total).max():
                break
            power = power @ power
    return total


def radii(models: Models, T: Array) -> Array:
    """Largest |z| of each loop (m,)."""
    return np.asarray(np.abs(np.linalg.eigvals(models.A + models.B @ T @ models.C)).max(axis=1))


def cost(models: Models, T: Array, discount: float = 1.0) -> Costed:
    """J and its slope under the law T (nu, ny); J is infinite where `discount` times a loop is not stable."""
    F = models.A + models.B @ T @ models.C
    z = np.abs(np.linalg.eigvals(F)).max(axis=1)
    if not discount * z.max() < 1:
        return Costed(np.inf, np.zeros_like(T), np.full(len(F), np.inf), z)
    TC, g = T @ models.C, discount
    cross = models.N @ TC
    weight = models.Q + cross + _t(cross) + _t(TC) @ models.R @ TC
    noise = T @ models.V @ T.T
    P = lyapunov(g * _t(F), weight)
    drive = models.X + models.x0[:, :, None] * models.x0[:, None, :] + models.B @ noise @ _t(models.B)
    X = lyapunov(g * F, drive)
    each = np.einsum("kij,kji->k", P, drive) + np.einsum("kij,kji->k", models.R, noise)
    PB = P @ models.B
    slope = (models.R @ TC + _t(models.N) + g * g * _t(PB) @ F) @ X @ _t(models.C)
    slope = slope + (models.R + _t(models.B) @ PB) @ T @ models.V
    return Costed(float(each.mean()), 2 * slope.mean(axis=0), each, z)


def descend(
    models: Models, theta: Array, structure: Structure, scale: Array, *, iterations: int = 400
) -> tuple[Array, Costed]:
    """A law's parameters theta (n,) at a local minimum of J, found from `theta`, and what it is worth.

    structure: from theta to T and back for slopes. scale (n,): typical size of each parameter. The discount is raised
    step by step where the start is not stable on all models; where it does not reach 1 the cost returned is infinite.
    """
    theta = np.array(theta, dtype=float)
    T, _ = structure(theta)
    worst = float(radii(models, T).max())
    discount = min(1.0, INSIDE / worst)
    left = iterations
    while True:
        theta, used = _bfgs(models, theta, structure, scale, discount, left if discount == 1.0 else min(left, 60))
        left -= used
        T, _ = structure(theta)
        if discount == 1.0 or left <= 0:
            return theta, cost(models, T)
        worst = float(radii(models, T).max())
        discount = min(1.0, max(INSIDE / worst, discount + 1e-9))


def _bfgs(
    models: Models, theta: Array, structure: Structure, scale: Array, discount: float, most: int
) -> tuple[Array, int]:
    """(theta after at most `most` steps of Broyden, Fletcher, Goldfarb and Shanno with backtracking, steps)."""

    def at(z: Array) -> tuple[float, Array]:
        T, back = structure(scale * z)
        found = cost(models, T, discount)
        return float(np.log(found.cost)), (scale * back(found.slope) / found.cost if np.isfinite(found.cost) else z)

    z = theta / scale
    f, g = at(z)
    H = np.eye(len(z)) * 0.1 / max(float(np.linalg.norm(g)), 1e-12)
    for k in range(most):
        step = -H @ g
        slope = float(g @ step)
        if slope >= 0:
            H, step = np.eye(len(z)) * 0.1 / float(np.linalg.norm(g)), -0.1 * g / float(np.linalg.norm(g))
            slope = float(g @ step)
        length = 1.0
        for _ in range(30):
            new, slopes = at(z + length * step)
            if new <= f + 1e-4 * length * slope:
                break
            length *= 0.4
        else:
            return scale * z, k + 1
        s, y = length * step, slopes - g
        done = f - new < 1e-6
        z, f, g = z + s, new, slopes
        if s @ y > 1e-12 * np.linalg.norm(s) * np.linalg.norm(y):
            if k == 0:
                H = np.eye(len(z)) * float(s @ y) / float(y @ y)
            r = 1 / float(s @ y)
            Hy = H @ y
            H = H - r * (np.outer(s, Hy) + np.outer(Hy, s)) + (r * r * float(y @ Hy) + r) * np.outer(s, s)
        if done:
            return scale * z, k + 1
    return scale * z, most
