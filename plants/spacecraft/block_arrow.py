"""A block-arrow system of equations M a + r = 0: bodies that each couple with the hub only.

The hub has 6 unknowns, every other body n of its own. With the bodies' blocks eliminated,

    S a_hub = -(r_hub - sum W_i^T r_i)     S = M_hh - sum M_hi M_ii^-1 M_ih     W_i = M_ii^-1 M_ih
    a_i = -M_ii^-1 r_i - W_i a_hub

so that the work grows with the number of bodies, not with its cube. Some of a body's unknowns may be given.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from pliant.plants.dynamics.symbolic_ldl import ldl, ldl_solve


class Share(NamedTuple):
    """One body's part of M a + r = 0 in the unknowns (hub 6, own n): M (6 + n, 6 + n), r (6 + n,)."""

    M: ca.SX
    r: ca.SX
    own: list[int]  # among all unknowns
    given: ca.SX | None  # values of the first of its own unknowns that are not solved for


class Eliminated(NamedTuple):
    """The block arrow with the appendages eliminated: W = M_ii^-1 M_ih and M_ii^-1 of each, S^-1 of the hub."""

    W: list[ca.SX]
    inverse: list[ca.SX]
    free: list[list[int]]  # of the appendage's own unknowns, those that are solved for
    hub: ca.SX
    pivots: list[ca.SX]  # all positive where M is definite


def _inverse(M: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
    n = M.shape[0]
    if not n:
        return ca.SX(0, 0), []
    L, d = ldl(M)
    return ca.horzcat(*[ldl_solve(L, d, ca.SX(ca.DM.eye(n)[:, k])) for k in range(n)]), d


def eliminate(parts: list[Share]) -> Eliminated:
    """Factor M of the shares."""
    hub, W, inverses, frees, pivots = parts[0].M, [], [], [], []
    for share in parts[1:]:
        n, driven = len(share.own), 0 if share.given is None else share.given.shape[0]
        free = [6 + k for k in range(driven, n)]
        hub = hub + share.M[:6, :6]
        inverse, d = _inverse(share.M[free, free])
        pivots += d
        gain = inverse @ share.M[free, :6]
        hub = hub - share.M[:6, free] @ gain
        W.append(gain)
        inverses.append(inverse)
        frees.append(free)
    inverse, d = _inverse(hub)
    return Eliminated(W, inverses, frees, inverse, pivots + d)


def solve(parts: list[Share], e: Eliminated, columns: list[ca.SX]) -> ca.SX:
    """M^-1 of minus the columns (6 + own, m) of every share, rows in the order of all unknowns.

    Driven rows come out as zero: their accelerations are moved into the columns by the caller.
    """
    total = columns[0]
    for W, free, r in zip(e.W, e.free, columns[1:]):
        total = total + r[:6, :] - W.T @ r[free, :]
    hub = -e.hub @ total
    out = ca.SX(6 + sum(len(s.own) for s in parts[1:]), total.shape[1])
    out[:6, :] = hub
    for share, W, inverse, free, r in zip(parts[1:], e.W, e.inverse, e.free, columns[1:]):
        rows = [share.own[k - 6] for k in free]
        if rows:
            out[rows, :] = -inverse @ r[free, :] - W @ hub
    return out


def accelerations(parts: list[Share]) -> tuple[ca.SX, ca.SX]:
    """All unknowns that make the residual zero, driven ones as given, and the smallest pivot of M."""
    columns = []
    for share in parts:
        r = share.r
        if share.given is not None:
            r = r + share.M[:, 6 : 6 + share.given.shape[0]] @ share.given
        columns.append(r)
    e = eliminate(parts)
    a = ca.densify(solve(parts, e, columns))
    for share in parts[1:]:
        if share.given is not None:
            a[share.own[: share.given.shape[0]]] = share.given
    return a, ca.mmin(ca.vertcat(*e.pivots))
