"""Gauss's method of order four for a linear model that is held over blocks of a motion's parts.

    d(delta)/dt = A delta + c,    A that of the block, c given at the two Gauss points of each part

Parts of one block share one inverse, so that a long motion takes no more than a short one does.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

Array = np.ndarray
BUTCHER = np.array(
    [[1 / 4, 1 / 4 - np.sqrt(3) / 6], [1 / 4 + np.sqrt(3) / 6, 1 / 4]]
)  # of Gauss's method of order four


@dataclass(frozen=True, eq=False)
class HeldModel:
    """A (b, n, n), each held from one of the times `edges` (b + 1,) [s] to the next."""

    edges: Array
    A: Array
    mass: Array | None = None  # (b, m, m) of the mechanical plant that it is of

    @cached_property
    def inverse_mass(self) -> Array:
        """(b, m, m)."""
        assert self.mass is not None
        return np.linalg.inv(self.mass)

    def blocks(self, ends: Array) -> Array:
        """The block of each of the parts between the times `ends` (m + 1,): that which holds its middle."""
        middle = (ends[:-1] + ends[1:]) / 2
        return np.clip(np.searchsorted(self.edges, middle, side="right") - 1, 0, len(self.A) - 1)

    def over(self, ends: Array) -> BlockCollocation:
        """For the parts between the times `ends` (m + 1,)."""
        return BlockCollocation(self.A, self.blocks(ends), np.diff(ends))


class BlockCollocation:
    """Steps h (m,), `block` (m,) says which A (b, n, n) each takes.

    K_i = A (delta + h sum_j a_ij K_j) + c_i at both points, delta + h (K_1 + K_2)/2 at the end.
    """

    def __init__(self, A: Array, block: Array, h: Array) -> None:
        self.h, self.n = h, A.shape[-1]
        self._A, self._block = A, block
        length = np.round(h / h.max(), 9)  # steps that differ by rounding are one
        starts = np.flatnonzero(np.append(True, (np.diff(block) != 0) | (np.diff(length) != 0)))
        self._runs = [slice(a, b) for a, b in zip(starts, np.append(starts[1:], len(h)))]

    @cached_property
    def _inverses(self) -> tuple[Array, Array, Array]:
        """Of each run: K (2 n) of c (2 n), K of delta (n), and what a step makes of delta."""
        n, first = self.n, [run.start for run in self._runs]
        A, h = self._A[self._block[first]], self.h[first]
        left = np.eye(2 * n) - np.einsum("r,ij,rkl->rikjl", h, BUTCHER, A).reshape(-1, 2 * n, 2 * n)
        solve = np.linalg.inv(left)
        own = (solve[:, :, :n] + solve[:, :, n:]) @ A
        return solve, own, np.eye(n) + h[:, None, None] / 2 * (own[:, :n] + own[:, n:])

    def response(self, c: Array, start: Array) -> tuple[Array, Array, Array]:
        """delta (m + 1, n) at the ends, it and its derivative (m, 2, n) at the Gauss points, from `start` (n,) under
        c (m, 2, n).
        """
        m, n = len(self.h), self.n
        solve, own, onward = self._inverses
        c = c.reshape(m, 2 * n)
        K = np.concatenate([c[run] @ solve[r].T for r, run in enumerate(self._runs)])
        push = self.h[:, None] / 2 * (K[:, :n] + K[:, n:])
        ends = np.empty((m + 1, n))
        ends[0] = start
        with np.errstate(over="ignore", invalid="ignore"):  # what grows without bound is no number in the end
            for r, run in enumerate(self._runs):
                for k in range(run.start, run.stop):
                    ends[k + 1] = onward[r] @ ends[k] + push[k]
                K[run] += ends[run] @ own[r].T
        slopes = K.reshape(m, 2, n)
        inner = ends[:-1, None] + self.h[:, None, None] * np.einsum("ij,kjn->kin", BUTCHER, slopes)
        return ends, inner, slopes

    def closed_response(
        self, c: Array, B: Array, start: Array, parts: int, inputs: Callable[[int, Array], Array]
    ) -> tuple[Array, Array, Array]:
        """`response` where `inputs(period, delta (n,))` (nu,), held over periods of so many `parts`, act by
        B (m, 2, n, nu) too.
        """
        m, n = len(self.h), self.n
        solve, own, onward = self._inverses
        run = np.repeat(np.arange(len(self._runs)), [r.stop - r.start for r in self._runs])
        ends, K = np.empty((m + 1, n)), np.empty((m, 2 * n))
        ends[0], u = start, np.zeros(B.shape[-1])
        with np.errstate(over="ignore", invalid="ignore"):
            for k in range(m):
                if k % parts == 0:
                    u = inputs(k // parts, ends[k])
                K[k] = solve[run[k]] @ (c[k] + B[k] @ u).ravel()
                ends[k + 1] = onward[run[k]] @ ends[k] + self.h[k] / 2 * (K[k, :n] + K[k, n:])
                K[k] += own[run[k]] @ ends[k]
        slopes = K.reshape(m, 2, n)
        inner = ends[:-1, None] + self.h[:, None, None] * np.einsum("ij,kjn->kin", BUTCHER, slopes)
        return ends, inner, slopes

    def influence(self, weights: Array) -> tuple[Array, Array]:
        """The transpose of `response`: of functionals sum_k weights_k . delta_k, weights (m + 1, n, q) at the ends,
        what c (m, 2, n) and the start make of each, (m, 2, n, q) and (n, q). For any c and start

            sum_k weights_k . delta_k = influence . c + of_start . start
        """
        m, n, q = len(self.h), self.n, weights.shape[-1]
        solve, _, onward = self._inverses
        pushed = solve[:, :n] + solve[:, n:]  # (runs, n, 2 n): of a step, twice over h
        adjoint, found = weights[-1].astype(float), np.empty((m, 2 * n, q))
        for r, run in reversed(list(enumerate(self._runs))):
            for k in reversed(range(run.start, run.stop)):
                found[k] = self.h[k] / 2 * (pushed[r].T @ adjoint)
                adjoint = onward[r].T @ adjoint + weights[k]
        return found.reshape(m, 2, n, q), adjoint
