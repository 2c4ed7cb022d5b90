"""Linear models of a spacecraft in the deviations of the paper, from the plant's exact Jacobians.

Deviations   y = [p, q, hinge angles, eta] and dy/dt, then wheel momenta: p is the change of position in reference
             axes, q the small turn of the hub from its nominal attitude, in nominal hub axes. Three numbers
             describe the attitude, so that no root belongs to the quaternion's norm, and the rates are dy/dt
             themselves: d omega = dq/dt + omega x q to first order.
"""

from __future__ import annotations

import dataclasses
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from pliant.plants.core import parameters
from pliant.plants.core.argument_gates import require_finite
from pliant.plants.core.imports import linalg
from pliant.plants.core.quaternions import matrix_of, rates, skew
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.dynamics.arguments import one_state
from pliant.plants.dynamics.linear_models import check_signals, finer
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

from .declaration import SpacecraftDeclaration

Array = np.ndarray
ROUNDING = 256 * float(np.finfo(float).eps)  # of sums of four products of three factors, relative
TURN = 1e-3  # [rad] that attitudes may be apart at a jump, of which the map is of first order


class _Map(NamedTuple):
    """dx = T xi and xi = L dx to first order, L T = 1: ones but for the quaternion and the body rates."""

    quaternion: slice
    kept: Array  # states other than the quaternion; in xi three attitude deviations stand in its place
    own: Array  # where the kept ones stand in xi
    Xi: Array  # (..., 4, 3): d quaternion = Xi q
    back: Array  # (..., 3, 4)
    turning: Array  # (..., 3, 3): d omega = dq/dt + turning q
    omega: slice  # of the body rates in x

    @classmethod
    def at(cls, craft: SpacecraftDeclaration, x: Array) -> _Map:
        """At states x (..., nx)."""
        s, q = craft.layout.quaternion, x[..., craft.layout.quaternion]
        kept = np.delete(np.arange(craft.nx), np.arange(s.start, s.stop))
        Xi = rates(q) / 2
        back = 4 * np.swapaxes(Xi, -1, -2) / (q**2).sum(-1)[..., None, None]
        omega = craft.layout.omega
        return cls(s, kept, np.where(kept < s.start, kept, kept - 1), Xi, back, skew(x[..., omega]), omega)

    @property
    def _attitude(self) -> slice:
        return slice(self.quaternion.start, self.quaternion.stop - 1)

    def columns(self, M: Array) -> Array:
        """M T (..., m, nx - 1)."""
        out = np.empty((*M.shape[:-1], M.shape[-1] - 1))
        out[..., self.own] = M[..., self.kept]
        out[..., self._attitude] = M[..., self.quaternion] @ self.Xi + M[..., self.omega] @ self.turning
        return out

    def rows(self, M: Array) -> Array:
        """L M (..., nx - 1, m)."""
        out = np.empty((*M.shape[:-2], M.shape[-2] - 1, M.shape[-1]))
        out[..., self.own, :] = M[..., self.kept, :]
        turned = self.back @ M[..., self.quaternion, :]
        out[..., self._attitude, :] = turned
        out[..., self.omega.start - 1 : self.omega.stop - 1, :] -= self.turning @ turned
        return out


def in_deviations(craft: SpacecraftDeclaration, x: Array, dx: Array, jacobians: list[Array]) -> list[Array]:
    """[A, B, E, C, D, F] of the deviations from a nominal x (..., nx) that moves at dx (..., nx)."""
    A, B, E, C, D, F = jacobians
    change, at = _Map.at(craft, x), craft.layout
    moved = change.columns(A)
    q = slice(at.quaternion.start, at.quaternion.stop - 1)
    moved[..., at.quaternion, q] -= rates(dx[..., at.quaternion]) / 2
    moved[..., at.omega, q] -= skew(dx[..., at.omega])
    return [_kinematic(craft, x, A, change.rows(moved)), change.rows(B), change.rows(E), change.columns(C), D, F]


def _kinematic(craft: SpacecraftDeclaration, x: Array, A: Array, found: Array) -> Array:
    """The model's matrix `found` with the rows of dq/dt, which is a state, free of the rounding of the map.

    Without it three zero eigenvalues of a craft at rest are told as a growth of 1e-18 1/s. A nominal whose attitude
    does not move as its body rates say keeps what it has.
    """
    s, turns = craft.layout.quaternion, craft.layout.omega
    q, rate = slice(s.start, s.stop - 1), slice(turns.start - 1, turns.stop - 1)
    size = np.abs(A[..., s, s]).max((-2, -1)) + np.abs(x[..., turns]).max(-1)  # [1/s]
    off = found[..., q, :].copy()
    off[..., rate] -= np.eye(3)
    off[..., q] /= np.where(size > 0, size, 1.0)[..., None, None]
    exact = np.zeros_like(off)
    exact[..., rate] = np.eye(3)
    rounding = np.abs(off).max((-2, -1)) <= ROUNDING
    found[..., q, :] = np.where(rounding[..., None, None], exact, found[..., q, :])
    return found


def deviation_maps(craft: SpacecraftDeclaration, x: Array) -> tuple[Array, Array]:
    """(T (nx, nx - 1), L (nx - 1, nx)) at a state x (nx,): dx = T xi and xi = L dx to first order."""
    change = _Map.at(craft, np.asarray(x, dtype=float))
    return change.columns(np.eye(craft.nx)), change.rows(np.eye(craft.nx))


def jump_in_deviations(
    craft: SpacecraftDeclaration, x: Array, after: Array, jump: tuple[Array, Array], t: float
) -> tuple[Array, Array]:
    """(J, j) of a jump from x (nx,) to `after` (nx,), of deviations; ValueError where the attitude jumps too."""
    s = craft.layout.quaternion
    turn = 2 * np.arccos(min(1.0, abs(float(x[s] @ after[s]))))
    if turn > TURN:
        raise ValueError(f"linearize_pieces: the attitude jumps by {turn:.3g} rad at t = {t:.6g} s, must not jump")
    J, j = jump
    T, L = deviation_maps(craft, x)[0], deviation_maps(craft, after)[1]
    return L @ J @ T, L @ j


def _cut(craft: SpacecraftDeclaration, x: Array) -> Array:
    """x (..., nx) in the places of the deviations, the attitude as zero: it is what q is measured from."""
    out = np.delete(x, craft.layout.quaternion.start, axis=-1)
    out[..., craft.layout.quaternion.start : craft.layout.quaternion.stop - 1] = 0.0
    return out


def linearize(craft: SpacecraftDeclaration, x0: Any, u0: Any, w: Any, p: Any, t: float) -> LinearModel:
    """About (x0, u0) frozen; where the attitude turns there, q is measured from the turning attitude."""
    (_, x, u, w, p), batch = craft._arguments(x0, u0, w, p, t)
    if batch is not None:
        raise ValueError(f"FlexibleSpacecraft.x has shape {x.shape}, must be ({craft.nx},) to linearise")
    craft.check_state(x)
    dx = craft.dynamics(x, u, w=w, p=p, t=t)
    A, B, E, C, D, F = in_deviations(craft, x, dx, craft.jacobians(x, u, w=w, p=p, t=t))
    f0 = _Map.at(craft, x).rows(dx[:, None])[:, 0]
    f0[craft.layout.quaternion.start : craft.layout.quaternion.stop - 1] = 0.0
    return LinearModel(
        A,
        B,
        E,
        C,
        D,
        F,
        states=craft.deviations,
        inputs=craft.inputs,
        disturbances=craft.disturbances,
        outputs=craft.outputs,
        x0=_cut(craft, x),
        u0=u,
        w0=w,
        y0=craft.measure(x, u, w=w, p=p, t=t),
        f0=f0,
    )


def _orbit_rate(craft: SpacecraftDeclaration, p: Any) -> Array:
    """[rad/s], (nt,) where it is a parameter that varies."""
    path = "environment.orbit.rate"
    if path not in craft.varied:
        return np.asarray(parameters.get(craft, path), dtype=float)
    values = craft.nominal_parameters if p is None else np.asarray(p, dtype=float)
    return values[..., craft.varied.index(path)]


def nominal_accelerations(craft: SpacecraftDeclaration, nominal: Trajectory, p: Any) -> Array:
    """The unknowns a (nt, 6 + n) with which a nominal moves. Without translation the hub's is what balances the
    forces.
    """
    at, x, dx = craft.layout, nominal.x, nominal.derivative()
    R, orbit = matrix_of(x[:, at.quaternion]), craft.environment.orbit
    if craft.translation:
        pushed = dx[:, at.velocity]
        if orbit is not None:
            turning = _orbit_rate(craft, p)[..., None] * [0.0, -1.0, 0.0]
            pushed = pushed + 2 * np.cross(turning, x[:, at.velocity])
            pushed += np.cross(turning, np.cross(turning, x[:, at.position]))
        hub = np.einsum("tji,tj->ti", R, pushed)
    else:
        hub = np.zeros((len(x), 3))
    n = len(craft.coordinates)
    a = np.concatenate([hub, dx[:, at.omega], dx[:, at.rates : at.rates + n]], axis=1)
    if not craft.translation:
        r = craft.residual(x, a, nominal.u, w=nominal.w, p=p, t=nominal.t)
        M = craft.mass_matrix(x, p=p)
        a[:, :3] = -np.linalg.solve(M[:, :3, :3], r[:, :3, None])[..., 0]
    return a


def check_nominal(craft: SpacecraftDeclaration, nominal: Trajectory) -> None:
    """ValueError where a nominal's quaternion is not of unit length, or changes its sign and so has no rate."""
    craft.check_state(nominal.x)
    q = nominal.x[:, craft.layout.quaternion]
    flips = np.flatnonzero((q[1:] * q[:-1]).sum(axis=1) < 0)
    if nominal.dx is None and len(flips):
        raise ValueError(
            f"nominal: the quaternion changes its sign at t = {nominal.t[flips[0] + 1]:.6g} s; keep neighbours on one "
            "side (q and -q are the same attitude), or give dx"
        )


def linearize_along(craft: SpacecraftDeclaration, nominal: Trajectory, p: Any) -> LTVModel:
    """About a nominal motion; its residual is the affine term c.

    The equations M a + bias = loads are linearised at the nominal's own accelerations, as the paper does, and not
    at those that the plant would have there: a rigid nominal lacks strain, so that these are large however stiff
    the appendages, and the error would be of first order in the deviations. The two agree where the nominal is a
    motion of the plant.
    """
    check_signals(craft, nominal)
    check_nominal(craft, nominal)
    between = partial(finer, partial(_between_nodes, craft), _of_one_sign(craft, nominal), p)
    return dataclasses.replace(_at_nodes(craft, nominal, p), between=between)


def _of_one_sign(craft: SpacecraftDeclaration, nominal: Trajectory) -> Trajectory:
    """The same attitudes with quaternions that go on as their rates tell, where they changed their sign."""
    if nominal.dx is None:
        return nominal
    x, dx, q, half = nominal.x.copy(), nominal.dx.copy(), craft.layout.quaternion, np.diff(nominal.t)[:, None] / 2
    on, back = (
        np.linalg.norm(s * (x[1:, q] - half * dx[1:, q]) - (x[:-1, q] + half * dx[:-1, q]), axis=1) for s in (1, -1)
    )
    sign = np.cumprod(np.where(back < on, -1.0, 1.0))[:, None]
    x[1:, q], dx[1:, q] = sign * x[1:, q], sign * dx[1:, q]
    return dataclasses.replace(nominal, x=x, dx=dx)


def _between_nodes(craft: SpacecraftDeclaration, motion: Trajectory, p: Any) -> LTVModel:
    return _at_nodes(craft, _of_unit_length(craft, motion), p)


def _of_unit_length(craft: SpacecraftDeclaration, motion: Trajectory) -> Trajectory:
    """A motion between the nodes of another, where the polynomials of a quaternion leave the unit sphere."""
    x, q = motion.x.copy(), craft.layout.quaternion
    x[:, q] /= np.linalg.norm(x[:, q], axis=1, keepdims=True)
    return dataclasses.replace(motion, x=x)


def _at_nodes(craft: SpacecraftDeclaration, nominal: Trajectory, p: Any) -> LTVModel:
    w = nominal.w if nominal.w is not None else np.zeros((len(nominal.t), craft.nw))
    dx = nominal.derivative()
    A, B, E, C, D, F = in_deviations(craft, nominal.x, dx, craft._jacobians_along(nominal, w, p))
    residual = craft.dynamics(nominal.x, nominal.u, w=w, p=p, t=nominal.t) - dx
    return LTVModel(
        nominal.t,
        A,
        B,
        E,
        C,
        D,
        F,
        c=_Map.at(craft, nominal.x).rows(residual[..., None])[..., 0],
        x=_cut(craft, nominal.x),
        u=nominal.u,
        w=w,
        y=craft.measure(nominal.x, nominal.u, w=w, p=p, t=nominal.t),
        states=craft.deviations,
        inputs=craft.inputs,
        disturbances=craft.disturbances,
        outputs=craft.outputs,
    )


def natural_frequencies(craft: SpacecraftDeclaration, x0: Any, p: Any) -> Array:
    """Undamped, from the stiffness and mass of the free spacecraft at rest at x0 (nx,)."""
    x = np.array(one_state(craft, x0))
    x[craft.layout.velocity] = 0.0
    x[craft.layout.omega.start :] = 0.0
    values = require_finite("natural_frequencies.p", craft.nominal_parameters if p is None else p, (len(craft.varied),))
    bodies = dataclasses.replace(craft, varied=())
    for path, value in zip(craft.varied, values):
        if path.partition(".")[0] == "appendages":  # the hub's part is in the mass matrix
            bodies = parameters.put(bodies, path, float(value))
    at = craft.layout
    n, first = 6 + len(craft.coordinates), at.quaternion.stop - 6
    K, free = np.zeros((n, n)), np.ones(n, dtype=bool)
    for body, hinge, modes in zip(bodies.appendages, at.hinges, at.modes):
        turns = np.arange(hinge.start, hinge.stop) - first
        K[turns, turns] = body.hinge.stiffness
        free[turns] = body.hinge.drive != "motion"
        count, bent = modes.stop - modes.start, slice(modes.start - first, modes.stop - first)
        K[bent, bent] = body.stiffness_factor * body.data.stiffness[:count, :count]
    both = np.ix_(free, free)
    M = craft.mass_matrix(x, p=p)[both]
    try:
        squares = linalg.eigh(K[both], M, eigvals_only=True)
    except np.linalg.LinAlgError:
        craft.dynamics(x, p=p)  # says which motion has no inertia
        raise
    found = np.sqrt(np.maximum(squares, 0.0))
    return found[found > 1e-6 * found.max(initial=0.0)]
