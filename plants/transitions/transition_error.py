"""The transition matrix over a nominal, and what the data leave open in it, entry by entry.

|dM| <= D = sum over intervals k of |Phi(T, t)| E_k |Phi(t, 0)|, the largest of each factor within the interval,
E_k (n, n) the integral of what A(t) misses between two nodes (`interpolation`). All higher orders come with |Phi(t, 0)|
enlarged by what it may itself be off, dF_k <= sum over j < k of |Phi(t_k, t_j)| E_j (|Phi(t_j, 0)| + dF_j), found from
the start onwards over stretches of the nominal. To it come the change when all steps are halved, and the rounding of
the products. Where D is large the steps need not be small.

What a multiplier may be off hangs on V^-1 dM V, V the eigenvectors of M:
|V^-1 Phi(T, t)| E_k |Phi(t, 0) V| is less than |V^-1| D |V|, in which what cancels is summed by its size (`modal`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import reduce

import numpy as np

from pliant.plants.linear import magnus
from pliant.plants.linear.modal_analysis import refined as eigenvectors

from .state_matrix_path import MOST_STEPS, Path

ACROSS = 2.0  # |eigenvalue| times step to begin with
KEPT = 1 << 22  # numbers in the stacks of partial products
HELD = 1 << 21  # numbers in a stack of steps
STRETCHES, LITTLE = (12, 192), 0.02  # of higher orders: so few if they add little of the first order, else so many
SEEN = 0.7  # |eigenvalue| times distance of two partial products between which they hide little
HALVED = 1 / 16  # of the change under halving, of order six and so 1/63 of it, ..
RESOLVED = 0.5  # .. where |eigenvalue| times step is at most this, or steps are halved again; else all of it
EPS = float(np.finfo(float).eps)


class TooManySteps(ValueError):
    """The fastest modes need more steps over the nominal than are taken."""


@dataclass(frozen=True, eq=False)
class Transition:
    """M (n, n) in scaled coordinates and D (n, n) >= |M' - M| for every A(t) that the data allow."""

    M: np.ndarray
    D: np.ndarray = field(repr=False)
    steps: int
    rate: np.ndarray  # (n,) integral of A_ii, and ..
    rate_error: np.ndarray  # (n,) .. what it may be off; infinite where jumps add to it
    trace: np.ndarray = field(repr=False)  # (n, n): the sum over a closed part bounds what the part's trace may be off
    times: np.ndarray = field(repr=False)  # (m + 1,) [s], and ..
    Phi: np.ndarray = field(repr=False)  # (m, n, n) .. between them, a piece's jump in its first
    V: np.ndarray | None = field(repr=False, default=None)  # (n, n) eigenvectors of M where they are asked for, ..
    M_V: np.ndarray | None = field(repr=False, default=None)  # .. about V^-1 M V, and ..
    D_V: np.ndarray | None = field(repr=False, default=None)  # .. what V^-1 M' V differs from it at most


def refined(path: Path, across: float = ACROSS) -> tuple[np.ndarray, np.ndarray]:
    """Times of steps, the nodes among them, and which are nodes: |eigenvalue| times step at most `across`."""
    if path.constant:
        return path.t[[0, -1]], np.array([0, 1])
    fastest, h = path.fastest(), np.diff(path.t)
    parts = np.maximum(1, np.ceil(fastest * h / across)).astype(np.int64)
    need = int(parts.sum())
    if need > MOST_STEPS:
        need = 1 << (need - 1).bit_length()
        raise TooManySteps(
            f"a period of {path.t[-1] - path.t[0]:.6g} s and modes of up to {fastest:.4g} 1/s need {need:,} steps, "
            f"more than {MOST_STEPS:,}: leave out the fastest modes"
        )
    begin = np.concatenate([[0], np.cumsum(parts)])
    k = np.repeat(np.arange(len(h)), parts)
    inner = path.t[k] + h[k] * (np.arange(need) - begin[k]) / parts[k]
    return np.append(inner, path.t[-1]), begin


def monodromy(path: Path, length: float, tolerance: float) -> tuple[int, np.ndarray, float]:
    """How many equal steps, Phi (n, n) over `length` [s], relative error of the steps alone, which are halved until Phi
    stands still."""
    m = 1 if path.constant else max(32, 2 * path.harmonics + 2, int(path.fastest() * length / 2))
    m, before = 1 << (m - 1).bit_length(), None
    while True:
        total = path.over(length, m)
        floor = 4 * EPS * m**0.5
        if path.constant:
            return m, total, floor
        if before is not None:
            change = float(np.linalg.norm(total - before) / np.linalg.norm(total))
            if change <= max(63 * tolerance, floor) or m >= MOST_STEPS:
                return m, total, max(change / 63, floor)
        before, m = total, 2 * m


@np.errstate(over="ignore", invalid="ignore")  # beyond the range of numbers D is not finite: nothing is known
def transition(
    paths: Sequence[Path], jumps: Sequence[np.ndarray] = (), tolerance: float = 1e-11, *, modal: bool = False
) -> Transition:
    """Over the paths in turn, a jump (n, n) in the same scaled coordinates between each two.

    `modal`: in the coordinates of the eigenvectors too, where M has a basis of them.
    """
    n, one = paths[0].n, np.eye(paths[0].n)
    V, W, D_V, grids = None, one, None, [refined(path) for path in paths]
    chosen = [_edges(path, *grid) for path, grid in zip(paths, grids)]
    steps, halvings = sum(len(grid) - 1 for grid, _ in grids), 0
    before = _joined([_coarse(path, grid) for path, (grid, _) in zip(paths, grids)], jumps)
    fine = all(path.fastest() * np.diff(grid).max() <= RESOLVED for path, (grid, _) in zip(paths, grids))
    share = HALVED if fine else 1.0  # of the change, that M may be off
    D, S = np.zeros((n, n)), np.zeros((n, n))
    while True:
        Phi = [_products(path, grid, edges, 1 << halvings) for path, (grid, _), edges in zip(paths, grids, chosen)]
        M = _joined([magnus.product(P) for P in Phi], jumps)
        if not halvings:
            D, S = _first_order(paths, grids, chosen, Phi, jumps, one, one)
            if modal and np.isfinite(M).all():
                _, V, W, off = eigenvectors(M)
                V = V if np.isfinite(off).all() else None
            if V is not None:
                D_V, _ = _first_order(paths, grids, chosen, Phi, jumps, W, V)
        change = np.abs(M - before) if not all(path.constant for path in paths) else np.zeros((n, n))
        size = float(np.linalg.norm(M))
        enough = HALVED * max(32 * tolerance * size, 0.02 * float(np.linalg.norm(D)))
        done = share * np.linalg.norm(change) <= enough or (steps << halvings) >= MOST_STEPS or not np.isfinite(size)
        if done:
            break
        before, halvings, share = M, halvings + 1, HALVED
    for J, P in zip(jumps, Phi[1:]):
        P[0] = P[0] @ J
    times = [grids[0][0][:1], *(grid[edges[1:]] for (grid, _), edges in zip(grids, chosen))]
    M_V = None
    if V is not None and D_V is not None:
        M_V = W @ M @ V
        D_V = D_V + np.abs(W) @ (share * change + 4 * n * EPS * np.abs(M)) @ np.abs(V)
        apart = np.abs(W @ V - one) + 2 * n * EPS * np.abs(W) @ np.abs(V)  # W is V^-1 to rounding
        D_V = D_V + 2 * (apart @ (np.abs(M_V) + D_V))
        D_V = D_V if apart.sum(axis=1).max() < 0.1 else np.full((n, n), np.inf)
    return Transition(
        M,
        D + share * change,
        steps << halvings,
        *(*_rates(paths), S + np.diag(np.diagonal(share * change))),
        *(np.concatenate(times), np.concatenate(Phi)),
        *(V, M_V, D_V),
    )


def _coarse(path: Path, grid: np.ndarray) -> np.ndarray:
    """The product over the grid in half as many steps, each two of them in one."""
    few = np.append(grid[:-1:2], grid[-1])
    return magnus.product(_products(path, few, np.append(np.arange(0, len(few) - 1, 64), len(few) - 1), 1))


def _joined(Phi: Sequence[np.ndarray], jumps: Sequence[np.ndarray]) -> np.ndarray:
    return reduce(lambda total, part: part[1] @ (part[0] @ total), zip(jumps, Phi[1:]), Phi[0])


def _rates(paths: Sequence[Path]) -> tuple[np.ndarray, np.ndarray]:
    n = paths[0].n
    rate, error = np.zeros(n), np.full(n, 0.0 if len(paths) == 1 else np.inf)
    for path in paths:
        length = path.t[-1] - path.t[0]
        rate += np.diagonal(path.base) * length
        error += 8 * EPS * np.abs(np.diagonal(path.base)) * length
        if path.constant:
            continue
        for column in np.flatnonzero(path.rows == path.columns):
            whole, area = path.values.integral(int(column))
            rate[path.rows[column]] += whole
            error[path.rows[column]] += area
    return rate, error


def _edges(path: Path, grid: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """Positions in the grid between which products are kept."""
    if len(grid) <= (most := max(64, KEPT // path.n**2)):
        return np.arange(len(grid))
    return nodes[np.unique(np.r_[np.arange(0, len(nodes), -(-len(nodes) // most)), len(nodes) - 1])]


def _products(path: Path, grid: np.ndarray, edges: np.ndarray, parts: int) -> np.ndarray:
    """Phi (len(edges) - 1, n, n) between the edges of the grid, each of its steps in `parts`."""
    found = np.empty((len(edges) - 1, path.n, path.n))
    at_once = max(1, HELD // (parts * path.n**2))  # steps of the grid
    k = 0
    while k < len(found):
        last = max(k + 1, int(np.searchsorted(edges, edges[k] + at_once, side="right")) - 1)
        part = slice(k, last)
        steps = path.between(grid[edges[k] : edges[last] + 1], parts)
        found[part] = magnus.grouped(steps, edges[k : last + 1] - edges[k])
        k = last
    return found


def _first_order(
    paths: Sequence[Path],
    grids: Sequence[tuple[np.ndarray, np.ndarray]],
    chosen: Sequence[np.ndarray],
    Phi: Sequence[np.ndarray],
    jumps: Sequence[np.ndarray],
    left: np.ndarray,
    right: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Bounds (n, n) on the entries of left dM right, and those whose sum over a part bounds the trace of dM, where
    right left = 1.

    The trace of Phi(T, t) dA Phi(t, 0) is that of Phi(t, 0) Phi(T, t) dA: the factors' signs count.
    """
    n = paths[0].n
    before = [right]  # Phi(start of the path, 0)
    for k, P in enumerate(Phi[:-1]):
        before.append(jumps[k] @ magnus.product(P) @ before[-1])
    after = left
    D, trace = np.zeros((n, n)), np.zeros((n, n))
    cuts: list[Callable[[int], tuple[np.ndarray, ...]]] = []  # of each path into stretches
    for k in reversed(range(len(paths))):
        first, S, cut = _over_one(paths[k], *grids[k], chosen[k], Phi[k], before[k], after)
        D, trace = D + first, trace + S
        after = after @ magnus.product(Phi[k])
        if k:
            after = after @ jumps[k - 1]
        cuts.insert(0, cut)
    for most in STRETCHES:
        stretches = [cut(most if n <= 12 else min(most, STRETCHES[1] // 4)) for cut in cuts]
        for jump, (P, *_) in zip(jumps, stretches[1:]):
            P[0] = P[0] @ jump
        rest = _higher(*(np.concatenate(x) for x in zip(*stretches)))
        if np.linalg.norm(rest) <= LITTLE * np.linalg.norm(D):
            break
    D, trace = D + rest, trace + np.diag(np.diagonal(rest))
    if not (np.isfinite(D).all() and np.isfinite(after).all()):
        return np.full((n, n), np.inf), np.full((n, n), np.inf)
    return D, trace


def _higher(P: np.ndarray, E: np.ndarray, F: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Orders beyond the first, from stretches (m, n, n): transition, error of A, |Phi(t, 0)| and |Phi(T, t)|."""
    m, n, one = len(P), P.shape[-1], np.eye(P.shape[-1])
    rest, moved = np.zeros((n, n)), one[None]  # Phi(t_k, t_j), j = 0 .. k
    sources = np.empty_like(P)  # E_j (|F_j| + dF_j)
    for k in range(m):
        off = np.zeros((n, n))
        if k:
            size = np.abs(moved)
            off = (np.maximum(size[:-1], size[1:]) @ sources[:k]).sum(axis=0)
        strength = min(float(np.abs(E[k]).sum(axis=1).max()), 50.0)
        own = off + np.abs(P[k] - one) @ off
        own = own + (E[k] @ (F[k] + own)) * (np.expm1(strength) / strength if strength > 1e-8 else 1.0)
        sources[k] = E[k] @ (F[k] + own)
        rest += B[k] @ (E[k] @ own)
        moved = np.concatenate([P[k] @ moved, one[None]])
    return rest


def _over_one(
    path: Path,
    grid: np.ndarray,
    nodes: np.ndarray,
    edges: np.ndarray,
    Phi: np.ndarray,
    before: np.ndarray,
    after: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, Callable[[int], tuple[np.ndarray, ...]]]:
    """The first order of one path in the whole, of the trace, and what cuts it into stretches for the higher ones."""
    m, n = len(Phi), path.n
    F, B = np.empty((m + 1, n, n), before.dtype), np.empty((m + 1, n, n), after.dtype)
    F[0], B[m] = before, after
    for k in range(m):
        F[k + 1] = Phi[k] @ F[k]
        B[m - 1 - k] = B[m - k] @ Phi[m - 1 - k]
    F, B, around = np.abs(F), np.abs(B), np.abs((F @ B).transpose(0, 2, 1))
    hidden = path.fastest() * np.diff(grid[edges])
    if not path.constant and hidden.max() > SEEN:
        F, B, around = _widest(F), _widest(B), _widest(around)
    own = np.flatnonzero(np.isin(edges, nodes))  # edges that are nodes
    F, B, around = (np.maximum(np.maximum.reduceat(X[:-1], own[:-1]), X[own[1:]]) for X in (F, B, around))
    steps = np.diff(edges[own]) + path.size * np.diff(grid[edges[own]])
    E = np.zeros((len(own) - 1, n, n))
    if not path.constant:
        first = np.searchsorted(nodes, edges[own])  # nodes that these are
        E[:, path.rows, path.columns] = np.add.reduceat(path.values.area, first[:-1], axis=0)
    if path.rounding.any():
        E += path.rounding * np.diff(grid[edges[own]])[:, None, None]
    D = np.zeros((n, n))
    for k in range(0, len(E), 64):
        part = slice(k, k + 64)
        D += (B[part] @ (E[part] @ F[part] + 4 * EPS * steps[part, None, None] * F[part])).sum(axis=0)
    S = (around * E).sum(axis=0)
    S[np.diag_indices(n)] += 4 * EPS * steps.sum() * np.abs(np.diagonal(before @ after)).max()

    def cut(most: int) -> tuple[np.ndarray, ...]:
        few = np.unique(np.linspace(0, len(E), min(len(E), most) + 1).astype(int))
        widest = (np.maximum.reduceat(x, few[:-1], axis=0) for x in (F, B))
        return magnus.grouped(Phi, own[few]).copy(), np.add.reduceat(E, few[:-1], axis=0), *widest

    return D, S, cut


def _widest(X: np.ndarray) -> np.ndarray:
    """The largest of each and its two neighbours on either side."""
    padded = np.concatenate([X[:1], X[:1], X, X[-1:], X[-1:]])
    return reduce(np.maximum, (padded[k : k + len(X)] for k in range(5)))
