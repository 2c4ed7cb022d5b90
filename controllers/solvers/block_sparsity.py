"""Sparse matrices that are filled block by block."""

from __future__ import annotations

import casadi as ca
import numpy as np

Array = np.ndarray


def places(stages: int, rows: int, columns: int) -> tuple[Array, Array, Array]:
    """Stage, row and column of every entry of a stack of blocks (stages * rows * columns,)."""
    k, i, j = np.indices((stages, rows, columns)).reshape(3, -1)
    return k, i, j


class Pattern:
    """A sparse matrix whose entries come block by block; entries left of the first column are dropped."""

    def __init__(self, rows: int, columns: int, row: list[Array], column: list[Array], *, upper: bool = False) -> None:
        i, j = (np.concatenate([k.ravel() for k in part]) for part in (row, column))
        kept = np.flatnonzero((j >= 0) & (i >= 0) & ((i <= j) | (not upper)))
        self._order = kept[np.lexsort((i[kept], j[kept]))]
        self.sparsity = ca.Sparsity.triplet(rows, columns, i[kept].tolist(), j[kept].tolist())

    def fill(self, parts: list[Array]) -> ca.DM:
        """The matrix from its blocks' entries, in the order in which the pattern was given."""
        return ca.DM(self.sparsity, np.concatenate([p.ravel() for p in parts])[self._order])
