"""A state matrix that depends on parameters, as a linear system with the parameters fed back.

    dx/dt or x[k+1] = A x + B w,   v = C x + D w,   w = Delta v,   Delta = diag(delta_1 I, .., delta_k I)

delta_i, real, in [-1, 1] from one end of a parameter's interval to the other. The state matrix is
A + B Delta (I - D Delta)^-1 C.

`fitted` takes any smooth A(delta): a polynomial of total degree two by least squares on a grid,

    A(delta) = A_0 + sum_i delta_i (A_i + sum_(j >= i) delta_j A_ij),

with A_i + .. of the least ranks; with a mass matrix E(delta) both E and E A are such polynomials, and A is exact where
the equations of motion are. What the form lacks is measured at other points, corners among
them: `left`, which what is shown of the form neglects.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import combinations_with_replacement, product

import numpy as np

from pliant.plants.core.imports import linalg
from pliant.plants.core.signals import OwnsArrays

from .blocks import Block

Array = np.ndarray
GRID = (-1.0, -0.5, 0.0, 0.5, 1.0)
MOST_GRID = 3  # parameters with a full grid
POINTS, CHECKED = 150, 150
CORNERS = 6  # parameters of which all corners are looked at
RANK = 1e-3  # singular values that count, beside the largest element of the state matrix


class NoEffect(ValueError):
    """A parameter moves the state matrix by less than RANK: it has no block."""


@dataclass(frozen=True, eq=False)
class FractionalForm(OwnsArrays):
    """A (n, n), B (n, m), C (m, n), D (m, m), blocks of the m rows; dt [s] of a sampled system."""

    A: Array = field(repr=False)
    B: Array = field(repr=False)
    C: Array = field(repr=False)
    D: Array = field(repr=False)
    blocks: tuple[Block, ...]
    dt: float | None = None
    left: float = 0.0  # largest |what the form lacks| / |A| that was measured

    def at(self, delta: Array) -> Array:
        """The state matrix (n, n) with real blocks of delta (k,), other blocks at zero."""
        values = np.concatenate(
            [np.full(b.size, d) for b, d in zip([b for b in self.blocks if b.kind == "real"], delta)]
            + [np.zeros(b.size) for b in self.blocks if b.kind != "real"]
        )
        w = values[:, None] * np.linalg.solve(np.eye(len(self.D)) - self.D * values, self.C)
        return np.asarray(self.A + self.B @ w)


def fitted(
    state_matrix: Callable[[Array], Array],
    count: int,
    dt: float | None = None,
    mass: Callable[[Array], Array] | None = None,
) -> FractionalForm:
    """The form of a function of delta (count,) in [-1, 1].

    mass: E(delta) (n, n) by which E(delta) A(delta) is a polynomial too, as a mass matrix makes it.
    """
    points, checked = _points(count)
    values = np.array([state_matrix(d) for d in points])
    n = values.shape[-1]
    weights = np.array([np.eye(n) if mass is None else mass(d) for d in points])
    unit = _units(values)
    values, weights = values * unit / unit[:, None], weights * unit / unit[:, None]
    inverse = np.linalg.inv(weights[np.abs(points).sum(axis=1).argmin()])
    weights = inverse @ weights  # the identity in the middle
    pairs = list(combinations_with_replacement(range(count), 2))
    columns = np.column_stack([np.ones(len(points)), points, *(points[:, i] * points[:, j] for i, j in pairs)])
    both = np.concatenate([weights @ values, -weights], axis=-1)
    found = np.linalg.lstsq(columns, both.reshape(len(points), -1), rcond=None)[0].reshape(-1, n, 2 * n)
    form = _realised(found[0], found[1 : count + 1], dict(zip(pairs, found[count + 1 :])), dt)
    truth = np.array([state_matrix(d) for d in checked]) * unit / unit[:, None]
    lacks = truth - np.array([form.at(d) for d in checked])
    left = float(np.linalg.norm(lacks, 2, axis=(1, 2)).max() / np.linalg.norm(form.A, 2))
    return FractionalForm(
        form.A * unit[:, None] / unit, form.B * unit[:, None], form.C / unit, form.D, form.blocks, dt, left
    )


def _units(values: Array) -> Array:
    _, (scale, _) = linalg.matrix_balance(np.abs(values).max(axis=0), permute=False, separate=True)
    return np.asarray(scale)


def check_points(count: int) -> Array:
    """Points (m, count) of the box at which a form's lack is measured, corners among them."""
    return _points(count)[1]


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


def _realised(both: Array, first: Array, second: dict[tuple[int, int], Array], dt: float | None) -> FractionalForm:
    """0 = [E A, -E] [x; z] for the rate (or next state) z: of the form both + sum_i delta_i (first_i + ..).

    v_i = R_i [x; z] + sum_j P_ij s_j, w_i = delta_i v_i entering by U_i; s_j = delta_j Q_j [x; z].
    """
    k, n = len(first), len(both)
    size = np.abs(both[:, n:]).max(), np.abs(both[:, :n]).max()
    even = np.concatenate([np.full(n, 1 / size[1]), np.full(n, 1 / size[0])])  # x and z in units that count alike
    U = [
        _range(np.hstack([first[i], *(second[i, j] for j in range(i, k))]) * np.tile(even, k - i + 1)) for i in range(k)
    ]
    inner = [np.vstack([U[i].T @ second[i, j] for i in range(j + 1)]) for j in range(k)]
    Q = [_range((stack * even).T).T / even for stack in inner]
    ranks, more = [u.shape[1] for u in U], [len(q) for q in Q]
    starts = np.cumsum([0, *(r + s for r, s in zip(ranks, more))])
    m = int(starts[-1])
    B, C, D = np.zeros((n, m)), np.zeros((m, 2 * n)), np.zeros((m, m))
    for i in range(k):
        if not ranks[i] + more[i]:
            raise NoEffect("fitted: a parameter has no effect on the loop")
        own = slice(starts[i], starts[i] + ranks[i])
        B[:, own], C[own] = U[i], U[i].T @ first[i]
        C[own.stop : starts[i + 1]] = Q[i]
        for j in range(i, k):
            D[own, starts[j] + ranks[j] : starts[j + 1]] = U[i].T @ second[i, j] @ np.linalg.pinv(Q[j])
    E = -both[:, n:]
    A, B = np.linalg.solve(E, both[:, :n]), np.linalg.solve(E, B)
    blocks = tuple(Block("real", r + s) for r, s in zip(ranks, more))
    return FractionalForm(A, B, C[:, :n] + C[:, n:] @ A, D + C[:, n:] @ B, blocks, dt)


def _range(columns: Array) -> Array:
    """An orthonormal basis of what columns, of size one beside the state matrix, span."""
    left, values, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, values > RANK])
