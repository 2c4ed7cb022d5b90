"""An LTV model cut into short stretches, in units of what counts alike: transitions, and integrals over each stretch.

From disturbances w to outputs z, both divided by their sizes: dx/dt = A x + E w, z = C x + F w. Over a stretch of h,
with Phi(s) its transition matrix up to s,

Phi     x at its end from x at its start; Gamma: from w held
W       integral of Phi E E' Phi' to its end: what w of unit energy can reach, squared
Q       [x; w]' Q [x; w] is the integral of |z|^2 over it, from x at its start and w held

A, E, C and F between the nodes are cubic splines, a stretch is one step of the fourth-order Magnus method (`magnus`).
Where fast modes ask for many stretches and A varies little over several of them, these share one exponent: a part of
that method's over all of them, so that their ends together are as good, and E, C and F are what they are in the mean.
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
SHARED = 2e6  # stretches times states cubed, above which they share exponents
TURNED = 0.01  # by which a change of A's eigenvalues within those that share one may turn a mode
TERMS = 12  # of a Taylor series in a stretch


class Stretches:
    """Of `model`, from columns `into` (nt, nx, nw) and rows `seen`, `direct` (nt, nz, nx), (nt, nz, nw)."""

    def __init__(self, model: LTVModel, into: Array, seen: Array, direct: Array, driven: float = 1.0) -> None:
        self.model, self.driven = model, driven  # `into` times that is what drives the model
        t = model.t
        parts, groups = _parts(model)
        ends = [t[k] + (t[k + 1] - t[k]) * np.arange(n) / n for k, n in enumerate(parts)]
        self.t = np.append(np.concatenate(ends), t[-1])
        self.h = np.diff(self.t)
        shared = np.repeat(parts // groups, groups)  # stretches of each group
        self.group = np.repeat(np.arange(len(shared)), shared)  # (m,) of each stretch
        first = np.cumsum(shared) - shared
        self.first, self.last = first, first + shared  # stretches of a group: from the first until before the last
        self._between: dict[float, tuple[Array, Array]] = {}
        self._h = self.h[first]
        gauss = (self.t[first, None] + (shared * self._h)[:, None] * GAUSS).ravel()
        self._values = model.A, into, seen, direct
        at_gauss = [splined(t, a, gauss).reshape(len(shared), 2, *a.shape[1:]) for a in self._values]
        if len(shared) < len(self.h):
            whole = shared * self._h
            mean = magnus.exponent(at_gauss[0], whole) / whole[:, None, None]
            at_gauss = [mean[:, None].repeat(2, axis=1), *(_in_the_mean(a) for a in at_gauss[1:])]
        self.A, self.E, self.C, self.F = at_gauss
        self.n, self.nw, self.nz = self.A.shape[-1], into.shape[-1], seen.shape[-2]

    @cached_property
    def nodes(self) -> tuple[Array, Array, Array]:
        """E, C, F at the ends of stretches, (m + 1, ..)."""
        found = tuple(splined(self.model.t, a, self.t) for a in self._values[1:])
        return found[0], found[1], found[2]

    @property
    def alike(self) -> bool:
        """Whether stretches share exponents."""
        return len(self._h) < len(self.h)

    def rates(self, sees: Array) -> tuple[Array, Array]:
        """`sees` (m, k, n) times A at the start and at the end of each stretch, (m, k, n)."""
        if self.alike:
            own = np.empty_like(sees)
            for begin, end, A in zip(self.first, self.last, self.A[:, 0]):
                own[begin:end] = (sees[begin:end].reshape(-1, self.n) @ A).reshape(own[begin:end].shape)
            return own, own
        return sees @ self._nodes_A[:-1], sees @ self._nodes_A[1:]

    @cached_property
    def _nodes_A(self) -> Array:
        return splined(self.model.t, self._values[0], self.t)

    def between(self, share: float) -> tuple[Array, Array]:
        """C and F at a share of each stretch, (m, ..)."""
        if share not in self._between:
            at = self.t[:-1] + share * self.h
            found = tuple(splined(self.model.t, a, at) for a in self._values[2:])
            self._between[share] = found[0], found[1]
        return self._between[share]

    @property
    def passed(self) -> tuple[Array, ...]:
        """F at Gauss points, at ends and in the middle of stretches."""
        return self.F, self.nodes[2], self.between(0.5)[1]

    @cached_property
    def held(self) -> tuple[Array, Array]:
        """Phi (m, n, n), Gamma (m, n, nw)."""
        Phi, Gamma = self.moves
        return self._each(Phi), self._each(Gamma)

    @cached_property
    def moves(self) -> tuple[Array, Array]:
        """The same of each group, of which `group` says the stretches."""
        return held_steps(self.A, self.E, self._h)

    @cached_property
    def wholes(self) -> Array:
        """The transition over each group, all its stretches."""
        Phi, count = self.moves[0], self.last - self.first
        if not self.alike:
            return Phi
        found, power = np.repeat(np.eye(self.n)[None], len(Phi), axis=0), Phi
        while count.any():
            odd = count % 2 == 1
            found[odd] = found[odd] @ power[odd]
            count = count // 2
            if count.any():
                power = power @ power
        return found

    @property
    def gramians(self) -> Array:
        """W (m, n, n)."""
        return self._each(self.reached)

    @cached_property
    def reached(self) -> Array:
        """W of a stretch of each group."""
        if not self.alike:
            return magnus.reached_by(self.A, self.E, self.h)
        A, term, h = self.A[:, 0], self.E[:, 0], self._h[:, None, None]
        series = [term]
        for k in range(1, TERMS):
            term = h / k * (A @ term)
            series.append(term)
        weights = 1 / (1 + np.add.outer(np.arange(TERMS), np.arange(TERMS)))  # of the products of two powers of s / h
        pushes = np.stack(series, axis=1)
        later = np.einsum("jk,gknw->gjnw", weights, pushes)
        flat = (np.moveaxis(v, 1, 2).reshape(len(A), self.n, -1) for v in (pushes, later))
        return np.asarray(h * (next(flat) @ _t(next(flat))))

    def _each(self, found: Array) -> Array:
        """Of each stretch from that of each group."""
        return found[self.group] if self.alike else found

    @cached_property
    def costs(self) -> Array:
        """Q (m, n + nw, n + nw)."""
        k = self.n + self.nw
        whole, out = np.zeros((len(self._h), 2, k, k)), np.concatenate([self.C, self.F], axis=-1)
        whole[..., : self.n, :] = np.concatenate([self.A, self.E], axis=-1)
        return self._each(magnus.reached_by(_t(whole)[:, ::-1], _t(out)[:, ::-1], self._h))  # of the adjoint, backward

    def hamiltonian(self, gain: float) -> Array:
        """Transitions (.., 2n, 2n), by group and backward over each of its stretches, of the Riccati equation of the
        bounded real lemma.
        """
        return even_expm(-magnus.exponent(self._hamiltonian(gain), self._h))

    def turn(self, gain: float) -> float:
        """The largest |eigenvalue| of its Hamiltonian, at a few times, over a stretch."""
        some = slice(None, None, max(1, len(self._h) // 16))
        return float((np.abs(np.linalg.eigvals(self._hamiltonian(gain)[some, 0])).max(axis=1) * self._h[some]).max())

    def _hamiltonian(self, gain: float) -> Array:
        n = self.n
        R = gain**2 * np.eye(self.nw) - _t(self.F) @ self.F
        inverse = np.linalg.inv(R)
        through = self.E @ inverse @ _t(self.F)
        A = self.A + through @ self.C
        H = np.zeros((len(self._h), 2, 2 * n, 2 * n))
        H[..., :n, :n], H[..., n:, n:] = A, -_t(A)
        H[..., :n, n:] = self.E @ inverse @ _t(self.E)
        H[..., n:, :n] = -_t(self.C) @ (np.eye(self.nz) + self.F @ inverse @ _t(self.F)) @ self.C
        return H


def _t(M: Array) -> Array:
    return np.swapaxes(M, -1, -2)


def _in_the_mean(values: Array) -> Array:
    """At both Gauss points (.., 2, ..) the mean of the two."""
    return values.mean(axis=1, keepdims=True).repeat(2, axis=1)


def _parts(model: LTVModel) -> tuple[Array, Array]:
    """Equal parts (nt - 1,) of each interval, so that the fastest mode and a short nominal are both resolved; and how
    many groups of them share an exponent.

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
    cut = parts.astype(int)
    if cut.sum() * model.A.shape[-1] ** 3 <= SHARED:
        return cut, cut
    some = np.arange(0, len(size), max(1, len(size) // LOOKED))
    sizes = np.sort(np.abs(np.linalg.eigvals(model.A[some])), axis=1)
    slope = float((np.abs(np.diff(sizes, axis=0)).max(axis=1) / np.diff(model.t[some])).max(initial=0.0))
    groups = np.clip(np.ceil(h * np.sqrt(slope / (8 * TURNED))), 1, cut).astype(int)
    each = -(-cut // groups)
    return each * groups, groups
