"""Where the eigenvalues of every matrix within a ball lie: |M' - M| <= D entry by entry.

parts       states that depend on each other both ways; between parts M' is triangular in blocks for every member (an
            entry that is zero in M and in D), so that its eigenvalues are those of the diagonal blocks
disks       with W = V^-1, W M' V = diag(lambda) + G', |G'| <= G = |W M V - diag(lambda)| + |W| D |V|: Gershgorin's
            disks, scaled by rows for one that stands alone; k disks that touch hold k eigenvalues of each member
curves      a closed curve on which rho(|(z - M)^-1| D) < 1 is crossed by no eigenvalue of any member (they move
            continuously from those of M), whatever clusters M has; rho is bounded from above by Collatz and Wielandt's
            quotients max (B x)/x, x > 0, and a disk of radius d about z is covered with D + d 1 in place of D
two states  the trace within its D and the determinant e^(integral of trace A), which Liouville's formula gives to what
            the trace of A alone leaves open: |lambda| of a complex pair hangs on that only; Jury's conditions decide
Entries are compared with entries, so that scaling a state, or time, changes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.linalg as sla

from pliant.plants.linear.modal_analysis import refined

from .state_matrix_path import parts_of

EPS = float(np.finfo(float).eps)
TESTS = 3000  # of a curve, at most ..
WORK = 2e8  # .. and so many multiplications
SMALL = 1e-8  # by which what is shown of a curve is widened, far below what separates its eigenvalues


@dataclass(frozen=True, eq=False)
class Bounds:
    """Eigenvalues (n,) of M, what each may be off in any member, and their groups that cannot be told apart."""

    values: np.ndarray
    errors: np.ndarray  # (n,) a group's: distance from its mean and the radius about it
    vectors: np.ndarray = field(repr=False)  # (n, n) columns
    groups: tuple[np.ndarray, ...] = field(repr=False)  # positions
    inside: bool  # every eigenvalue of every member is inside the circle (left of the line)
    outside: bool  # every member has one outside it
    least: float  # the largest size (real part) of any member is this at least ..
    most: float  # .. and this at most


def bounds(
    M: np.ndarray,
    D: np.ndarray,
    *,
    line: bool = False,
    volume: tuple[np.ndarray, np.ndarray] | None = None,
    trace: np.ndarray | None = None,
) -> Bounds:
    """Against the unit circle, or the line Re z = 0: M (n, n), of a real matrix in any coordinates, D (n, n) >= 0.

    `volume`: the integral (n,) of each A_ii whose transition matrix M is, and what it may be off (n,). `trace` (n, n):
    the sum over a part bounds what its trace may be off, where that is less than D says.
    """
    n = len(M)
    values, vectors = np.zeros(n, dtype=complex), np.zeros((n, n), dtype=complex)
    errors, groups = np.zeros(n), []
    inside, outside, least, most = True, False, -np.inf if line else 0.0, -np.inf if line else 0.0
    if not np.isfinite(M).all():
        return Bounds(values, np.full(n, np.inf), vectors, (np.arange(n),), False, False, least, np.inf)
    every, right = np.linalg.eig(M) if n else (values, vectors)
    taken = np.zeros(n, dtype=bool)
    for part in parts_of((np.abs(M) + D) != 0):
        square = np.ix_(part, part)
        one = None
        if len(part) == 2 and not line and np.isrealobj(M):
            known = None if volume is None else tuple(float(v[part].sum()) for v in volume)
            one = _two(M[square], D[square], known, np.inf if trace is None else float(trace[square].sum()))
        one = one or _part(M[square], D[square], line)
        values[part], errors[part] = one.values, one.errors
        groups += [part[g] for g in one.groups]
        inside, outside = inside and one.inside, outside or one.outside
        least, most = max(least, one.least), max(most, one.most)
        for k in part:  # the whole matrix's eigenvector, the nearest that is left
            j = int(np.argmin(np.where(taken, np.inf, np.abs(every - values[k]))))
            taken[j] = True
            vectors[:, k] = right[:, j]
    return Bounds(values, errors, vectors, tuple(groups), inside, outside, least, most)


def _size(z: np.ndarray, line: bool) -> np.ndarray:
    return z.real if line else np.abs(z)


@np.errstate(over="ignore", invalid="ignore")  # beyond the range of numbers nothing is known
def _part(M: np.ndarray, D: np.ndarray, line: bool) -> Bounds:
    n, edge = len(M), 0.0 if line else 1.0
    if n == 1:
        lam, error = M[0].astype(complex), D[0] + 2 * EPS * np.abs(M[0])
        at, e = float(_size(lam, line)[0]), float(error[0])
        return Bounds(lam, error, np.ones((1, 1)), (np.zeros(1, int),), at + e < edge, at - e > edge, at - e, at + e)
    _, (scale, _) = sla.matrix_balance(np.abs(M) + np.where(np.isfinite(D), D, 0.0), permute=False, separate=True)
    scale = scale if np.isfinite(scale).all() and (scale > 0).all() else np.ones(n)
    M, D = M * scale / scale[:, None], D * scale / scale[:, None]
    lam, V, W, G = refined(M)
    if np.isfinite(G).all():
        G = G + np.abs(W) @ (D @ np.abs(V)) * (1 + 1e-9) + np.diag(2 * EPS * np.abs(lam))
    errors, groups = _disks(lam, G)
    size = _size(lam, line)
    ball = D + 4 * EPS * np.abs(M)
    if np.isfinite(ball).all() and not (len(groups) == n and np.isfinite(errors).all()):
        groups = tuple(_clusters(*_triangular(M, ball), lam, errors, edge, line))
    most = float((size + errors).max())
    least = max(float((size[g] - errors[g]).min()) for g in groups)
    inside, outside = most < edge, least > edge
    if not inside and not outside and np.isfinite(D).all():
        if (size < edge).all():
            inside = separated(M, ball, edge, line) or separated(*_triangular(M, ball), edge, line)
            most = min(most, edge - SMALL) if inside else most
        elif size.max() > edge:
            outside = not line and _grows(M, ball)
            least = max(least, edge + SMALL) if outside else least
            radii = edge + (size.max() - edge) * np.array([0.0, 0.06, 0.25, 0.5, 0.75, 0.9]) if not outside else []
            for r in radii:
                if separated(M, ball, r, line):
                    outside, least = True, max(least, r + SMALL)
                    break
    return Bounds(lam, errors, V * scale[:, None], groups, bool(inside), bool(outside), least, most)


def _two(M: np.ndarray, D: np.ndarray, volume: tuple[float, ...] | None, known_trace: float) -> Bounds | None:
    """A part of two states: from the trace and the determinant of every member."""
    if not np.isfinite(D).all():
        return None
    trace = float(M[0, 0] + M[1, 1])
    slack = min(float(D[0, 0] + D[1, 1]), known_trace) + 4 * EPS * float(np.abs(np.diagonal(M)).sum())
    det = float(M[0, 0] * M[1, 1] - M[0, 1] * M[1, 0])
    size = np.abs(M) + D
    off = float(size[0, 0] * D[1, 1] + D[0, 0] * size[1, 1] + size[0, 1] * D[1, 0] + D[0, 1] * size[1, 0])
    off += 8 * EPS * float(size[0, 0] * size[1, 1] + size[0, 1] * size[1, 0])
    low, high = det - off, det + off
    if volume is not None and np.isfinite(volume[1]) and abs(volume[0]) + volume[1] < 600:
        known = np.exp(volume[0] + volume[1] * np.array([-1.0, 1.0])) * (1 + 64 * EPS * np.array([-1.0, 1.0]))
        if known[1] - known[0] < high - low:
            low, high = float(known[0]), float(known[1])
    if not np.isfinite([trace, slack, low, high]).all():
        return None
    lam, V = np.linalg.eig(M)
    lam = lam.astype(complex)
    inside = high < 1 and abs(trace) + slack < 1 + low
    outside = low > 1 or abs(trace) - slack > 1 + high
    traces, dets = [trace - slack, trace + slack], [low, high]
    corners = [_roots(a, b) for a in traces for b in dets]
    for b in dets:  # where the two meet, and where they are farthest apart on the circle
        for a in ([2 * np.sqrt(b), -2 * np.sqrt(b)] if b > 0 else []) + [0.0]:
            if traces[0] < a < traces[1]:
                corners.append(_roots(a, b))
    nearest = np.copysign(max(abs(trace) - slack, 0.0), trace)  # of traces to zero: the larger of its roots is ..
    corners.append(_roots(nearest, min(max(low, nearest**2 / 4), high)))  # .. smallest where they meet
    error = max(_apart(lam, other) for other in corners) + 8 * EPS * float(np.abs(lam).max())
    sizes = [float(np.abs(r).max()) for r in corners]
    groups = (np.array([0]), np.array([1])) if abs(lam[0] - lam[1]) > 2 * error else (np.arange(2),)
    return Bounds(lam, np.full(2, error), V, groups, bool(inside), bool(outside), min(sizes), max(sizes))


def _roots(trace: float, det: float) -> np.ndarray:
    root = np.sqrt(complex(trace**2 / 4 - det))
    big = trace / 2 + root if abs(trace / 2 + root) >= abs(trace / 2 - root) else trace / 2 - root
    return np.array([big, det / big if big != 0 else 0.0])


def _apart(a: np.ndarray, b: np.ndarray) -> float:
    """The larger distance of two pairs, paired so that it is least."""
    return float(min(np.abs(a - b).max(), np.abs(a - b[::-1]).max()))


def _grows(M: np.ndarray, D: np.ndarray) -> bool:
    """Whether a power of every member has a trace beyond n: its largest eigenvalue is at least |trace|/n."""
    P, E = M, D
    for _ in range(4):
        if abs(np.trace(P)) - float(np.trace(E)) > len(M) * (1 + 1e-6) and np.isfinite(P).all():
            return True
        P, E = P @ M, E @ (np.abs(M) + D) + np.abs(P) @ D
    return False


def _disks(lam: np.ndarray, G: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Radii (n,) and the groups of disks that touch."""
    n = len(lam)
    if not np.isfinite(G).all():
        return np.full(n, np.inf), (np.arange(n),)
    with np.errstate(invalid="ignore", divide="ignore"):
        _, (scale, _) = sla.matrix_balance(G + 1e-300, permute=False, separate=True)
    if np.isfinite(scale).all() and (scale > 0).all():
        G = G * scale / scale[:, None]
    own, whole = np.diagonal(G), G.sum(axis=1)
    rest = whole - own
    gap = np.abs(lam[:, None] - lam[None, :])
    touch = gap <= whole[:, None] + whole[None, :]
    groups = tuple(parts_of(touch))
    room = gap - whole[:, None] - whole[None, :]
    np.fill_diagonal(room, np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(room > 0, G.T / room, np.inf)
    np.fill_diagonal(share, 0.0)
    share = np.minimum(share.max(axis=1), 1.0)
    errors = np.where([bool(touch[k].sum() == 1) for k in range(n)], own + share * rest, whole)
    for g in groups:
        if len(g) > 1:
            mean = lam[g].mean()
            errors[g] = np.abs(lam[g] - mean) + np.max(np.abs(lam[g] - mean) + whole[g])
    return errors, groups


def _triangular(M: np.ndarray, D: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """M and D in Schur coordinates, where (z - M)^-1 of a cluster is triangular: |z - lambda| alone counts in rho."""
    T, Q = sla.schur(M, output="complex")
    return T, np.abs(Q).T @ D @ np.abs(Q) + 8 * EPS * len(M) * np.linalg.norm(M)


def _clusters(M: np.ndarray, D: np.ndarray, lam: np.ndarray, errors: np.ndarray, edge: float, line: bool) -> list:
    """Smaller disks about the means of clusters that no eigenvalue leaves, for those whose own are not known well.

    Clusters are what lies nearer to each other than a distance, which grows until each of them stands alone; those
    near the boundary come first. Returns the groups of all.
    """
    n, left = len(lam), int(max(100, WORK / len(lam) ** 3))
    gap = np.abs(lam[:, None] - lam[None, :])
    rest, groups = np.ones(n, dtype=bool), []
    size = max(float(np.abs(lam).max()), float(np.linalg.norm(M)), 1e-300)
    for reach in size * np.geomspace(1e-10, 1.0, 11):
        clusters = [c for c in parts_of(gap <= reach) if rest[c].all()]
        for c in sorted(clusters, key=lambda c: float(np.abs(_size(lam[c], line) - edge).min())):
            mean = complex(lam[c].mean())
            mean = complex(mean.real) if abs(mean.imag) < 1e-9 * size and len(c) > 1 else mean
            low = max(1.1 * float(np.abs(lam[c] - mean).max()), 64 * EPS * size)
            high = 0.5 * float(np.delete(np.abs(lam - mean), c).min(initial=4 * size))
            if not low < high or left <= 0:
                continue
            for r in np.geomspace(low, high, 7):
                left -= 32
                if separated(M, D, float(r), centre=mean, most=100):
                    errors[c] = np.minimum(errors[c], np.abs(lam[c] - mean) + r)
                    rest[c] = False
                    groups.append(c)
                    break
    return groups + ([np.flatnonzero(rest)] if rest.any() else [])


def separated(
    M: np.ndarray, D: np.ndarray, r: float, line: bool = False, *, centre: complex = 0.0, most: int = TESTS
) -> bool:
    """Whether no member has an eigenvalue on the circle |z - centre| = r, or on the line Re z = r."""
    most = int(min(most, max(200, WORK / len(M) ** 3)))
    if not np.isfinite(D).all():
        return False
    lam = np.linalg.eigvals(M)
    if line:
        reach = 1.01 * float(np.linalg.norm(np.abs(M) + D)) + r
        small = 1e-3 * max(float(np.abs(lam[np.abs(lam) > 0]).min(initial=reach)), 1e-18 * reach)
        edges = np.r_[0.0, np.geomspace(small, reach, 2 + int(np.log2(reach / small)))]
        first = r + 1j * lam.imag
    else:
        full = 2 * np.pi if complex(centre).imag else np.pi
        edges = np.linspace(0.0, full, 9)
        first = centre + r * np.exp(1j * np.angle(lam - centre))
    if not _free(M, D, first, np.zeros(len(first))).all():
        return False
    arcs, used = np.stack([edges[:-1], edges[1:]], axis=1), 0
    while len(arcs):
        middle, half = arcs.mean(axis=1), np.diff(arcs, axis=1)[:, 0] / 2
        z, d = (r + 1j * middle, half) if line else (centre + r * np.exp(1j * middle), r * half)
        used += 2 * len(arcs)
        if used > most:
            return False
        covered = _free(M, D, z, d)
        arcs = arcs[~covered]
        if not _free(M, D, z[~covered], np.zeros(len(arcs))).all():
            return False
        middle = middle[~covered]
        arcs = np.concatenate([np.stack([arcs[:, 0], middle], 1), np.stack([middle, arcs[:, 1]], 1)])
    return True


def _free(M: np.ndarray, D: np.ndarray, z: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Whether no member has an eigenvalue within d (q,) of z (q,)."""
    if not len(z):
        return np.zeros(0, dtype=bool)
    n, found = len(M), np.zeros(len(z), dtype=bool)
    D = D + EPS * np.abs(M)
    at_once = max(1, int(4e6 / n**2))
    for k in range(0, len(z), at_once):
        zk, dk = z[k : k + at_once], d[k : k + at_once]
        try:
            R = np.abs(np.linalg.inv(zk[:, None, None] * np.eye(n) - M))
        except np.linalg.LinAlgError:
            continue
        B = R @ D + dk[:, None, None] * R
        x, least = np.ones((len(zk), n)), np.full(len(zk), np.inf)
        for _ in range(10):
            y = np.einsum("kij,kj->ki", B, x) + 1e-300
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                least = np.fmin(least, (y / x).max(axis=1))
                x = y / y.max(axis=1, keepdims=True) + 1e-12
        found[k : k + at_once] = least < 1 - 1e-6
    return found
