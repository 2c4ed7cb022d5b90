"""What data tell of parameters: the Fisher information, intervals, and the directions that cannot be told.

Of residuals r = (y - y(theta))/sigma with independent normal noise the information is F = J'J, J = d(y/sigma)/d(theta),
and F^-1 bounds the covariance of every unbiased estimate (Cramer and Rao; Kay, "Fundamentals of Statistical Signal
Processing: Estimation Theory", Section 3.9). Unknown starts are eliminated: R is the triangular factor of J with their
columns first, and what is left below them is the information on the parameters alone (Schur complement).

Directions are judged in relative changes of the parameters, d(theta)/|theta|: along the right singular vector v_i of R
the standard deviation is 1/sigma_i. A direction is untold where a change by the parameters' own size stays within the
noise, 1.96/sigma_i > 1, or where columns of R, each of length one, are dependent to rounding (the collinearity of Brun,
Reichert and Kuensch 2001, "Practical identifiability analysis of large environmental simulation models").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray
NORMAL = 1.959963984540054  # quantile of 97.5 % of the normal distribution
DEPENDENT = 1e-7  # singular value of columns of length one: what a sensitivity's rounding leaves, and more
TOLD = 0.1  # of a direction's largest entry: smaller ones are not named


@dataclass(frozen=True)
class Untold:
    """Parameters that can only be told together, or one that cannot be told: relative changes along `direction` do not
    show in the data.
    """

    names: tuple[str, ...]
    direction: tuple[float, ...]  # d(theta)/|theta|, the largest 1
    standard_deviation: float  # relative, along the direction of unit length; inf where columns are dependent

    @property
    def words(self) -> str:
        """As a sentence."""
        if len(self.names) == 1:
            return f"{self.names[0]} cannot be told from these data"
        ratio = ", ".join(f"{part:+.3g}" for part in self.direction)
        return f"{' and '.join(self.names)} cannot be told apart: relative changes by {ratio} do not show"


def triangle(rows: Array) -> Array:
    """R (n, n), upper triangular, with R'R = rows'rows of any number of rows (m, n)."""
    R = np.linalg.qr(rows, mode="r")
    found = np.zeros((rows.shape[1],) * 2)
    found[: len(R)] = R
    return found


def condensed(J: Array, r: Array) -> Array:
    """(n + 1, n + 1) upper triangular [[R, Q'r], [0, rest]] of a Jacobian (m, n) and a residual (m,)."""
    return triangle(np.hstack([J, r[:, None]]))


def covariance(R: Array) -> Array:
    """(R'R)^-1, with inf on the diagonal of what R says nothing of. Columns are scaled to length one on the way."""
    size = np.linalg.norm(R, axis=0)
    known = size > 0
    found = np.full((len(size), len(size)), 0.0)
    np.fill_diagonal(found, np.inf)
    if known.any():
        _, s, V = np.linalg.svd(R[:, known] / size[known], full_matrices=False)
        kept = s > DEPENDENT * s[0]
        half = V[kept].T / s[kept]
        part = half @ half.T / np.outer(size[known], size[known])
        lost = (np.abs(V[~kept]) > TOLD * np.abs(V[~kept]).max(axis=1, initial=1e-300)[:, None]).any(axis=0)
        part[lost, :] = part[:, lost] = 0.0
        part[lost, lost] = np.inf
        found[np.ix_(known, known)] = part
    return found


def untold(R: Array, names: tuple[str, ...]) -> tuple[Untold, ...]:
    """Groups of parameters that R (np, np), in relative changes, cannot tell."""
    size = np.linalg.norm(R, axis=0)
    silent = size < NORMAL  # by its whole size, all others known, it does not leave the noise
    found = [Untold((names[j],), (1.0,), float(1 / size[j]) if size[j] else np.inf) for j in np.flatnonzero(silent)]
    rest = np.flatnonzero(~silent)
    if not len(rest):
        return tuple(found)
    unit = R[:, rest] / size[rest]
    _, s, V = np.linalg.svd(unit, full_matrices=False)
    dependent = V[s <= DEPENDENT * s[0]] / size[rest]  # back from lengths of one to relative changes
    _, s, V = np.linalg.svd(R[:, rest], full_matrices=False)
    weak = V[s < NORMAL]
    for direction in sparse(weak if len(weak) >= len(dependent) else dependent):
        length = np.linalg.norm(direction)
        seen = np.linalg.norm(R[:, rest] @ direction)
        lost = seen <= len(rest) * DEPENDENT * np.linalg.norm(direction * size[rest])
        members = np.flatnonzero(np.abs(direction) >= TOLD)
        entries = tuple(float(part) for part in direction[members])
        found.append(Untold(tuple(names[rest[j]] for j in members), entries, np.inf if lost else float(length / seen)))
    return tuple(found)


def sparse(basis: Array) -> Array:
    """Vectors (k, n) of the same span as the rows, each with as few entries as elimination gives, the largest 1."""
    rows, taken = np.array(basis), []
    for k in range(len(rows)):
        free = [j for j in range(rows.shape[1]) if j not in taken]
        i, j = np.unravel_index(np.abs(rows[k:, free]).argmax(), (len(rows) - k, len(free)))
        rows[[k, k + int(i)]] = rows[[k + int(i), k]]
        pivot = free[int(j)]
        taken.append(pivot)
        rows[k] /= rows[k, pivot]
        for other in range(len(rows)):
            if other != k:
                rows[other] -= rows[other, pivot] * rows[k]
    if not len(rows):
        return rows
    largest = rows[np.arange(len(rows)), np.abs(rows).argmax(axis=1)]
    return rows / largest[:, None]
