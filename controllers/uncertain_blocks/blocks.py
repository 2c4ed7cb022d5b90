"""Structured perturbations Delta = diag(Delta_1, .., Delta_k), and the scalings that commute with them.

real      delta I_n, delta real: a parameter that enters in n places
complex   delta I_n, delta complex
full      any complex n by n matrix of that norm

D = diag(D_i) is Hermitian and positive, D_i full for repeated scalars and a multiple of the identity for full blocks;
G = diag(G_i) is Hermitian and belongs to real blocks alone: D Delta = Delta D, G Delta = Delta* G.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from pliant.plants.core.argument_gates import require_all, require_choice, require_count

Array = np.ndarray
KINDS = ("real", "complex", "full")
MOST = 200  # rows of one block


@dataclass(frozen=True)
class Block:
    """One block: `kind`, "real", "complex" or "full", and its number of rows."""

    kind: str
    size: int = 1

    def __post_init__(self) -> None:
        require_choice("Block", "kind", self.kind, KINDS)
        object.__setattr__(self, "size", require_count("Block", "size", self.size, 1, MOST))


def require_blocks(owner: str, blocks: Sequence[Block], rows: int) -> tuple[Block, ...]:
    """ValueError unless they fill a matrix of so many rows."""
    found: tuple[Block, ...] = require_all(f"{owner}.blocks", blocks, Block)
    if (total := sum(b.size for b in found)) != rows:
        raise ValueError(f"{owner}.blocks: sizes add up to {total}, must be the {rows} rows of M")
    return found


def places(blocks: Sequence[Block]) -> list[slice]:
    """Rows of each."""
    ends = np.cumsum([0, *(b.size for b in blocks)])
    return [slice(int(a), int(b)) for a, b in pairwise(ends)]


class Structure(NamedTuple):
    """Of the scalings: Hermitian bases D (k, n, n), G (l, n, n), and rows that a diagonal D scales alike."""

    D: Array
    G: Array
    groups: list[slice]


def structure(blocks: Sequence[Block]) -> Structure:
    """Hermitian matrices whose real combinations are the D and the G of these blocks."""
    n = sum(b.size for b in blocks)
    D, G = [], []
    groups: list[slice] = []
    for block, at in zip(blocks, places(blocks)):
        whole = block.kind == "full"
        for small in [np.eye(block.size)] if whole else hermitian(block.size):
            wide = np.zeros((n, n), dtype=complex)
            wide[at, at] = small
            D.append(wide)
            if block.kind == "real":
                G.append(wide)
        groups += [at] if whole else [slice(i, i + 1) for i in range(at.start, at.stop)]
    return Structure(np.array(D), np.array(G).reshape(-1, n, n), groups)


def hermitian(n: int) -> list[Array]:
    """A basis of Hermitian n by n matrices, the real diagonal ones first."""
    found = []
    for i in range(n):
        e = np.zeros((n, n), dtype=complex)
        e[i, i] = 1
        found.append(e)
    for i in range(n):
        for j in range(i):
            for value in (1.0, 1j):
                e = np.zeros((n, n), dtype=complex)
                e[i, j], e[j, i] = value, np.conj(value)
                found.append(e)
    return found
