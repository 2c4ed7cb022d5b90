"""A state matrix that depends on parameters, as a linear system with the parameters fed back.

    dx/dt or x[k+1] = A x + B w,   v = C x + D w,   w = Delta v,   Delta = diag(delta_1 I, .., delta_k I, E)

delta_i, real, in [-1, 1] from one end of a parameter's interval to the other; E a full block of norm one for what the
form lacks. The state matrix is A + B Delta (I - D Delta)^-1 C.

`fitted` takes any smooth A(delta): a polynomial of total degree two by least squares on a grid,

    A(delta) = A_0 + sum_i delta_i (A_i + sum_(j >= i) delta_j A_ij),

with A_i + .. of the least ranks to rounding. What is left is measured at other points, corners among them, and covered
by E with `SAFETY` times what was measured: no more than that is known of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import combinations_with_replacement, product

import numpy as np

from pliant.plants.core.signals import OwnsArrays

from .blocks import Block

Array = np.ndarray
GRID = (-1.0, -0.5, 0.0, 0.5, 1.0)
MOST_GRID = 3  # parameters with a full grid
POINTS, CHECKED = 150, 150
CORNERS = 6  # parameters of which all corners are looked at
RANK = 1e-7  # relative singular values that count
SAFETY = 1.3
NOTHING = 1e-9  # of |A|: what is left that needs no cover


@dataclass(frozen=True, eq=False)
class FractionalForm(OwnsArrays):
    """A (n, n), B (n, m), C (m, n), D (m, m), blocks of the m rows; dt [s] of a sampled system."""

    A: Array = field(repr=False)
    B: Array = field(repr=False)
    C: Array = field(repr=False)
    D: Array = field(repr=False)
    blocks: tuple[Block, ...]
    dt: float | None = None
    left: float = 0.0  # largest |what the form lacks| / |A| that was measured: covered by the last block

    def at(self, delta: Array) -> Array:
        """The state matrix (n, n) with real blocks of delta (k,), other blocks at zero."""
        values = np.concatenate(
            [np.full(b.size, d) for b, d in zip([b for b in self.blocks if b.kind == "real"], delta)]
            + [np.zeros(b.size) for b in self.blocks if b.kind != "real"]
        )
        w = values[:, None] * np.linalg.solve(np.eye(len(self.D)) - self.D * values, self.C)
        return np.asarray(self.A + self.B @ w)


def fitted(state_matrix: Callable[[Array], Array], count: int, dt: float | None = None) -> FractionalForm:
    """The form of a function of delta (count,) in [-1, 1]."""
    points, checked = _points(count)
    values = np.array([state_matrix(d) for d in points])
    n = values.shape[-1]
    unit = _units(values)
    values = values * unit / unit[:, None]
    pairs = list(combinations_with_replacement(range(count), 2))
    columns = np.column_stack(
        [np.ones(len(points)), points, *(points[:, i] * points[:, j] for i, j in pairs)]
    )
    found = np.linalg.lstsq(columns, values.reshape(len(points), -1), rcond=None)[0].reshape(-1, n, n)
    A, first, second = found[0], found[1 : count + 1], dict(zip(pairs, found[count + 1 :]))
    form = _realised(A, first, second, dt)
    truth = np.array([state_matrix(d) for d in checked]) * unit / unit[:, None]
    lacks = truth - np.array([form.at(d) for d in checked])
    size, left = np.linalg.norm(A, 2), float(np.linalg.norm(lacks, 2, axis=(1, 2)).max())
    if left > NOTHING * size:
        form = _covered(form, lacks)
    return FractionalForm(
        form.A * unit[:, None] / unit, form.B * unit[:, None], form.C / unit, form.D, form.blocks, dt, left / size
    )


def _units(values: Array) -> Array:
    from pliant.plants.core.imports import linalg

    _, (scale, _) = linalg.matrix_balance(np.abs(values).max(axis=0), permute=False, separate=True)
    return np.asarray(scale)


def _points(count: int) -> tuple[Array, Array]:
    """Where the polynomial is fitted, and where it is measured."""
    rng = np.random.default_rng(0)
    corners = np.array(list(product((-1.0, 1.0), repeat=count))) if count <= CORNERS else np.zeros((0, count))
    if count <= MOST_GRID:
        fit = np.array(list(product(GRID, repeat=count)))
    else:
        fit = np.vstack([np.cos(np.pi * rng.random((POINTS + 4 * count**2, count))), corners, np.zeros((1, count))])
    edges = rng.choice((-1.0, 1.0), (CHECKED // 2, count))
    edges[np.arange(len(edges)), rng.integers(count, size=len(edges))] = rng.uniform(-1, 1, len(edges))
    return fit, np.vstack([rng.uniform(-1, 1, (CHECKED, count)), edges, corners])


def _realised(A: Array, first: Array, second: dict[tuple[int, int], Array], dt: float | None) -> FractionalForm:
    """v_i = R_i x + sum_j P_ij s_j, w_i = delta_i v_i entering by U_i; s_j = delta_j Q_j x."""
    k, n, size = len(first), len(A), float(np.linalg.norm(A, 2))
    U = [_range(np.hstack([first[i], *(second[i, j] for j in range(i, k))]), size) for i in range(k)]
    inner = [np.vstack([U[i].T @ second[i, j] for i in range(j + 1)]) for j in range(k)]
    Q = [_range(stack.T, size).T for stack in inner]
    ranks, more = [u.shape[1] for u in U], [len(q) for q in Q]
    starts = np.cumsum([0, *(r + s for r, s in zip(ranks, more))])
    m = int(starts[-1])
    B, C, D = np.zeros((n, m)), np.zeros((m, n)), np.zeros((m, m))
    for i in range(k):
        own = slice(starts[i], starts[i] + ranks[i])
        B[:, own], C[own] = U[i], U[i].T @ first[i]
        C[own.stop : starts[i + 1]] = Q[i]
        for j in range(i, k):
            D[own, starts[j] + ranks[j] : starts[j + 1]] = U[i].T @ second[i, j] @ Q[j].T
    kept = [i for i in range(k) if ranks[i] + more[i]]
    if len(kept) < k:
        raise ValueError("fitted: a parameter has no effect on the loop")
    return FractionalForm(A, B, C, D, tuple(Block("real", ranks[i] + more[i]) for i in kept), dt)


def _range(columns: Array, size: float) -> Array:
    """An orthonormal basis of what the columns span."""
    left, values, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, values > RANK * size])


def _covered(form: FractionalForm, lacks: Array) -> FractionalForm:
    """With a full block E of norm one: left E right takes in all that was measured."""
    n, most = len(form.A), np.abs(lacks).max(axis=0)
    floor = 1e-6 * most.max()
    row, column = np.ones(n), np.ones(n)
    for _ in range(20):
        row = np.sqrt(row * np.maximum((most / column).max(axis=1), floor))
        column = np.sqrt(column * np.maximum((most / row[:, None]).max(axis=0), floor))
    norm = np.linalg.norm(lacks / row[:, None] / column, 2, axis=(1, 2)).max()
    row = row * SAFETY * norm
    m = len(form.D)
    D = np.zeros((m + n, m + n))
    D[:m, :m] = form.D
    B, C = np.hstack([form.B, np.diag(row)]), np.vstack([form.C, np.diag(column)])
    return FractionalForm(form.A, B, C, D, (*form.blocks, Block("full", n)), form.dt)
