"""A linear model in second-order form along a nominal, [A] x'' + [B] x' + [C] x = Q, and how an LTVModel becomes
one; the natural frequencies of M q'' + K q = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.core.imports import linalg
from pliant.plants.core.parameters import require_finite
from pliant.plants.core.signals import OwnsArrays, Signal
from pliant.plants.splines.cubic_spline import CubicSpline

if TYPE_CHECKING:
    from .ltv import LTVModel

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class SecondOrderModel(OwnsArrays):
    """[A] x'' + [B] x' + [C] x = Q at the times t; arrays (nt, n, n) and (nt, n). Q_u (nt, n, nu) multiplies input
    deviations.
    """

    t: Array = field(repr=False)
    A: Array = field(repr=False)
    B: Array = field(repr=False)
    C: Array = field(repr=False)
    Q: Array = field(repr=False)
    coordinates: tuple[Signal, ...]
    parts: tuple[tuple[str, tuple[int, ...]], ...] = ()  # ("1", indices) .. ("m", indices): appendages and main body
    Q_u: Array | None = field(default=None, repr=False)

    def block(self, name: str) -> Array:
        """A block under the paper's name: "A_11", "A_1m", "A_m1", "B_mm", "C_2m" .. , "Q_1", "Q_m" (nt, ..); the
        rows of m are q, then p.
        """
        kind, _, place = name.partition("_")
        known = dict(self.parts)
        rows = known.get(place[:-1]) if kind != "Q" else known.get(place)
        columns = known.get(place[-1:])
        if kind in ("A", "B", "C") and rows is None:  # two appendage numbers of several digits
            split = [k for k in range(1, len(place)) if place[:k] in known and place[k:] in known]
            rows, columns = (known[place[: split[0]]], known[place[split[0] :]]) if split else (None, None)
        if kind not in ("A", "B", "C", "Q") or rows is None or columns is None:
            raise ValueError(f"block {name!r} must be A_, B_, C_ with two of, or Q_ with one of {', '.join(known)}")
        if kind == "Q":
            return self.Q[:, list(rows)]
        return getattr(self, kind)[:, list(rows)][:, :, list(columns)]

    def eigenvalues(self, k: int) -> Array:
        """Roots frozen at node k (2 n,), in these coordinates: position in inertial axes, turn in hub axes."""
        n = self.A.shape[1]
        M = np.zeros((2 * n, 2 * n))
        M[:n, n:] = np.eye(n)
        M[n:] = -np.linalg.solve(self.A[k], np.hstack([self.C[k], self.B[k]]))
        return np.linalg.eigvals(M)

    def first_order(self) -> tuple[Array, Array]:
        """(A (nt, 2 n, 2 n), c (nt, 2 n)) of z = [x; x']: z' = A z + c."""
        n, nt = self.A.shape[1], len(self.t)
        M, c = np.zeros((nt, 2 * n, 2 * n)), np.zeros((nt, 2 * n))
        M[:, :n, n:] = np.eye(n)
        M[:, n:] = -np.linalg.solve(self.A, np.concatenate([self.C, self.B], axis=2))
        c[:, n:] = np.linalg.solve(self.A, self.Q[..., None])[..., 0]
        return M, c


def from_ltv(model: LTVModel, mass: Any = None) -> SecondOrderModel:
    """The second-order form of a model whose states are [y; dy/dt]; `mass` (nt, n, n) multiplies it, the identity
    where None.

    A residual c of the kinematic half enters Q with its time derivative. ValueError where the states are not of
    that form.
    """
    total = len(model.states)
    n, nt = total // 2, len(model.t)
    top = np.eye(total)[total - n :]
    if (
        total % 2
        or np.abs(model.A[:, :n] - top).max(initial=0.0) > 1e-9
        or np.abs(model.B[:, :n]).max(initial=0.0) > 1e-9
    ):
        raise ValueError(
            f"LTVModel.states = {model.state_names} must be coordinates and then their rates for a second-order form"
        )
    weight = (
        np.broadcast_to(np.eye(n), (nt, n, n))
        if mass is None
        else require_finite("second_order.mass", mass, (nt, n, n))
    )
    B, C = -model.A[:, n:, n:], -model.A[:, n:, :n]
    early, Q = model.c[:, :n], model.c[:, n:].copy()
    if np.abs(early).max(initial=0.0) > 0:
        Q += CubicSpline(model.t, early)(model.t, 1) + np.einsum("tij,tj->ti", B, early)
    return SecondOrderModel(
        model.t,
        np.array(weight),
        weight @ B,
        weight @ C,
        np.einsum("tij,tj->ti", weight, Q),
        model.states[:n],
        parts=(("y", tuple(range(n))),),
        Q_u=weight @ model.B[:, n:],
    )


def natural_squares(K: Array, M: Array) -> Array:
    """omega^2 (n,), ascending, of M q'' + K q = 0; K (n, n) symmetric, M (n, n) symmetric and positive definite.

    Solved as they stand, all of them err by rounding of the largest. The inverses of the eigenvalues of (M, K + s M),
    less s, err by rounding of (omega^2 + s)^2/s: with s about the lowest omega^2 that is not zero this keeps its
    digits, however stiff the others. Each root is taken from where it is surer. Source: the spectral transformation of
    Ericsson and Ruhe, Mathematics of Computation 35 (1980), 1251.

    >>> natural_squares(np.diag([1.0, 1e30]), np.eye(2)).tolist()
    [1.0, 1e+30]
    """
    n = len(K)
    if not n:
        return np.zeros(0)
    unit = np.sqrt(np.outer(np.diag(M), np.diag(M)))
    K, M = (K + K.T) / 2 / unit, (M + M.T) / 2 / unit
    found = linalg.eigh(K, M, eigvals_only=True)
    error = np.full(n, np.abs(found).max())  # times n eps
    for _ in range(2 * n + 2):
        unsure = 8 * n * np.finfo(float).eps * error
        apart = np.abs(found)[np.abs(found) > unsure]
        shift = max(apart.min(initial=np.inf), 2 * -min(found[0] - unsure[0], 0.0))
        if not np.isfinite(shift) or shift <= 0:
            break
        try:
            above = 1 / linalg.eigh(M, K + shift * M, eigvals_only=True)[::-1]
        except np.linalg.LinAlgError:  # further below zero than rounding told
            break
        again = above**2 / shift
        better = again < error / 2
        if not better.any():
            break
        found, error = np.where(better, above - shift, found), np.where(better, again, error)
    return np.sort(found)
