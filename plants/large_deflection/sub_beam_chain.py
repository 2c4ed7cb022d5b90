"""A beam as a chain of sub-beams, each with small deformation in its own floating frame.

Sub-beam i of length l = L/N deforms by v(xi) = l sum_k phi_k(xi) q_ik across its frame, and by the second-order
shortening -(1/2) int v'^2 along it. Its tangent is A(alpha_i) (1 - sigma^2/2, sigma), sigma = v'. Its ends are clamped
to its neighbours': position and section rotation continue, so that the frame angles alpha_i follow from the q.
The frame decides what sigma is measured from: "tangent" at the input end, "chord" through both ends, "mean-axis",
in which the deformation has neither momentum nor moment of momentum.

Valid    sigma small: its fourth power is dropped from the length of the tangent
Source   "Substructuring Technique for Dynamics Analysis of Flexible Beams with Large Deformation", Eqs (4)-(12). The
         modes are orthogonalised with consistent masses. The paper's own numbers need the mean-axis frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np

from pliant.plants import beams
from pliant.plants.core.imports import linalg
from pliant.plants.exact_rotations.quadrature import Array, points

from .tangent_field import TangentField

FRAMES = ("mean-axis", "chord", "tangent")


@dataclass(frozen=True, eq=False)
class SubBeamModes:
    """Modified Craig-Bampton modes of a uniform beam: n deformation shapes, slope 1 at the output end.

    Static modes (unit displacement or rotation of one end: Hermite's cubics) and fixed-interface modes
    (clamped-clamped), orthogonalised by K Psi = lambda M Psi; the two rigid modes, lambda = 0, are left out.
    """

    n: int

    @cached_property
    def _combination(self) -> Array:
        xi, w = np.polynomial.legendre.leggauss(4 * self.n + 20)
        xi, w = (1 + xi) / 2, w / 2
        value, curvature = self._raw(xi, 0), self._raw(xi, 2)
        M, K = value.T @ (w[:, None] * value), curvature.T @ (w[:, None] * curvature)
        _, vectors = linalg.eigh(K, M)
        vectors = vectors[:, 2 : 2 + self.n]
        # Rounding leaves a trace of rigid motion in the shapes.
        rigid = np.column_stack([np.ones_like(xi), np.sqrt(12) * (xi - 0.5)])
        trace = rigid.T @ (w[:, None] * (value @ vectors))
        to_raw = np.zeros((vectors.shape[0], 2))
        to_raw[:4] = np.array([[1.0, 0.0, 1.0, 0.0], [-np.sqrt(3), np.sqrt(12), np.sqrt(3), np.sqrt(12)]]).T
        vectors = vectors - to_raw @ trace
        return vectors / (self._raw(np.ones(1), 1) @ vectors)

    def _raw(self, xi: Array, derivative: int) -> Array:
        """Hermite's cubics (displacement and rotation of each end), then clamped-clamped modes."""
        cubics = np.array([[1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]], dtype=float)
        polynomial = np.polynomial.polynomial.polyder(cubics.T, derivative) if derivative else cubics.T
        static = np.polynomial.polynomial.polyval(xi, polynomial).T
        fixed = beams.shapes("clamped-clamped", max(self.n - 2, 0))(xi, derivative)
        return np.column_stack([static, fixed])

    def __call__(self, xi: float | Array, derivative: int = 0) -> Array:
        """phi (derivative 0), its slope (1) or curvature (2) at xi (k,) in [0, 1] -> (k, n)."""
        return self._raw(np.atleast_1d(np.asarray(xi, dtype=float)), derivative) @ self._combination

    def offset(self, frame: str) -> Array:
        """Rotation (n,) of each shape that the frame takes over from the mean-axis one."""
        if frame == "tangent":
            return self(0.0, 1)[0]
        if frame == "chord":
            return self(1.0)[0] - self(0.0)[0]
        return np.zeros(self.n)


@lru_cache(maxsize=16)
def sub_beam_modes(n: int) -> SubBeamModes:
    """The modes, computed once."""
    return SubBeamModes(n)


@dataclass(frozen=True, eq=False)
class Chain:
    """N equal sub-beams clamped end to end; coordinates q = [root angle where it turns, q_1., .., q_N.]."""

    segments: int
    modes: int
    frame: str
    rotating: bool

    @property
    def n(self) -> int:
        """How many coordinates."""
        return self.rotating + self.segments * self.modes

    def columns(self, i: int) -> slice:
        """Where sub-beam i's own coordinates stand in q."""
        return slice(self.rotating + i * self.modes, self.rotating + (i + 1) * self.modes)

    @cached_property
    def shapes(self) -> SubBeamModes:
        """The shapes of one sub-beam."""
        return sub_beam_modes(self.modes)

    @cached_property
    def frame_angles(self) -> Array:
        """alpha_i = row i times q, (N + 1, n); the last row is the rotation of the tip's section."""
        start, end = self.shapes(0.0, 1)[0], self.shapes(1.0, 1)[0]
        offset = self.shapes.offset(self.frame)
        angles, section = np.zeros((self.segments + 1, self.n)), np.zeros(self.n)
        section[: self.rotating] = 1.0
        for i in range(self.segments):
            angles[i] = section
            angles[i, self.columns(i)] -= start - offset
            section = angles[i].copy()
            section[self.columns(i)] += end - offset
        angles[-1] = section
        return angles

    def local_slopes(self, xi: Array) -> Array:
        """sigma at xi (k,) in [0, 1] of the whole beam, times q: (k, n)."""
        xi = np.asarray(xi, dtype=float)
        place = np.minimum((xi * self.segments).astype(int), self.segments - 1)
        slopes = self.shapes(xi * self.segments - place, 1) - self.shapes.offset(self.frame)
        out = np.zeros((len(xi), self.n))
        for k, i in enumerate(place):
            out[k, self.columns(i)] = slopes[k]
        return out

    def section_angles(self, xi: Array) -> Array:
        """Rotation of the section at xi (k,), times q: (k, n)."""
        place = np.minimum((np.asarray(xi) * self.segments).astype(int), self.segments - 1)
        return self.frame_angles[place] + self.local_slopes(xi)

    def turns_within(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        """The largest slope |sigma| of any sub-beam [rad], and the largest curvature [1/length of the beam], of the
        coordinates q (segments * modes,) of one plane.
        """
        at = np.linspace(0.0, 1.0, 5)
        slopes, curvatures = self.shapes(at, 1) - self.shapes.offset(self.frame), self.shapes(at, 2) * self.segments
        own = ca.reshape(q, self.modes, self.segments)
        return tuple(ca.mmax(ca.fabs(ca.DM(rows) @ own)) for rows in (slopes, curvatures))  # type: ignore[return-value]

    @property
    def stiffness(self) -> Array:
        """int theta' theta'^T dxi over the whole beam, (n, n)."""
        at = points(4 * self.modes + 12)
        curvature = self.shapes(at.xi, 2)
        block = curvature.T @ (at.weight[:, None] * curvature) * self.segments
        K = np.zeros((self.n, self.n))
        for i in range(self.segments):
            K[self.columns(i), self.columns(i)] = (block + block.T) / 2
        return K

    def inertia(self) -> Array:
        """int theta theta^T dxi, (n, n)."""
        at = points(4 * self.modes + 12, self.segments)
        theta = self.section_angles(at.xi)
        S = theta.T @ (at.weight[:, None] * theta)
        return (S + S.T) / 2

    def field(self, m: int) -> TangentField:
        """t = A(alpha) (1 - sigma^2/2, sigma) at m points of each sub-beam."""
        at = points(m, self.segments)
        a = ca.SX.sym("a", 2)  # frame angle, slope in the frame
        along = 1 - a[1] ** 2 / 2
        c, s = ca.cos(a[0]), ca.sin(a[0])
        t = ca.vertcat(c * along - s * a[1], s * along + c * a[1])
        place = np.repeat(np.arange(self.segments), m)
        return TangentField(at, a, t, (self.frame_angles[place], self.local_slopes(at.xi)))

    def deformation(self, q: Array, i: int, xi: Array, length: float) -> Array:
        """Displacements (k, 2) [m] of sub-beam i in its floating frame at xi (k,) in [0, 1] of it, for numeric q.

        Across: v. Along: the shortening from the sub-beam's input end, its mean taken out in the mean-axis frame.
        """
        own, offset = q[self.columns(i)], self.shapes.offset(self.frame)
        xi = np.asarray(xi, dtype=float)
        v = self.shapes(xi) @ own - (offset @ own) * (xi - (0.5 if self.frame == "mean-axis" else 0.0))
        if self.frame != "mean-axis":
            v = v - self.shapes(0.0)[0] @ own
        at = points(2 * self.modes + 6)
        squares = ((self.shapes(at.xi, 1) - offset) @ own) ** 2 / 2
        u = -at.cumulative(xi) @ squares
        if self.frame == "mean-axis":
            u = u + at.first_moment @ squares
        return length / self.segments * np.column_stack([u, v])
