"""What a moving beam takes at its root and of its coordinates, without strain; see `tree_beam`."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from pliant.plants.core.casadi_functions import entries

from .spatial import Inertia, Motion, Wrench
from .tree_beam import SHORTENINGS, TreeBeam, head, tidy


class _Bent(NamedTuple):
    """Coordinates and rates of a beam by family, and what its integrals make of them."""

    beam: TreeBeam
    eta: list[ca.SX]
    rate: list[ca.SX]
    moments: tuple[ca.SX, ca.SX]
    moment_rates: tuple[ca.SX, ca.SX]
    pulled: ca.SX  # -dS_x/d(y, z) [kg]
    bowed: ca.SX  # -dP_xx/d(y, z)/2 [kg m]


def inertial(beam: TreeBeam, motion: Motion, U: ca.SX, eta: ca.SX, rate: ca.SX) -> tuple[Wrench, ca.SX]:
    """((f, n), Q (n,)) at zero accelerations of the coordinates."""
    y, z, _, _ = beam.parted(eta)
    d, bent, m = beam.parted(rate)[3], ca.vertcat(y, z), beam.beam.mass
    mean, second = (beam.shortened([getattr(b, k) for b in beam.bent_bases]) for k in SHORTENINGS)
    first, other = (m * (tidy(rod.bending).T @ d) for rod in beam.stretch)
    own = _Bent(
        beam, beam.parted(eta), beam.parted(rate), beam.moments(eta), (first, other),
        m / beam.beam.length * (mean @ bent), m * (second @ bent),
    )  # fmt: skip
    changing, S_bias, H = _changes(own, mean)
    rigid, B, w = beam.inertia(eta).inertial(motion, U), changing.matrix(), motion.omega
    f = rigid.f + 2 * ca.cross(w, changing.S) + ca.vertcat(S_bias, 0, 0)
    n = rigid.n + (B[0, 0] + B[1, 1] + B[2, 2]) * w - B @ w + ca.cross(w, H)
    return Wrench(f, n), _coordinates(own, motion, U)


def _changes(own: _Bent, mean: ca.DM) -> tuple[Inertia, ca.SX, ca.SX]:
    """(S' and P', S_x'' at zero accelerations, H)."""
    beam, m, L = own.beam, own.beam.beam.mass, own.beam.beam.length
    (y, z, _, e), (v, r, t, d) = own.eta, own.rate
    (my, mz), (my_rate, mz_rate) = own.moments, own.moment_rates
    (by, bz), rod, rates = beam.bent_bases, beam.stretch[0], ca.vertcat(v, r)
    k = min(beam.counts[:2])
    S = ca.vertcat(
        m * ca.dot(ca.DM(rod.first), d) - ca.dot(own.pulled, rates),
        m * ca.dot(ca.DM(by.first), v),
        m * ca.dot(ca.DM(bz.first), r),
    )
    P = ca.vertcat(
        2 * (m * (L * ca.dot(ca.DM(rod.moment), d) + ca.dot(e, d)) - ca.dot(own.bowed, rates)),
        ca.dot(my, v) + ca.dot(my_rate, y),
        ca.dot(mz, r) + ca.dot(mz_rate, z),
        2 * m * ca.dot(y, v),
        m * (ca.dot(head(y, k), head(r, k)) + ca.dot(head(v, k), head(z, k))),
        2 * m * ca.dot(z, r),
    )
    turning = ca.dot(head(y, k), head(r, k)) - ca.dot(head(z, k), head(v, k))
    H = ca.vertcat(
        m * turning + beam.polar * ca.dot(ca.DM(beam.twist.first), t),
        ca.dot(mz_rate, z) - ca.dot(mz, r),
        ca.dot(my, v) - ca.dot(my_rate, y),
    )
    return Inertia(ca.SX(0), S, P), -m / L * ca.dot(rates, mean @ rates), H


def _coordinates(own: _Bent, motion: Motion, U: ca.SX) -> ca.SX:
    """Q (n,) = S_eta . a + int p_eta . (U p + 2 omega x p') dm."""
    beam, m, L, a, w = own.beam, own.beam.beam.mass, own.beam.beam.length, motion.a, motion.omega
    (y, z, _, e), (v, r, _, _) = own.eta, own.rate
    (my, mz), (my_rate, mz_rate) = own.moments, own.moment_rates
    (by, bz), (ry, rz) = beam.bent_bases, beam.stretch
    ny, nz = beam.counts[:2]
    first, second = tidy(ry.bending), tidy(rz.bending)
    across = m * ca.DM(by.first) * a[1] - head(own.pulled, ny) * a[0] - U[0, 0] * head(own.bowed, ny) + U[1, 0] * my
    across += m * (U[1, 1] * y + U[1, 2] * spread(z, ny)) + 2 * (w[2] * my_rate - w[0] * m * spread(r, ny))
    up = (
        m * ca.DM(bz.first) * a[2]
        - entries(own.pulled, slice(ny, ny + nz)) * a[0]
        - U[0, 0] * entries(own.bowed, slice(ny, ny + nz))
        + U[2, 0] * mz
    )
    up += m * (U[2, 2] * z + U[2, 1] * spread(y, nz)) + 2 * (w[0] * m * spread(v, nz) - w[1] * mz_rate)
    twist = beam.polar * ca.DM(beam.twist.first) * motion.alpha[0]
    along = m * ca.DM(ry.first) * a[0] + U[0, 0] * m * (L * ca.DM(ry.moment) + e)
    along += m * (U[0, 1] * (first @ y) + U[0, 2] * (second @ z)) + 2 * m * (w[1] * (second @ r) - w[2] * (first @ v))
    return ca.vertcat(across, up, twist, along)


def spread(other: ca.SX, n: int) -> ca.SX:
    """Coordinates of the other plane by the n shapes of this one, which are the same functions."""
    k = min(n, other.shape[0])
    return ca.vertcat(head(other, k), ca.SX.zeros(n - k))
