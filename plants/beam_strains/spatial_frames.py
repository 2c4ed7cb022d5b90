"""Sections of a beam in space, turned as far as they like: frames integrated from the curvatures, as quaternions.

With F_(b+1) = F_b exp(Omega_b), see `frame_steps`, the sections spin at w_(b+1) = w_b + F_b T_b y_b', inertial axes,
and the tangents t = F (1 + e, g_y, g_z) change at w x t + F (e', g_y', g_z'). No angle is singular: a beam may wind up
as often as its points resolve.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from pliant.plants.core.quaternions import cross, matrix, rates
from pliant.plants.exact_rotations.quadrature import Array, sparse

from .frame_steps import NODES, combined, step
from .section_frames import Motion, SectionFrames


@dataclass(frozen=True, eq=False)
class SpatialFrames(SectionFrames):
    """q = [root_x, root_y, root_z, (root angle about z, bends), flaps, twists, stretches, shears along y, along z]."""

    @property
    def d(self) -> int:
        return 3

    def at(self, q: ca.SX, v: ca.SX) -> Motion:
        return SpatialMotion(self, q, v)

    @cached_property
    def steps(self) -> list[tuple[ca.SX, Array]]:
        """Of each step from the root over the points to the tip: y at rest (9,), and Y (9, n): y = rest + Y q."""
        ends, found, slices = self._ends, [], self.strains.slices
        for start, h in zip(ends[:-1], np.diff(ends)):
            xi = start + h * NODES
            k = np.zeros((3, 3, self.strains.n))
            for axis, kind in enumerate(("twist", "flap", "bend")):
                k[:, axis, slices[kind]] = self.strains.rows(kind, xi)
            only_z = np.zeros((3, 3, 3))
            only_z[np.arange(3), 2, np.arange(3)] = 1.0
            found.append((ca.DM(combined(only_z, float(h))) @ self.rest.bent(xi), combined(k, float(h))))
        return found

    @cached_property
    def _ends(self) -> Array:
        """Of the steps: root, points, ends of panels, where strains may jump, and tip."""
        return np.union1d(self.along.xi, np.linspace(0.0, 1.0, self.strains.panels + 1))

    @cached_property
    def at_points(self) -> list[int]:
        """Which of the frames, the root's first, are those of the points and of the tip."""
        return [int(k) for k in np.searchsorted(self._ends, np.append(self.along.xi, 1.0))]

    def _root(self, q: ca.SX) -> ca.SX:
        if (root := self.strains.turns) < 0:
            return ca.SX(ca.vertcat(1, 0, 0, 0))
        return ca.vertcat(ca.cos(q[root] / 2), 0, 0, ca.sin(q[root] / 2))

    def quaternions(self, q: ca.SX) -> tuple[list[ca.SX], list[ca.SX]]:
        """Of the root, the sections at the points and the tip's; T (3, 9) of the steps between them."""
        turns, found, changes = step(), [self._root(q)], []
        for rest, Y in self.steps:
            e, T = turns(rest + sparse(Y) @ q)
            found.append(e[0] * found[-1] + rates(found[-1]) @ e[1:])
            changes.append(T)
        return found, changes

    def tangents(self, q: ca.SX) -> ca.SX:
        onward, (found, _) = self.onward(q), self.quaternions(q)
        axes = [matrix(found[k]) for k in self.at_points[:-1]]
        return self.rooted(q, ca.horzcat(*[F @ onward[:, k] for k, F in enumerate(axes)]))

    def tip_frame(self, q: ca.SX) -> ca.SX:
        return matrix(self.quaternions(q)[0][-1])

    def twisted(self, q: ca.SX) -> ca.SX:
        """Integral of the twist up to the tip [rad]."""
        return self.strains.twisted(q)


class SpatialMotion(Motion):
    """Spins from step to step, not by differentiating the chain of them: a fraction of the size."""

    def __init__(self, frames: SpatialFrames, q: ca.SX, v: ca.SX) -> None:
        self._frames, self._q, self._v, self.points, self.d = frames, q, v, frames.points, 3
        n, strains = frames.strains.n, frames.strains
        found, changes = frames.quaternions(q)
        G, w = ca.SX(3, n), ca.SX.zeros(3)
        if strains.turns >= 0:
            G[2, strains.turns], w = 1, ca.vertcat(0, 0, v[strains.turns])
        spun = [(G, w)]
        for p, T, (_, Y) in zip(found, changes, frames.steps):
            FT = matrix(p) @ T
            G, w = G + FT @ sparse(Y), w + FT @ (sparse(Y) @ v)
            spun.append((G, w))
        self._axes = [matrix(found[k]) for k in frames.at_points]
        self._G, self._w = ([spun[k][i] for k in frames.at_points] for i in range(2))
        self.frame, self.turning = self._axes[-1], self._G[-1]
        onward, zero = frames.onward(q), ca.SX.zeros(n)
        on_rate = frames.onward(v) - frames.onward(zero)
        m = len(frames.along.xi)
        axes = self._axes[:-1]
        t = [axes[k] @ onward[:, k] for k in range(m)]
        rate = [ca.cross(self._w[k], t[k]) + axes[k] @ on_rate[:, k] for k in range(m)]
        on = [sparse(np.asarray(ca.DM(ca.jacobian(onward[:, k], q)))) for k in range(m)]
        J = [axes[k] @ on[k] - cross(t[k]) @ self._G[k] for k in range(m)]
        if strains.travels:
            here = strains.slices["root"]
            place = ca.SX(3, n)
            place[:, here] = ca.SX.eye(3) / frames.beam.length
            t, rate, J = [q[here] / frames.beam.length, *t], [v[here] / frames.beam.length, *rate], [place, *J]
        self.t = [ca.vertcat(*[e[c] for e in t]) for c in range(3)]
        self.rate = [ca.vertcat(*[e[c] for e in rate]) for c in range(3)]
        self._J = [ca.vertcat(*[e[c, :] for e in J]) for c in range(3)]

    @cached_property
    def _left(self) -> ca.SX:
        """What is left of the second derivatives where q'' = 0: of the tangents, then of the spins, in one sweep."""
        rate = ca.vertcat(*self.rate, *self._w, self.carried_rate)
        return ca.jtimes(rate, self._q, self._v)

    @cached_property
    def bias(self) -> list[ca.SX]:  # type: ignore[override]
        """Of the tangents, 3 lists of (m,)."""
        m = self.t[0].shape[0]
        return [self._left[c * m : (c + 1) * m] for c in range(3)]

    @property
    def _carried(self) -> ca.SX:
        return self.frame @ ca.vertcat(*self._frames.payload.offset)

    @property
    def carried_rate(self) -> ca.SX:  # type: ignore[override]
        """Of the payload's mass centre from the tip (3,) [m/s]."""
        return ca.cross(self._w[-1], self._carried)

    @cached_property
    def P(self) -> list[ca.SX]:
        return [sparse(self.points.root) @ J for J in self._J]

    def sum_jacobian(self, weight: Array) -> ca.SX:
        return ca.vertcat(*[ca.DM(weight).T @ J for J in self._J])

    def inertia(self) -> tuple[ca.SX, ca.SX]:
        """M = sum G^T J G, r = -sum G^T (J w' + w x J w), each J = F diag(..) F^T in inertial axes."""
        n, first = self._frames.strains.n, 3 * self.t[0].shape[0]
        M, r = ca.SX.zeros(n, n), ca.SX.zeros(n)
        for k, (F, G, w, own) in enumerate(zip(self._axes, self._G, self._w, self._inertias())):
            if own.is_zero():
                continue
            J = F @ own @ F.T
            JG = J @ G
            M += G.T @ JG
            r -= JG.T @ self._left[first + 3 * k : first + 3 * k + 3] + G.T @ ca.cross(w, J @ w)
        return M, r

    def turning_energy(self) -> ca.SX:
        spins = (F.T @ w for F, w in zip(self._axes, self._w))
        return sum((ca.bilin(own, w, w) / 2 for own, w in zip(self._inertias(), spins)), ca.SX(0))

    def carried(self) -> tuple[ca.SX, ca.SX, ca.SX]:
        c = self._carried
        return c, -cross(c) @ self.turning, self._left[-3:]

    def _inertias(self) -> list[ca.SX]:
        """rho L weight diag(I_x, I_y, I_z) [kg m^2] of every point, then the payload's tensor; the sections' axes."""
        own, beam, tensor = self._frames, self._frames.beam, self._frames.payload.inertia
        section = ca.diag(ca.vertcat(ca.SX(beam.polar_moment), beam.I_y, beam.I_z)) * beam.density * beam.length
        rows = [ca.horzcat(*row) for row in tensor] if isinstance(tensor, tuple) else [tensor * ca.SX.eye(3)]
        return [own.rotary * float(w) * section for w in own.along.weight] + [ca.SX(ca.vertcat(*rows))]
