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
from pliant.plants.linear.even_units import even_expm, even_units
from pliant.plants.linear.ltv import LTVModel, held_steps, splined

Array = np.ndarray
ACROSS = 0.5  # |eigenvalue| of A times a stretch, at most
FEWEST, MOST = 400, 40_000  # stretches
LOOKED = 16  # nodes


class Stretches:
    """Of `model`, from columns `into` (nt, nx, nw) and rows `seen`, `direct` (nt, nz, nx), (nt, nz, nw)."""

    def __init__(self, model: LTVModel, into: Array, seen: Array, direct: Array, driven: float = 1.0) -> None:
        self.model, self.driven = model, driven  # `into` times that is what drives the model
        t, parts = model.t, _parts(model)
        ends = [t[k] + (t[k + 1] - t[k]) * np.arange(n) / n for k, n in enumerate(parts)]
        self.t = np.append(np.concatenate(ends), t[-1])
        self.h = np.diff(self.t)
        gauss = (self.t[:-1, None] + self.h[:, None] * GAUSS).ravel()
        self._values = model.A, into, seen, direct
        at_gauss = [splined(t, a, gauss).reshape(len(self.h), 2, *a.shape[1:]) for a in self._values]
        self.A, self.E, self.C, self.F = at_gauss
        self.n, self.nw, self.nz = self.A.shape[-1], into.shape[-1], seen.shape[-2]

    @cached_property
    def nodes(self) -> tuple[Array, Array, Array, Array]:
        """A, E, C, F at the ends of stretches, (n + 1, ..)."""
        found = tuple(splined(self.model.t, a, self.t) for a in self._values)
        return found[0], found[1], found[2], found[3]

    def between(self, share: float) -> tuple[Array, Array, Array, Array]:
        """The same at a share of each stretch, (n, ..)."""
        at = self.t[:-1] + share * self.h
        found = tuple(splined(self.model.t, a, at) for a in self._values)
        return found[0], found[1], found[2], found[3]

    @property
    def passed(self) -> tuple[Array, ...]:
        """F at Gauss points, at ends and in the middle of stretches."""
        return self.F, self.nodes[3], self.between(0.5)[3]

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


def _parts(model: LTVModel) -> Array:
    """Equal parts (nt - 1,) of each interval, so that the fastest mode and a short nominal are both resolved.

    Eigenvalues are found at a few nodes, and where the matrix, in even units, is largest.
    """
    none = np.zeros(model.A.shape[-1])
    unit = even_units(model.A, none, none)
    size = np.linalg.norm(model.A * unit / unit[:, None], axis=(1, 2))
    looked = np.union1d(np.arange(0, len(size), max(1, len(size) // LOOKED)), np.argsort(size)[-LOOKED:])
    rates = np.abs(np.linalg.eigvals(model.A[looked])).max(axis=1, initial=0.0)
    share = float((rates / np.maximum(size[looked], np.finfo(float).tiny)).max(initial=0.0))
    fastest = np.minimum(share * size, float(rates.max(initial=0.0)))  # [1/s] at each node
    h = np.diff(model.t)
    wanted = np.maximum(np.maximum(fastest[1:], fastest[:-1]) * h / ACROSS, FEWEST * h / h.sum())
    parts = np.maximum(np.ceil(wanted * (1 - 1e-9)), 1.0)
    if parts.sum() > MOST:
        raise ValueError(
            f"finite_horizon: modes of up to {fastest.max():.4g} 1/s need {parts.sum():,.0f} stretches, more than "
            f"{MOST:,}: leave out the fastest modes"
        )
    return parts.astype(int)
