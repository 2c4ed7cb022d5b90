"""What stays at rest in x' = A x + B u: quantities that no input changes, and directions that nothing feels.

conserved  w with w'A = 0, w'B = 0; then what is so where those are zero: after momentum the place of the mass centre
unfelt     v with A v = 0, not seen: of a conserved quantity, w'v not zero, or of states that only inputs change, as the
           spin that four wheels share without turning the craft. What other states drive is not among them, as an
           angle whose rate is a state: not to see that is to let it drift

Of sampled systems A - 1 takes the place of A. Both spaces are looked for with rows and columns scaled to one, so that
units do not count.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

Array = np.ndarray
NOTHING = 1e-11  # singular value, rows and columns scaled to one, that is none
NO_PART = 1e-9  # share of a scaled state, or of a product of two, that is none
ROUNDING = 1e-12  # of the products that an entry is summed from, which leave no more of it
SCALINGS = 20  # of rows and columns in turn


class Conserved(NamedTuple):
    """w (k, nx); x = up z, (nx, nx - k), has w'x = 0, and z = down x; the states in each w; their sizes (nx,)."""

    quantities: Array
    up: Array
    down: Array
    names: tuple[str, ...]
    size: Array

    @property
    def tidy(self) -> Array:
        """Other quantities of the same space (k, nx), each with a one where the others have none, without rounding."""
        return _tidy(self.quantities, self.size)

    def by_states(self) -> tuple[Array, list[int]]:
        """Another `up`, whose z are the states of the places that it returns."""
        if not self.names:
            return self.up, list(range(len(self.up)))
        out, others, share = _split(self.quantities.T, 1 / self.size)
        up = np.eye(len(self.up))[:, others]
        up[out] = -share.T
        return up, others


class Unfelt(NamedTuple):
    """v (nx, k), down v = 0: z = down x, (nx - k, nx), moves without it. It is the states `others` where the rest is 0.

    names: the states in each combination of v that nothing conserved keeps, so that inputs leave it where they like.
    """

    directions: Array
    down: Array
    others: list[int]
    names: tuple[str, ...]

    @property
    def up(self) -> Array:
        """(nx, nx - k): x = up z has that z."""
        return np.eye(len(self.directions))[:, self.others]


class _Null(NamedTuple):
    own: Array  # (k, n) rows w with w M = 0
    rest: Array  # (n, n - k) orthonormal in scaled states x / size, the others
    size: Array  # (n,)


def _rates(A: Array, up: Array, down: Array, dt: float | None) -> Array:
    """down A up, or down (A - 1) up of a sampled system, zero on what rests; what rounding leaves set to zero."""
    M = down @ (A if dt is None else A - np.eye(len(A))) @ up
    return np.where(np.abs(M) > ROUNDING * (np.abs(down) @ np.abs(A) @ np.abs(up)), M, 0.0)


def conserved_by(A: Array, B: Array, dt: float | None, names: tuple[str, ...]) -> Conserved:
    """What no input changes of A (nx, nx), B (nx, nu)."""
    up = down = np.eye(len(A))
    rows, size = np.zeros((0, len(A))), np.ones(len(A))
    words: list[str] = []
    while True:
        found = _left_null(np.hstack([_rates(A, up, down, dt), _product(down, B)]))
        if not len(found.own):
            return Conserved(rows, up, down, tuple(words), size)
        size = size if len(rows) else found.size
        mine = found.own @ down
        rows = np.vstack([rows, mine])
        words += [_words(w, size, names) for w in _tidy(mine, size)]
        up, down = up @ (found.rest * found.size[:, None]), (found.rest / found.size[:, None]).T @ down


def unfelt(A: Array, B: Array, seen: Array, dt: float | None, names: tuple[str, ...]) -> Unfelt:
    """Directions that neither A nor `seen` (m, nx) feels."""
    kept = conserved_by(A, B, dt, names).quantities
    up = down = np.eye(len(A))
    found, size = np.zeros((len(A), 0)), np.ones(len(A))
    while True:
        M, look = _rates(A, up, down, dt), _product(seen, up)
        right = _left_null(np.vstack([M, look]).T)
        size = size if found.shape[1] else 1 / right.size
        rows = conserved_by(down @ A @ up, down @ B, dt, ("",) * len(M)).quantities
        if not found.shape[1]:
            rows = np.vstack([rows, np.eye(len(M))[~M.any(axis=1)]])
        v = _tidy(right.own, right.size).T
        v = v[:, _paired(rows, v)]
        if not v.shape[1]:
            break
        found = np.hstack([found, up @ v])
        rest = sla.null_space((v * right.size[:, None]).T)
        up, down = up @ (rest / right.size[:, None]), (rest * right.size[:, None]).T @ down
    v = _tidy(found.T, 1 / size).T
    out, others, share = _split(v, size)
    down = np.eye(len(A))[others]
    down[:, out] = -share
    loose = v @ _left_null(_product(kept, v).T).own.T
    return Unfelt(v, down, others, tuple(_words(w, 1 / size, names) for w in _tidy(loose.T, 1 / size)))


def keeping(w: Array, felt: Array) -> Array | None:
    """v (n, k) with felt v = 0, w v = 1 for rows w (k, n), felt (m, n), the least one; None where there is none."""
    null = _left_null(felt.T).own.T
    M = _product(w, null)
    row = _or_one(np.abs(M).max(axis=1, keepdims=True, initial=0.0))
    column = _or_one(np.abs(M / row).max(axis=0, initial=0.0))
    sizes = np.linalg.svd(M / row / column, compute_uv=False)
    if len(sizes) < len(w) or not sizes.min(initial=1.0) > NO_PART:
        return None
    return null @ np.linalg.pinv(M)


def _split(v: Array, size: Array) -> tuple[list[int], list[int], Array]:
    """Places of as many states as columns of v (n, k), of the others, and v_others v_places^-1."""
    _, places = sla.qr((v / size[:, None]).T, mode="r", pivoting=True)
    order = np.asarray(places).tolist()
    out, others = order[: v.shape[1]], sorted(order[v.shape[1] :])
    return out, others, np.linalg.solve(v[out].T, v[others].T).T


def _product(M: Array, v: Array) -> Array:
    """M v, what rounding leaves set to zero."""
    made = M @ v
    return np.where(np.abs(made) > ROUNDING * (np.abs(M) @ np.abs(v)), made, 0.0)


def _left_null(M: Array) -> _Null:
    row, column = np.ones(len(M)), np.ones(M.shape[1])
    for _ in range(SCALINGS):
        size = np.abs(M * row[:, None] * column)
        row /= np.sqrt(_or_one(size.max(axis=1, initial=0.0)))
        column /= np.sqrt(_or_one(size.max(axis=0, initial=0.0)))
    left, sizes, _ = np.linalg.svd(M * row[:, None] * column)
    sizes = np.append(sizes, np.zeros(len(M) - len(sizes)))
    return _Null(left[:, sizes <= NOTHING].T * row, left[:, sizes > NOTHING], 1 / row)


def _paired(rows: Array, v: Array) -> list[int]:
    """Columns of v (n, k), as many as there are independent products with rows (m, n)."""
    M = _product(rows, v)
    if not M.any():
        return []
    M = M / _or_one(np.abs(M).max(axis=1, keepdims=True))
    upper, order = sla.qr(M / _or_one(np.abs(M).max(axis=0)), mode="r", pivoting=True)
    size = np.abs(np.diag(upper))
    return sorted(np.asarray(order)[: np.sum(size > NO_PART * size[0])].tolist())


def _or_one(size: Array) -> Array:
    return np.where(size > 0, size, 1.0)


def _tidy(w: Array, size: Array) -> Array:
    """Another base of the rows of w, each with a one where the others have none, without what rounding leaves."""
    base = w * size
    for k in range(len(base)):
        pivot = int(np.argmax(np.abs(base[k])))
        base[k] /= base[k, pivot]
        for j in range(len(base)):
            if j != k:
                base[j] -= base[j, pivot] * base[k]
    most = np.abs(base).max(axis=1, keepdims=True, initial=0.0)
    return np.where(np.abs(base) > NO_PART * most, base, 0.0) / size


def _words(w: Array, size: Array, names: tuple[str, ...]) -> str:
    """A sum of the states that take part, in their own units, first that of the largest share."""
    share = np.abs(w * size)
    most = int(np.argmax(share))
    others = [int(i) for i in np.flatnonzero(share > NO_PART * share[most]) if i != most]
    return " ".join([names[most], *(f"{w[i] / w[most]:+.3g} {names[i]}" for i in others)])
