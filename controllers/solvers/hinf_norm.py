"""H-infinity norm of a stable linear system: the largest singular value of its gain over all frequencies, and where.

A first guess on a grid is raised until no frequency passes it: the gain has the singular value gamma at omega exactly
where i omega is an eigenvalue of a Hamiltonian matrix (Boyd, Balakrishnan and Kabamba 1989), and between two such
frequencies it is larger or smaller throughout, so that midpoints give the next guess (Bruinsma and Steinbuch 1990). A
sampled system is mapped to a continuous one of the same gains by z = (1 + s)/(1 - s).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

from pliant.plants.core.errors import PliantError

Array = np.ndarray
TOLERANCE = 1e-7  # relative, of the norm
ON_AXIS = 1e-6  # |real part| against the eigenvalue's size that may be rounding; more candidates only cost time
MOST_ROUNDS = 60


class Peak(NamedTuple):
    """The largest gain and its frequency; infinite where it is approached, not reached."""

    value: float
    omega: float  # [rad/s]

    @property
    def hz(self) -> float:
        """[Hz]"""
        return self.omega / (2 * np.pi)


def peak(A: Array, B: Array, C: Array, D: Array, dt: float | None = None) -> Peak:
    """Largest singular value of C (s - A)^-1 B + D on the imaginary axis, or with z on the unit circle.

    A (n, n), B (n, m), C (p, n), D (p, m); a PliantError where A has a pole that does not decay.
    """
    poles = np.linalg.eigvals(A)
    rate = poles.real if dt is None else np.abs(poles) - 1
    if len(A) and rate.max() >= 0:
        raise PliantError(
            f"no gain is the largest of a system that does not decay: a pole is {poles[rate.argmax()]:.4g}"
        )
    if dt is not None:
        A, B, C, D = continuous(A, B, C, D)
        poles = np.linalg.eigvals(A)
    size = np.abs(poles)
    low, high = (size[size > 0].min(), size.max()) if (size > 0).any() else (1.0, 1.0)
    guesses = np.concatenate([[0.0], size, np.abs(poles.imag), np.geomspace(low / 100, 100 * high, 60)])
    best = max(zip(_gains(A, B, C, D, guesses), guesses))
    infinite = float(np.linalg.norm(D, 2)) if D.size else 0.0
    if infinite >= best[0]:
        best = (infinite, np.inf)
    for _ in range(MOST_ROUNDS):
        gamma = best[0] * (1 + 2 * TOLERANCE)
        if gamma == 0:
            break
        crossings = _crossings(A, B, C, D, gamma)
        if not len(crossings):
            break
        edges = np.concatenate([[0.0], crossings, [2 * crossings[-1] + low]])
        tried = np.concatenate([(edges[1:] + edges[:-1]) / 2, np.sqrt(np.maximum(edges[1:] * edges[:-1], 0))])
        found = max(zip(_gains(A, B, C, D, tried), tried))
        if found[0] <= gamma:
            best = max(best, found)
            break
        best = found
    else:
        raise PliantError(f"the norm is not found to {TOLERANCE:g} in {MOST_ROUNDS} rounds: scale the states")
    value, omega = float(best[0]), float(best[1])
    if dt is not None:
        omega = 2 * np.arctan(omega) / dt
    return Peak(value, omega)


def continuous(A: Array, B: Array, C: Array, D: Array) -> tuple[Array, Array, Array, Array]:
    """The continuous-time system whose gain at i tan(omega dt/2) is the sampled one's at e^(i omega dt)."""
    n = len(A)
    inverse = np.linalg.inv(A + np.eye(n))
    return inverse @ (A - np.eye(n)), np.sqrt(2) * inverse @ B, np.sqrt(2) * C @ inverse, D - C @ inverse @ B


def _gains(A: Array, B: Array, C: Array, D: Array, omega: Array) -> Array:
    """Largest singular values (k,) at omega (k,)."""
    shifted = 1j * omega[:, None, None] * np.eye(len(A)) - A
    G = C @ np.linalg.solve(shifted, np.broadcast_to(B.astype(complex), (len(omega), *B.shape))) + D
    return np.linalg.svd(G, compute_uv=False).max(axis=-1, initial=0.0)


def _crossings(A: Array, B: Array, C: Array, D: Array, gamma: float) -> Array:
    """Frequencies [rad/s], ascending, at which a singular value may be gamma."""
    m = B.shape[1]
    R = gamma**2 * np.eye(m) - D.T @ D
    RB, RD = sla.solve(R, B.T, assume_a="sym"), sla.solve(R, D.T, assume_a="sym")
    F = A + B @ RD @ C
    H = np.block([[F, B @ RB], [-C.T @ (np.eye(len(C)) + D @ RD) @ C, -F.T]])
    lam = np.linalg.eigvals(H)
    on = np.abs(lam.real) <= ON_AXIS * np.maximum(np.abs(lam), ON_AXIS * np.abs(lam).max(initial=1.0))
    return np.unique(np.abs(lam.imag[on]))
