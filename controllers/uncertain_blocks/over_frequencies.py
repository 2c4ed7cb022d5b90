"""The upper bound of the structured singular value over all frequencies, which no grid can miss.

Scalings D, G found at one frequency hold as far around it as

    F(omega) = beta^2 D - M* D M - j (G M - M* G)

stays positive definite: up to where j omega is an eigenvalue of a Hamiltonian matrix (as in Ferreres, Magni and
Biannic 2003). One frequency after the other is taken in the middle of what is not yet covered; where scalings show no
less, beta is raised to what they show. A sampled system is mapped to a continuous one of the same gains.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pliant.controllers.solvers.hinf_norm import continuous
from pliant.plants.core.imports import linalg

from .blocks import Structure, structure
from .fractional_form import FractionalForm
from .scalings import Scalings, allowed, upper

Array = np.ndarray
ABOVE = 1.002  # times what scalings show: the bound that is raised to
ENOUGH = 0.999  # of the bound: scalings that are not improved further
ON_AXIS = 1e-7  # |real part| over the eigenvalue's modulus that may be rounding
MOST = 400  # frequencies
NARROW = 1e-6  # relative width of a gap over which beta is raised until scalings hold: a real bound may jump there
RAISED = 1.005
WELL = 0.98  # of the bound: scalings that hold over such a gap


class Bound(NamedTuple):
    """beta, the frequency [rad/s] at which it was last raised, and how many were looked at."""

    beta: float
    omega: float
    looked: int


def bound(form: FractionalForm, least: float = 0.0, most: float = np.inf) -> Bound:
    """The least beta that scalings show at all frequencies, not below `least`; infinite past `most`."""
    A, B, C, D = form.A, form.B, form.C, form.D
    if form.dt is not None:
        A, B, C, D = continuous(A, B, C, D)
    A, B, C = _even(A, B, C)
    scale = float(np.abs(np.linalg.eigvals(A)).max(initial=1.0))
    of, beta, where = structure(form.blocks), max(least, 1e-9), np.inf

    def gain(omega: float) -> Array:
        return C @ np.linalg.solve(1j * omega * np.eye(len(A)) - A, B.astype(complex)) + D

    start, looked = upper(D.astype(complex), of, enough=ENOUGH * beta), 1
    if start.beta > beta:
        beta = start.beta * ABOVE
    gaps = _left(0.0, np.inf, _holds(A, B, C, D, start, beta, np.inf))
    still = True  # the constant gain comes first: a bound for real blocks may be large there alone
    while gaps or still:
        low, high = (0.0, 0.0) if still else gaps.pop()
        omega, still = (0.0 if still else _middle(low, high, scale)), False
        found = _reduced(gain(omega), of, start, beta)
        looked += 1
        if found.beta > beta:
            beta, where = found.beta * ABOVE, omega
        covered = _holds(A, B, C, D, found, beta, omega)
        while high > 0 and high - low <= NARROW * high and not (covered[0] <= low and high <= covered[1]):
            beta, where = beta * RAISED, omega
            found = upper(gain(omega), of, None, WELL * beta)
            covered = _holds(A, B, C, D, found, beta, omega)
            if beta > most:
                break
        if beta > most or looked >= MOST:
            return Bound(np.inf, where, looked)
        start = found
        if high > 0:
            gaps += _left(low, high, covered)
        else:
            gaps = [part for gap in gaps for part in _left(*gap, covered)]
    if form.dt is not None:
        where = 2 * np.arctan(where) / form.dt
    return Bound(beta, where, looked)


def _even(A: Array, B: Array, C: Array) -> tuple[Array, Array, Array]:
    """The states in units in which A has rows and columns of like size."""
    _, (unit, _) = linalg.matrix_balance(A, permute=False, separate=True)
    return A * unit / unit[:, None], B / unit[:, None], C * unit


def _reduced(M: Array, of: Structure, start: Scalings, beta: float) -> Scalings:
    """Scalings of M that show less than beta, if they are found: those of a neighbour first."""
    had = allowed(M, start.D, start.G) ** 0.5
    if had <= ENOUGH * beta:
        return Scalings(had, start.D, start.G)
    return upper(M, of, start if had < 3 * beta else None, ENOUGH * beta)


def _middle(low: float, high: float, scale: float) -> float:
    if np.isinf(high):
        return 10 * max(low, scale)
    return float(np.sqrt(low * high)) if low > 1e-6 * scale else high / 2 if low == 0 else (low + high) / 2


def _left(low: float, high: float, covered: tuple[float, float]) -> list[tuple[float, float]]:
    """What of (low, high) is not covered."""
    parts = [(low, min(high, covered[0])), (max(low, covered[1]), high)]
    return [(a, b) for a, b in parts if b > a]


def _holds(A: Array, B: Array, C: Array, D: Array, found: Scalings, beta: float, omega: float) -> tuple[float, float]:
    """Between which frequencies about omega F stays definite; empty where it is not there."""
    n, m = len(A), len(D)
    outer = np.block([[-found.D, 1j * found.G], [-1j * found.G, beta**2 * found.D]])
    inner = np.block([[C, D], [np.zeros((m, n)), np.eye(m)]])
    T = inner.T @ outer @ inner
    Q, S, R = T[:n, :n], T[:n, n:], T[n:, n:]
    K = np.linalg.solve(R, np.hstack([S.conj().T, B.T.astype(complex)]))
    F, G = A - B @ K[:, :n], B @ K[:, n:]
    H = np.block([[F, -G], [-(Q - S @ K[:, :n]), -F.conj().T]])
    values = np.linalg.eigvals(H)
    size = np.abs(values)
    on = np.abs(values.real) <= ON_AXIS * np.maximum(size, 1e-3 * size.max(initial=0.0))
    at = np.abs(values.imag[on]) if np.isinf(omega) else values.imag[on]
    at = at[at >= 0]
    if np.isinf(omega):
        if np.linalg.eigvalsh((R + R.conj().T) / 2)[0] <= 0:
            return np.inf, np.inf
        return float(at.max(initial=0.0)), np.inf
    if omega == 0:
        return 0.0, float(np.abs(values.imag[on]).min(initial=np.inf))
    return float(at[at < omega].max(initial=0.0)), float(at[at > omega].min(initial=np.inf))
