"""The largest energy of the outputs that a disturbance of unit energy causes: its square root, from below and above.

Below: a disturbance held over each stretch, found by Lanczos iterations on the map from it to the outputs and back by
the adjoint; its gain is that of the model. Above: the Riccati differential equation of the bounded real lemma,

    -dP/dt = A'P + P A + C'C + (P E + C'F) (g^2 - F'F)^-1 (E'P + F'C),  P(T) = 0,

has a solution back to the start where the gain is below g (Green and Limebeer, Linear Robust Control, 1995, theorem
3.7.4), found as a linear fractional map of the Hamiltonian's transitions. Both hold to the fourth order of these in the
stretches.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pliant.plants.core.imports import linalg
from pliant.plants.core.signals import OwnsArrays
from pliant.plants.linear.even_units import even_units

from .stretches import Stretches

Array = np.ndarray
CLOSE = (1.001, 1.003, 1.006, 1.0099, 1.03, 1.1, 1.3, 2.0, 4.0)  # times the lower bound: gains tried as an upper one
TURN = 1.0  # h |eigenvalue| of the Hamiltonian up to which P cannot run away and come back in a stretch: that takes pi
LANCZOS = 1e-4  # relative tolerance of the iterations
RESTARTS, POWERS = 40, 40
NEGATIVE, SMALL = 1e-6, 1e-12


@dataclass(frozen=True, eq=False)
class Gain(OwnsArrays):
    """At least `lower`, which `disturbance` attains, and at most `upper`."""

    lower: float
    upper: float  # infinite where none was shown
    disturbance: Array = field(repr=False)  # (nt, nw) in the disturbances' units, held from each time to the next
    time: float | None = None  # [s] when an output is pushed furthest

    @property
    def gap(self) -> float:
        """Relative distance of the bounds."""
        return float("inf") if not self.lower > 0 else self.upper / self.lower - 1


def energy_gain(on: Stretches) -> Gain:
    """From w to z, x zero at the start."""
    lower, worst = _below(on)
    if not lower > 0:
        return Gain(0.0, 0.0 if not np.abs(on.C).max() or not np.abs(on.E).max() else np.inf, worst)
    through = max(float(np.linalg.norm(F, 2, axis=(-2, -1)).max(initial=0.0)) for F in on.passed)
    for times in CLOSE:
        gain = lower * times
        if gain > through and bounds(on, gain):
            return Gain(lower, gain, worst)
    return Gain(lower, np.inf, worst)


def _below(on: Stretches) -> tuple[float, Array]:
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

    (Phi, Gamma), Q, m, n, nw = on.held, on.costs, len(on.h), on.n, on.nw
    root = np.sqrt(on.h)[:, None]
    Phi_t, Gamma_t = (np.ascontiguousarray(np.swapaxes(M, 1, 2)) for M in (Phi, Gamma))
    onward, back = list(Phi), list(Phi_t)[::-1]

    def there_and_back(v: Array) -> Array:
        w = v.reshape(m, nw) / root
        push, x = np.einsum("kij,kj->ki", Gamma, w), np.zeros((m, n))
        for step, added, now, then in zip(onward, push, x, x[1:]):
            step.dot(now, out=then)
            then += added
        felt = np.einsum("kij,kj->ki", Q, np.concatenate([x, w], axis=1))
        costates = np.zeros((m, n))
        for step, added, now, then in zip(back, felt[::-1, :n], costates[::-1], costates[-2::-1]):
            step.dot(now, out=then)
            then += added
        return np.ravel((felt[:, n:] + np.einsum("kij,kj->ki", Gamma_t, costates)) / root)

    size = m * nw
    start = np.random.default_rng(0).normal(size=size)
    if not np.abs(there_and_back(start)).max() > 0:
        return 0.0, np.zeros((m + 1, nw))
    if size < 3:
        columns = np.array([there_and_back(e) for e in np.eye(size)])
        _, vectors = np.linalg.eigh((columns + columns.T) / 2)
    else:
        operator = LinearOperator((size, size), matvec=there_and_back, dtype=float)
        try:
            _, vectors = eigsh(operator, k=1, which="LA", v0=start, tol=LANCZOS, maxiter=RESTARTS)
        except ArpackNoConvergence:  # a spectrum without gaps: what the iterations began with is a disturbance too
            vectors = start[:, None]
            for _ in range(POWERS):
                vectors = there_and_back(vectors[:, 0])[:, None] / np.linalg.norm(vectors)
    best = vectors[:, -1] / np.linalg.norm(vectors[:, -1])
    return float(np.sqrt(max(best @ there_and_back(best), 0.0))), np.vstack(
        [best.reshape(m, nw) / root, np.zeros((1, nw))]
    )


def bounds(on: Stretches, gain: float) -> bool:
    """Whether the Riccati equation at `gain` goes back to the start: the true gain is then no larger.

    In even units, in which P is about one, not negative but for the error of the transitions, and large where it has
    come back from the other side of infinity. On its way there the matrix that is solved for has been singular.
    """
    n, S, places = on.n, on.hamiltonian(gain), np.arange(on.n)
    dgetrf, dgetrs = linalg.lapack.dgetrf, linalg.lapack.dgetrs
    if on.turn(gain) > TURN:
        return False
    reach, sight = (np.square(M).mean(axis=(0, 1)) for M in (np.swapaxes(on.E, -1, -2), on.C))
    unit = even_units(on.A, reach.sum(axis=0) / gain**2, sight.sum(axis=0))
    both = np.concatenate([unit, 1 / unit])
    S, P = S * both / both[:, None], np.zeros((n, n))
    for k in on.group[::-1]:
        part = S[k]
        factors, swaps, singular = dgetrf((part[:n, :n] + part[:n, n:] @ P).T, overwrite_a=True)
        turned = np.count_nonzero(swaps != places) + np.count_nonzero(factors.diagonal() < 0)
        if singular or turned % 2:  # or not positive: the determinant
            return False
        P = dgetrs(factors, swaps, (part[n:, :n] + part[n:, n:] @ P).T, overwrite_b=True)[0]
        P = (P + P.T) / 2
        if not np.isfinite(P).all() or not _not_negative(P):
            return False
    return True


def _not_negative(P: Array) -> bool:
    """Whether no eigenvalue of P (n, n), symmetric, is below -NEGATIVE of the largest, or of SMALL."""
    shifted = P + np.diag(np.full(len(P), NEGATIVE * max(P.diagonal().max(), SMALL)))
    if not linalg.lapack.dpotrf(shifted, overwrite_a=True)[1]:  # no diagonal entry is above the largest eigenvalue
        return True
    values = np.linalg.eigvalsh(P)
    return bool(values[0] >= -NEGATIVE * max(values[-1], SMALL))
