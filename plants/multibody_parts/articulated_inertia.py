"""Inertia of a body of which parts move freely: no longer one mass, for the force is not along the acceleration.

[f; n] = [F H; H^T J] [a; alpha] at a frame's origin, in its axes, with a and alpha the accelerations of the frame.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from .spatial import ENTRIES, Inertia, Wrench
from .steps import Move, Step


class ArticulatedInertia(NamedTuple):
    """F (6,) and J (6,) by their upper entries, H (3, 3)."""

    F: ca.SX
    H: ca.SX
    J: ca.SX

    @classmethod
    def of(cls, body: Inertia) -> ArticulatedInertia:
        """Of a body that moves as one."""
        P, zero = body.matrix(), ca.SX(0)
        trace = P[0, 0] + P[1, 1] + P[2, 2]
        J = [trace - P[i, i] if i == j else -P[i, j] for i, j in ENTRIES]
        F = [body.m if i == j else zero for i, j in ENTRIES]
        return cls(ca.vertcat(*F), -ca.densify(ca.skew(body.S)), ca.vertcat(*J))

    def __add__(self, other: ArticulatedInertia) -> ArticulatedInertia:  # type: ignore[override]
        return ArticulatedInertia(self.F + other.F, self.H + other.H, self.J + other.J)

    def unit(self, along: ca.SX, turns: bool) -> Wrench:
        """What a unit acceleration takes: along an axis (3,), or about it where it `turns`."""
        if turns:
            return Wrench(self.H @ along, square(self.J) @ along)
        return Wrench(square(self.F) @ along, self.H.T @ along)

    def without(self, one: Wrench, other: Wrench, still: tuple[bool, int] | None = None) -> ArticulatedInertia:
        """Less one other^T, a symmetric product. `still`: the row, of n or of f, that is then zero by what it is."""
        F, J = (
            ca.vertcat(*[A[k] - x[i] * y[j] for k, (i, j) in enumerate(ENTRIES)])
            for A, x, y in ((self.F, one.f, other.f), (self.J, one.n, other.n))
        )
        H = self.H - one.f @ other.n.T
        if still is not None:
            turns, axis = still
            for k, at in enumerate(ENTRIES):
                if axis in at:
                    (J if turns else F)[k] = 0
            if turns:
                H[:, axis] = 0
            else:
                H[axis, :] = 0
        return ArticulatedInertia(F, H, J)

    def lift(self, step: Step) -> ArticulatedInertia:
        """About the origin and in the axes before the step."""
        if isinstance(step, Move):
            R = ca.densify(ca.skew(step.r))
            H = self.H - square(self.F) @ R
            J = square(self.J) - self.H.T @ R + R @ H
            return ArticulatedInertia(self.F, H, ca.vertcat(*[J[i, j] for i, j in ENTRIES]))
        half = ca.horzcat(*[step.out(self.H[:, k]) for k in range(3)]).T
        H = ca.horzcat(*[step.out(half[:, k]) for k in range(3)]).T
        F, J = (step.turned(square(A)) for A in (self.F, self.J))
        return ArticulatedInertia(F, H, J)


def square(upper: ca.SX) -> ca.SX:
    """(3, 3) of the six upper entries."""
    A = upper
    return ca.blockcat([[A[0], A[1], A[2]], [A[1], A[3], A[4]], [A[2], A[4], A[5]]])
