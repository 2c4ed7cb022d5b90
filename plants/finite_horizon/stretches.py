"""An LTV model cut into short stretches, in units of what counts alike: transitions, and integrals over each stretch.

From disturbances w to outputs z, both divided by their sizes: dx/dt = A x + E w, z = C x + F w. Over a stretch of h,
with Phi(s) its transition matrix up to s,

Phi     x at its end from x at its start; Gamma: from w held
W       integral of Phi E E' Phi' to its end: what w of unit energy can reach, squared
Q       [x; w]' Q [x; w] is the integral of |z|^2 over it, from x at its start and w held

A, E, C and F between the nodes are cubic splines, a stretch is one step of the fourth-order Magnus method (`magnus`).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from pliant.plants.core.signals import GAUSS
from pliant.plants.linear import magnus
from pliant.plants.linear.even_units import even_expm
from pliant.plants.linear.ltv import LTVModel, held_steps, splined

Array = np.ndarray
ACROSS = 0.5  # |eigenvalue| of A times a stretch, at most
FEWEST, MOST = 400, 40_000  # stretches


class Stretches:
    """Of `model`, from columns `into` (nt, nx, nw) and rows `seen`, `direct` (nt, nz, nx), (nt, nz, nw)."""

    def __init__(self, model: LTVModel, into: Array, seen: Array, direct: Array) -> None:
        self.model = model
        parts = self._parts(model)
        t = model.t
        self.parts = parts
        self.t = np.r_[(t[:-1, None] + np.diff(t)[:, None] * np.arange(parts) / parts).ravel(), t[-1]]
        self.h = np.diff(self.t)
        gauss = (self.t[:-1, None] + self.h[:, None] * GAUSS).ravel()
        self._values = model.A, into, seen, direct
        at_gauss = [splined(t, a, gauss).reshape(len(self.h), 2, *a.shape[1:]) for a in self._values]
        self.A, self.E, self.C, self.F = at_gauss
        self.n, self.nw, self.nz = self.A.shape[-1], into.shape[-1], seen.shape[-2]

    @staticmethod
    def _parts(model: LTVModel) -> int:
        """Equal parts of each interval, so that the fastest mode and a short nominal are both resolved."""
        few = model.A[:: max(1, len(model.t) // 8)]
        fastest = float(np.abs(np.linalg.eigvals(few)).max(initial=0.0))
        h = float(np.diff(model.t).max())
        parts = max(1, int(np.ceil(fastest * h / ACROSS)), int(np.ceil(FEWEST / (len(model.t) - 1))))
        if parts * (len(model.t) - 1) > MOST:
            raise ValueError(
                f"finite_horizon: modes of up to {fastest:.4g} 1/s need {parts} stretches in each of "
                f"{len(model.t) - 1} intervals, more than {MOST:,}: leave out the fastest modes"
            )
        return parts

    @cached_property
    def nodes(self) -> tuple[Array, Array, Array, Array]:
        """A, E, C, F at the ends of stretches, (n + 1, ..)."""
        found = tuple(splined(self.model.t, a, self.t) for a in self._values)
        return found[0], found[1], found[2], found[3]

    @cached_property
    def held(self) -> tuple[Array, Array]:
        """Phi (m, n, n), Gamma (m, n, nw)."""
        return held_steps(self.A, self.E, self.h)

    @cached_property
    def gramians(self) -> Array:
        """W (m, n, n)."""
        return magnus.reached(self.A, self.E @ _t(self.E), self.h)

    @cached_property
    def costs(self) -> Array:
        """Q (m, n + nw, n + nw)."""
        k = self.n + self.nw
        whole, out = np.zeros((len(self.h), 2, k, k)), np.concatenate([self.C, self.F], axis=-1)
        whole[..., : self.n, :] = np.concatenate([self.A, self.E], axis=-1)
        return magnus.costed(whole, _t(out) @ out, self.h)[1]

    def hamiltonian(self, gain: float) -> Array:
        """Transitions (m, 2n, 2n), backward over each stretch, of the Riccati equation of the bounded real lemma."""
        return even_expm(-magnus.exponent(self._hamiltonian(gain), self.h))

    def turn(self, gain: float) -> float:
        """The largest |eigenvalue| of its Hamiltonian, at a few times, over a stretch."""
        some = slice(None, None, max(1, len(self.h) // 16))
        return float((np.abs(np.linalg.eigvals(self._hamiltonian(gain)[some, 0])).max(axis=1) * self.h[some]).max())

    def _hamiltonian(self, gain: float) -> Array:
        n = self.n
        R = gain**2 * np.eye(self.nw) - _t(self.F) @ self.F
        inverse = np.linalg.inv(R)
        through = self.E @ inverse @ _t(self.F)
        A = self.A + through @ self.C
        H = np.zeros((len(self.h), 2, 2 * n, 2 * n))
        H[..., :n, :n], H[..., n:, n:] = A, -_t(A)
        H[..., :n, n:] = self.E @ inverse @ _t(self.E)
        H[..., n:, :n] = -_t(self.C) @ (np.eye(self.nz) + self.F @ inverse @ _t(self.F)) @ self.C
        return H


def _t(M: Array) -> Array:
    return np.swapaxes(M, -1, -2)
